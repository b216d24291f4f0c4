"""A recorded run that tests share; none of them changes the file."""

from pathlib import Path
from typing import NamedTuple

import pytest

from franbv.acquisition import Reconstruction
from tests.franbv.adapters.recording.recorded_run import record


class RecordedRun(NamedTuple):
    """A run and its recording."""

    path: Path
    run: Reconstruction


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> RecordedRun:
    """Of the camera in whole millimetres."""
    path = tmp_path_factory.mktemp("recorded") / "run.mcap"
    return RecordedRun(path, record(path))
