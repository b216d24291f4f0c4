"""One run of the ball for all that is observed of runs."""

import pytest

from tests.studies.thresholds.ball_runs import BallRun, ball_run


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> BallRun:
    """A run with a recovery."""
    return ball_run(tmp_path_factory.mktemp("ball"))
