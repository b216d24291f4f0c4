"""What the finished runs of a study of readings say: table, summary, candidates and page, made anew from its folder."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from studies.base.atomic_file import write_atomically
from studies.base.console import strict_json
from studies.comparison.records import RUN_COLUMNS, read_records, table_row
from studies.comparison.statistics import Comparison
from studies.readings.analysis import analysed
from studies.readings.candidates import PROPOSED, candidates_of, preset_file, write_confirmations
from studies.readings.preset import ReadingsPreset
from studies.readings.report.page import readings_html
from studies.readings.summary import readings_json, readings_words
from studies.run.batch import PlannedRun
from studies.store.tables import write_rows
from studies.work.workers import Failure

READING_RUNS, READINGS_SUMMARY, READINGS_PAGE = "readings_runs.parquet", "readings_summary.json", "readings.html"
"""The table of runs, the summary and the page, in the output folder. Other names than a comparison's, which may stand
in the same folder."""
WRITTEN_BESIDE = (READING_RUNS, READINGS_SUMMARY, READINGS_PAGE, *map(preset_file, PROPOSED))
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
    """Write all of it for the runs that are finished; candidates once every cell has all its figures."""
    records = read_records(out, runs)
    write_rows(out / READING_RUNS, RUN_COLUMNS, map(table_row, records))
    analysis = analysed(Comparison(records), preset.parts, preset.starts)
    candidates = candidates_of(analysis)
    write_confirmations(out, preset, candidates)
    told = readings_words(analysis, candidates, len(records), len(runs), len(failures))
    counts = {"runs": len(records), "planned": len(runs), "failed": len(failures), "wall_s": wall_s}
    summary: dict[str, Any] = {**counts, **readings_json(preset, analysis, candidates)}
    stored = {**summary, "failures": [asdict(failure) for failure in failures]}
    write_atomically(out / READINGS_SUMMARY, strict_json(stored, indent=1).encode())
    write_atomically(out / READINGS_PAGE, readings_html(preset, analysis, candidates, told, failures).encode())
    return ToldReadings(summary, told, out / READINGS_PAGE)
