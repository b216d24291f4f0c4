"""`franbv report DIR`: rebuild the HTML report of every finished reconstruction in a folder."""

import importlib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from studies.base.console import say, say_json
from studies.base.flags import parse
from studies.run.stored_run import stored_runs

STUDIES = {
    "comparison.json": "studies.comparison.command",
    "readings.json": "studies.readings.command",
    "study.json": "studies.sensitivity.report.page",
}
"""File that a study's folder is known by -> module with `rebuild(folder) -> report`."""
STARTS_FILE, STARTS_MODULE = "starts.json", "studies.run.starts.page"
"""The same of a folder of starts, which are reconstructions with reports of their own."""


@dataclass(frozen=True)
class ReportCommand:
    """The flags of `franbv report`."""

    folder: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    """Output folder of a reconstruction or one case in it, or that of a study."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Rebuild the reports from the stored results."""
    command = parse(ReportCommand, args, "franbv report", "Rebuild the HTML report from the stored results.")
    reports = _rebuilt_reports(command.folder)
    for path in reports:
        say(f"{path}")
    if command.json:
        say_json({"reports": [str(path) for path in reports]})
    return 0


def _rebuilt_reports(folder: Path) -> list[Path]:
    studies = [module for name, module in STUDIES.items() if (folder / name).is_file()]
    if studies:  # a comparison may stand in the folder of the readings that it confirms
        return [importlib.import_module(module).rebuild(folder) for module in studies]
    cases = stored_runs(folder)
    from studies.run.report.page import write_report

    over_all = [importlib.import_module(STARTS_MODULE).rebuild(folder)] if (folder / STARTS_FILE).is_file() else []
    return [*(write_report(case) for case in cases), *over_all]
