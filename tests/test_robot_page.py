"""`docs/robot.md`: what it names exists, its numbers are the code's, and its examples are read by what they are for."""

import itertools
import json
import re
from pathlib import Path

import pytest

from docs.figures import delays
from franbv.adapters.arms.flange_poses import STEP_DEG, STEP_M
from franbv.adapters.arms.manual_arm import ManualArmSettings
from franbv.adapters.arms.ros_arm import EXECUTE, FK, IK, JOINTS, PLAN_SERVICE, SCENE_SERVICE, STOP
from franbv.adapters.calibration.hand_eye import WORST_DEG, WORST_MM_PER_M
from franbv.adapters.calibration.poses_file import read_poses_file
from studies.cli.main import COMMANDS
from studies.thresholds.reference import LIMIT_QUANTILE
from tests.conftest import ROOT

TEXT = (ROOT / "docs" / "robot.md").read_text()


def test_files_and_commands_that_it_names_exist():
    """Files in backticks, and the command of both programs."""
    named = re.findall(r"`((?:franbv|studies|tests)/[\w/]+\.py)`", TEXT)
    assert len(named) > 4
    assert [name for name in named if not (ROOT / name).exists()] == []
    assert set(re.findall(r"^    franbv ([a-z]+(?: [a-z][a-z-]*)?) ", TEXT, re.MULTILINE)) <= set(COMMANDS)


def test_its_numbers_are_the_codes():
    """Names of ROS, steps, tolerances, limits."""
    assert set(re.findall(r"`(/[a-z_]+)`", TEXT)) == {EXECUTE, FK, IK, JOINTS, PLAN_SERVICE, SCENE_SERVICE, STOP}
    assert f"{1e3 * STEP_M:g} mm and {STEP_DEG:g} deg apart" in TEXT
    manual = ManualArmSettings()
    assert f"within {1e3 * manual.position_tolerance_m:g} mm and {manual.angle_tolerance_deg:g} deg is taken" in TEXT
    assert f"{WORST_MM_PER_M:g} mm per metre of distance or {WORST_DEG:g} deg" in " ".join(TEXT.split())


def test_its_table_of_delays_is_the_figures(monkeypatch: pytest.MonkeyPatch):
    """Rows in the order in which they are printed; where every run changes at once, any stream says the same. The rest
    takes a minute."""
    monkeypatch.setattr(delays, "N_STREAMS", 1)
    rows = re.findall(r"^\| (\d+) \| (\d+) % \| (\d+) \| .*\|$", TEXT, re.MULTILINE)
    wanted = itertools.product(delays.CERTIFIED, (round(100 * share) for share in delays.CHANGED), delays.PAST)
    assert [tuple(map(int, row)) for row in rows] == list(wanted)
    assert all(delays.row(certified, 1.0, 0) in TEXT for certified in delays.CERTIFIED)
    assert f"{LIMIT_QUANTILE:g} of the domain's runs" in TEXT


def test_its_example_of_poses_is_read(tmp_path: Path):
    """By the reader that the command uses."""
    (example,) = re.findall(r"```json\n(.*?)```", TEXT, re.DOTALL)
    path = tmp_path / "poses.json"
    path.write_text(example)
    assert read_poses_file(path).poses[0].image == Path(json.loads(example)["poses"][0]["image"])


def test_its_python_example_can_be_compiled_and_its_names_exist():
    """It needs a robot to run; what it imports and sets is there."""
    (block,) = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    names: dict = {}
    exec(compile(block, "<page>", "exec"), names)
    with pytest.raises(Exception, match=r"roslibpy|rosbridge"):
        names["RosArm"](names["RosArmSettings"](url="ws://127.0.0.1:9", group="a", connect_timeout_s=0.2))
