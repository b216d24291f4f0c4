"""Labelled views a second of `franbv dataset make` on the default configuration, with one worker and with two."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.benchmarks.stopwatch import Stopwatch

pytestmark = pytest.mark.benchmark

VIEWS = 100
"""Ten scenes; what they hold differs, so only the same ones compare."""
GOAL = 1.0
"""Views a second of two workers on two cores."""


def test_workers(stopwatch: Stopwatch, tmp_path: Path):
    """The same views by one worker and by two, start of the program and of the workers included."""
    rates = {}
    for workers in (1, 2):
        made = subprocess.run(_command(tmp_path / str(workers), workers), stdout=subprocess.PIPE, check=True)
        figures = json.loads(made.stdout.splitlines()[-1])
        rates[workers] = figures["views_per_s"]
        spent = sorted(figures["cpu_s_per_view"].items(), key=lambda stage: -stage[1])
        stopwatch.note(
            f"dataset, {VIEWS} views, {workers} worker(s): {rates[workers]:.2f} views/s, "
            f"peak memory {figures['peak_rss_gb']:.2f} GB a worker; processor time a view [s]: "
            + ", ".join(f"{stage} {seconds:.2f}" for stage, seconds in spent)
        )
    stopwatch.note(f"two workers over one: {rates[2] / rates[1]:.2f}; goal of two workers: {GOAL} views/s")


def _command(folder: Path, workers: int) -> list[str]:
    program = str(Path(sys.executable).with_name("franbv"))
    return [
        program,
        "dataset",
        "make",
        "default",
        str(folder),
        "--views",
        str(VIEWS),
        "--workers",
        str(workers),
        "--json",
    ]
