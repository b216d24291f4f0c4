"""What everything else stands on: how fast the command starts, and how fast the machine traces rays."""

import subprocess
import sys

import pytest

from render.world.ray_rate import camera_rays_per_second
from tests.benchmarks.stopwatch import Stopwatch

pytestmark = pytest.mark.benchmark


def test_start_of_the_command(stopwatch: Stopwatch):
    """`franbv --help` in a fresh process: it must not load the renderer."""
    command = [sys.executable, "-c", "from studies.cli.main import main; main(['--help'])"]
    stopwatch.time("franbv --help", lambda: subprocess.run(command, check=True, capture_output=True))


def test_camera_rays(stopwatch: Stopwatch):
    """The rate that `franbv doctor` prints."""
    stopwatch.note(f"{camera_rays_per_second() / 1e6:.2f} million camera rays/s (ball on a table, 2 bounces)")
