"""`franbv report DIR`: rebuild the HTML report of every finished reconstruction in a folder."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from materials.input_error import InputError
from studies.command_line import parse
from studies.console import say, say_json
from studies.sensitivity_plan import PLAN
from studies.stored_run import stored_runs

COMPARISON = "comparison.json"
"""What the folder of a comparison is known by."""


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
    if (folder / COMPARISON).is_file():
        from studies.comparison import rebuild

        return [_rebuilt(rebuild, folder)]
    if (folder / PLAN).is_file():
        from studies.report.sensitivity_page import rebuild

        return [_rebuilt(rebuild, folder)]
    cases = stored_runs(folder)
    from studies.report.page import write_report

    return [_rebuilt(write_report, case) for case in cases]


def _rebuilt(write_report, case: Path) -> Path:
    try:
        return write_report(case)
    except (OSError, ValueError, KeyError) as error:
        if isinstance(error, InputError):
            raise
        reason = f"{type(error).__name__}: {error}"
        raise InputError(
            f"{case}: the stored results are incomplete or damaged ({reason}); remove it, run it again"
        ) from None
