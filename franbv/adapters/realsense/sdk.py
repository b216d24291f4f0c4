"""librealsense's Python package, loaded when a camera is asked for and not before."""

import importlib
from functools import cache
from typing import Any

from franbv.adapters.camera_error import CameraError


@cache
def sdk() -> Any:
    """The module `pyrealsense2`; CameraError that names the mend where it or a library below it is missing.

    Its functions are compiled and have no types.
    """
    try:
        return importlib.import_module("pyrealsense2")
    except ModuleNotFoundError:
        raise CameraError("pyrealsense2: not installed here; pip install 'franbv[realsense]'") from None
    except ImportError as error:  # the loader names the file: libusb-1.0.so.0, of the system and not of pip
        raise CameraError(
            f"pyrealsense2: cannot be loaded ({sdk_text(error)}); install the library that is named, for libusb "
            "on Debian and Ubuntu: apt-get install libusb-1.0-0"
        ) from None


def sdk_text(error: BaseException) -> str:
    """The text of an error of the SDK, which may have several lines."""
    return " ".join(str(error).split())
