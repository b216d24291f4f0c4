"""What the camera's tests need of the machine."""

import pytest


@pytest.fixture(autouse=True)
def _librealsense():
    """Without librealsense, or libusb below it, there is no software device to test on."""
    pytest.importorskip("pyrealsense2", exc_type=ImportError)
