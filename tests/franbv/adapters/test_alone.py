"""A computer at the robot has the planner and its adapters, and nothing of simulator, studies or a camera's SDK."""

import importlib
import re
import subprocess
import sys
import textwrap
import tomllib

import pytest
from packaging.requirements import Requirement

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.sdk import sdk
from tests.conftest import ROOT

ABSENT = (
    "render", "scenes", "materials", "studies", "mitsuba", "drjit", "trimesh", "cv2", "tyro", "rich", "jinja2",
    "pyarrow", "OpenEXR",
)  # fmt: skip
"""What a robot computer need not have."""
BLOCKED = """
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {absent!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Blocked())
"""


def without(absent: tuple[str, ...], body: str) -> subprocess.CompletedProcess:
    """A fresh interpreter, in which these packages are not to be found, runs the body."""
    program = BLOCKED.format(absent=absent) + textwrap.dedent(body)
    return subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False)


def test_a_burst_without_simulator_and_studies():
    """The camera is opened, set up, and hands over a burst; nothing of ours but franbv is loaded for it."""
    pytest.importorskip("pyrealsense2", exc_type=ImportError)
    done = without(
        ABSENT,
        """
        from scipy.spatial.transform import RigidTransform
        from tests.franbv.adapters.realsense.software_camera import Bench, SoftwareCamera, flat, stills

        with Bench([SoftwareCamera()], stills(flat)).camera() as camera:
            print(camera.capture(RigidTransform.identity(), 2).depths.shape)
        """,
    )
    assert done.stdout.strip() == "(2, 40, 60)", done.stderr


def test_the_plain_package_brings_no_simulator():
    """What pip installs with `franbv[realsense]`: the planner's packages and the camera's SDK."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = [*project["dependencies"], *project["optional-dependencies"]["realsense"]]
    names = {Requirement(line).name.lower().replace("-", "_") for line in wanted}
    assert "pyrealsense2" in names
    assert not names & {name.lower() for name in (*ABSENT, "opencv_python_headless", "karellen_llvm_core")}


def test_the_tool_without_simulator_and_studies():
    """The commands for a robot run where the extra `studies` is not installed; the others name it in one line."""
    done = without(
        tuple(name for name in ABSENT if name not in ("studies", "materials")),
        """
        from studies.cli.main import main
        print(main(["run", "--cell", "none.yaml", "--arm", "ros", "--camera", "realsense", "--out", "none"]))
        print(main(["reconstruct", "--part", "D", "--out", "none"]))
        """,
    )
    assert done.stdout.split() == ["2", "2"], done.stderr
    first, second = done.stderr.splitlines()
    assert first == "franbv run: none.yaml: cannot be read (No such file or directory); name a YAML file"
    assert re.fullmatch(r"franbv reconstruct: needs the package \w+; pip install 'franbv\[studies\]'", second)


def test_without_the_sdk_the_mend_is_named():
    """Everything can be imported, and the command ends in one line with status 2."""
    done = without(
        (*ABSENT, "pyrealsense2"),
        """
        from franbv.adapters.__main__ import run
        sys.exit(run(["cameras"]))
        """,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "franbv.adapters: pyrealsense2: not installed here; pip install 'franbv[realsense]'\n"


@pytest.mark.parametrize(
    ("absent", "body", "said"),
    [
        (
            "roslibpy",
            """
            from franbv.adapters.arms.ros_arm import RosArm, RosArmSettings
            RosArm(RosArmSettings())
            """,
            "franbv.adapters.arms.driver.ArmError: roslibpy: not installed here; pip install 'franbv[ros]'",
        ),
        (
            "cv2",
            """
            from franbv.adapters.calibration.poses_file import Path, read_image
            read_image(Path("x.png"))
            """,
            "CalibrationError: cv2: not installed here; pip install opencv-python-headless",
        ),
    ],
)
def test_what_an_arm_needs_is_named(absent: str, body: str, said: str):
    """Arms and calibration can be imported without it; who uses it learns how to get it."""
    done = without((*ABSENT, absent), body)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].endswith(said)


def test_importing_loads_no_sdk():
    """Nothing is loaded until a camera, an arm or a board is asked for."""
    done = without(
        (),
        """
        import franbv.adapters.__main__, franbv.adapters.realsense.camera
        import franbv.adapters.arms.manual_arm, franbv.adapters.arms.ros_arm
        print({"pyrealsense2", "roslibpy", "twisted", "cv2"} & set(sys.modules))
        """,
    )
    assert done.stdout.strip() == "set()", done.stderr


def test_a_missing_libusb_is_named(monkeypatch):
    """The wheel is there and the system's library is not: what the loader says, and how to get it."""

    def fail(name):
        raise ImportError("libusb-1.0.so.0: cannot open shared object file: No such file or directory")

    sdk.cache_clear()
    monkeypatch.setattr(importlib, "import_module", fail)
    with pytest.raises(CameraError, match=r"libusb-1\.0\.so\.0: cannot open.*apt-get install libusb-1\.0-0"):
        sdk()
