"""A run of the analytic camera, drawn into a file."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from franbv.acquisition import Acquisition, Reconstruction
from franbv.planners import fra
from franbv.reconstruction import reconstruct
from tests.franbv.adapters.recording.recorded_run import PARAMETERS, SEED, camera, infrared, record
from tests.franbv.analytic_camera import FreeArm


class DrawnRun(NamedTuple):
    """A run and the viewer's file of it."""

    run: Reconstruction
    path: Path


def run_before(observe: Callable[[Acquisition], None]) -> Reconstruction:
    """The recorded run of `tests.franbv.adapters.recording`, before this observer."""
    return reconstruct(camera(), FreeArm(), fra(), PARAMETERS, seed=SEED, observe=observe)


@pytest.fixture(scope="session")
def drawn_run(tmp_path_factory: pytest.TempPathFactory) -> DrawnRun:
    """One whose first view sets off a recovery."""
    pytest.importorskip("rerun")
    from franbv.adapters.view.opening import rrd_file

    path = tmp_path_factory.mktemp("view") / "run.rrd"
    with rrd_file(path, "Box", PARAMETERS.invalid_share) as view:
        run = run_before(lambda a: view.observe(a, coverage=a.index / 100, infrared=infrared(a.index)))
    return DrawnRun(run, path)


@pytest.fixture(scope="session")
def recorded_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same run as a recording."""
    path = tmp_path_factory.mktemp("recorded") / "run.mcap"
    record(path)
    return path
