"""One stopwatch for all benchmarks, whose table ends the session (`make bench`)."""

import os
import platform
from pathlib import Path

import pytest

from tests.benchmarks.stopwatch import Stopwatch

_stopwatch = Stopwatch()


@pytest.fixture(scope="session")
def stopwatch() -> Stopwatch:
    """Times steps: `stopwatch.time("name", lambda: step(), n=5, goal=1.5)`."""
    return _stopwatch


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the medians, below a line on the machine: times mean nothing without it."""
    lines = _stopwatch.table()
    if lines:
        terminalreporter.section("benchmarks")
        terminalreporter.write_line(machine())
        for line in lines:
            terminalreporter.write_line(line)


def machine() -> str:
    """Processor, its count and how busy others keep it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    model = names[0] if names else platform.processor() or platform.machine()
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return f"{usable} x {model}, load {os.getloadavg()[0]:.1f}, Python {platform.python_version()}"
