"""The examples run as they stand, each in a process of its own, and print what they promise."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import ROOT

EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
PROMISED = {
    "01_metals_at_850_nm.py": r"silver .* 0\.99\d",
    "02_holes_of_a_tilted_plate.py": r"0\.40 .*%",
    "03_planner_on_another_camera.py": r"RMS distance from the ball 0\.00 mm",
    "04_depth_of_your_own_mesh.py": r"(?s)look at the ring.*incidence 60-90 deg:",
    "05_reconstruct_a_part.py": r"coverage at 5 mm [1-9]\d\.\d%",
    "06_train_on_a_dataset.py": r"(?s)(\(2, 3, 240, 424\): \d+\.\d% without depth, mostly .*off by 0\.00.*){2}",
}
"""A line of each output: silver's R0 is that of Johnson and Christy, points of a perfect camera lie on the ball, a
few views of a part cover more than a tenth of it, and a dataset's batches have depth within millimetres."""
SLOW = {
    "02_holes_of_a_tilted_plate.py",
    "04_depth_of_your_own_mesh.py",
    "05_reconstruct_a_part.py",
    "06_train_on_a_dataset.py",
}


@pytest.mark.parametrize(
    "path", [pytest.param(p, id=p.stem, marks=[pytest.mark.slow] if p.name in SLOW else []) for p in EXAMPLES]
)
def test_example_prints_what_it_promises(path: Path, tmp_path: Path):
    """Exit status 0, nothing on stderr, and the promised line."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-W", "error", str(path)]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert re.search(PROMISED[path.name], done.stdout), done.stdout


def test_examples_stay_short():
    """Under 60 lines each, or nobody reads them; and each is in the table above."""
    assert {path.name for path in EXAMPLES} == set(PROMISED)
    assert [path.name for path in EXAMPLES if len(path.read_text().splitlines()) >= 60] == []
