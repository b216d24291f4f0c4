"""Median times and peak memory of single steps, as a table; nothing here judges them."""

import gc
import os
import resource
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Timing:
    """One step that was timed."""

    name: str
    seconds: tuple[float, ...]
    """Wall times of the repetitions [s]."""
    cpu_seconds: tuple[float, ...]
    """Processor times of all threads and children [s]: hardly longer on a busy machine, where wall times are."""
    peak_bytes: int
    """Largest resident memory of the process during them, all that it held before included."""
    goal: float | None
    """What is hoped for [s]."""

    @property
    def median(self) -> float:
        """Wall time [s]."""
        return statistics.median(self.seconds)

    def row(self) -> tuple[str, ...]:
        """The table's cells."""
        spread = f"{milliseconds(min(self.seconds))}-{milliseconds(max(self.seconds))}"
        goal = "" if self.goal is None else milliseconds(self.goal)
        ratio = "" if self.goal is None else f"{self.median / self.goal:.2f}"
        cpu = milliseconds(statistics.median(self.cpu_seconds))
        memory = f"{self.peak_bytes / 2**20:.0f}"
        return self.name, milliseconds(self.median), spread, cpu, str(len(self.seconds)), goal, ratio, memory


def milliseconds(seconds: float) -> str:
    """Three digits of a time."""
    return f"{seconds * 1e3:.0f}" if seconds >= 0.1 else f"{seconds * 1e3:.3g}"


HEADER = ("step", "median [ms]", "min-max [ms]", "CPU [ms]", "n", "goal [ms]", "median / goal", "peak memory [MiB]")


@dataclass
class Stopwatch:
    """Collects timings; the session prints them at its end."""

    timings: list[Timing] = field(default_factory=list)
    facts: list[str] = field(default_factory=list)

    def time(
        self, name: str, step: Callable[[], object], n: int = 5, goal: float | None = None, warm_up: int = 1
    ) -> Timing:
        """Run `step` `warm_up` times for its caches and compilers, then `n` times against the clock.

        goal: what is hoped for [s], printed beside the median.
        """
        for _ in range(warm_up):
            step()
        gc.collect()
        reset_peak_memory()
        seconds, cpu_seconds = [], []
        for _ in range(n):
            start, cpu_start = time.perf_counter(), cpu_time()
            step()
            seconds.append(time.perf_counter() - start)
            cpu_seconds.append(cpu_time() - cpu_start)
        timing = Timing(name, tuple(seconds), tuple(cpu_seconds), peak_memory(), goal)
        self.timings.append(timing)
        return timing

    def note(self, fact: str) -> None:
        """A line below the table: agreement with a reference, rays per second, sizes."""
        self.facts.append(fact)

    def table(self) -> list[str]:
        """Aligned lines: header, timings, facts."""
        rows = [HEADER, *(timing.row() for timing in self.timings)]
        widths = [max(len(row[i]) for row in rows) for i in range(len(HEADER))]
        lines = [
            "  ".join([row[0].ljust(widths[0]), *(cell.rjust(w) for cell, w in zip(row[1:], widths[1:], strict=True))])
            for row in rows
        ]
        return (lines if self.timings else []) + self.facts


def cpu_time() -> float:
    """Processor time of this process and of its finished children, all threads together [s]."""
    # os.times counts in hundredths of a second, too coarse for one frame; only it knows of children.
    return time.process_time() + sum(os.times()[2:4])


def reset_peak_memory() -> bool:
    """Let the kernel forget the largest memory so far; where it cannot (False), the peak of the session stays."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return False
    return True


def peak_memory() -> int:
    """Largest resident memory of this process [bytes] since the last reset."""
    status = Path("/proc/self/status")
    if status.exists():
        lines = dict(line.split(":", 1) for line in status.read_text().splitlines() if ":" in line)
        return int(lines["VmHWM"].split()[0]) * 1024
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
