"""One stopwatch for all benchmarks, whose table ends the session (`make bench`)."""

import pytest

from studies.work.machine import machine
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
