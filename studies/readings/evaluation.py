"""What the finished runs of a study of readings say: table, summary and page, made anew from the cases' folders."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from studies.base.atomic_file import write_atomically
from studies.base.console import strict_json
from studies.base.numbers_as_text import counted
from studies.comparison.records import RUN_COLUMNS, read_records, table_row
from studies.readings.preset import ReadingsPreset
from studies.run.batch import PlannedRun
from studies.store.tables import write_rows
from studies.work.workers import Failure

READING_RUNS, READINGS_SUMMARY, READINGS_PAGE = "readings_runs.parquet", "readings_summary.json", "readings.html"
"""The table of runs, the summary and the page, in the output folder."""
WRITTEN_BESIDE = (READING_RUNS, READINGS_SUMMARY, READINGS_PAGE)
"""What stands there beside the runs."""


@dataclass(frozen=True)
class ToldReadings:
    """What is said when a command ends."""

    summary: dict[str, Any]
    words: str
    report: Path


def evaluate_readings(
    out: Path, preset: ReadingsPreset, runs: Sequence[PlannedRun], failures: Sequence[Failure], wall_s: float
) -> ToldReadings:
    """Write table, summary and page of the runs that are finished."""
    records = read_records(out, runs)
    write_rows(out / READING_RUNS, RUN_COLUMNS, map(table_row, records))
    summary: dict[str, Any] = {"runs": len(records), "planned": len(runs), "failed": len(failures), "wall_s": wall_s}
    stored = {**summary, "failures": [asdict(failure) for failure in failures]}
    write_atomically(out / READINGS_SUMMARY, strict_json(stored, indent=1).encode())
    words = f"{counted(len(records), 'run')} of {len(runs)}; {counted(len(failures), 'run')} failed"
    return ToldReadings(summary, words, out / READINGS_SUMMARY)
