"""`franbv report DIR`: rebuild the HTML report of every finished reconstruction in a folder."""

import importlib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from franbv.adapters.view.opening import RRD, check_rrd
from materials.input_error import InputError
from studies.base.console import say, say_json, warn
from studies.base.flags import parse
from studies.run.stored_run import stored_runs
from studies.run.stored_sights import write_rrd
from studies.run.viewing import view_errors

STUDIES = {
    "advice.json": "studies.advise.command",
    "angles.json": "studies.safe_angles.command",
    "comparison.json": "studies.comparison.command",
    "mitigations.json": "studies.mitigations.command",
    "readings.json": "studies.readings.command",
    "study.json": "studies.sensitivity.report.page",
    "thresholds.json": "studies.thresholds.command",
}
"""File that a study's folder is known by -> module with `rebuild(folder) -> report`."""
RRD_FILE = f"run{RRD}"
"""What a case's own file for the viewer is called."""
EACH_CASE = Path()
"""Stands for `--rrd` without a name."""
_PROGRAM = "franbv report"
STARTS_FILE, STARTS_MODULE = "starts.json", "studies.run.starts.page"
"""The same of a folder of starts, which are reconstructions with reports of their own."""


@dataclass(frozen=True)
class ReportCommand:
    """The flags of `franbv report`."""

    folder: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    """Output folder of a reconstruction or one case in it, or that of a study."""
    rrd: Annotated[Path | None, tyro.conf.arg(metavar="[FILE.rrd]")] = None
    """Write the runs for the viewer rerun as well: in FILE.rrd, or without a name in `run.rrd` of each case. Needs the
    extra `view`."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Rebuild the reports from the stored results."""
    command = parse(ReportCommand, _named_rrd(args), _PROGRAM, "Rebuild the HTML report from the stored results.")
    rrds = {} if command.rrd is None else rrd_files(command.folder, command.rrd)
    reports = _rebuilt_reports(command.folder)
    for case, file in rrds.items():
        for words in write_rrd(case, file):
            warn(f"{_PROGRAM}: {words}")
    for path in [*reports, *rrds.values()]:
        say(f"{path}")
    if command.json:
        shown = {"rrds": [str(path) for path in rrds.values()]} if rrds else {}
        say_json({"reports": [str(path) for path in reports], **shown})
    return 0


def rrd_files(folder: Path, named: Path) -> dict[Path, Path]:
    """Case -> file to be written of it; InputError where one cannot be. named: EACH_CASE, or the file of one case."""
    if any((folder / name).is_file() for name in STUDIES):
        raise InputError(f"{folder}: holds a study; --rrd is for runs, so give the folder of one of its cases")
    cases = stored_runs(folder)
    if named != EACH_CASE and len(cases) > 1:
        raise InputError(
            f"--rrd {named}: {folder} holds {len(cases)} runs; leave the name out, or give one case's folder"
        )
    files = {case: case / RRD_FILE if named == EACH_CASE else named for case in cases}
    for file in files.values():
        with view_errors():
            check_rrd(file)
    return files


def _named_rrd(args: list[str]) -> list[str]:
    """The same with EACH_CASE after an `--rrd` that no file follows."""
    bare = [k for k, arg in enumerate(args) if arg == "--rrd" and not "".join(args[k + 1 : k + 2]).endswith(RRD)]
    return [word for k, arg in enumerate(args) for word in ([arg, str(EACH_CASE)] if k in bare else [arg])]


def _rebuilt_reports(folder: Path) -> list[Path]:
    studies = [module for name, module in STUDIES.items() if (folder / name).is_file()]
    if studies:  # a comparison may stand in the folder of the readings that it confirms
        return [importlib.import_module(module).rebuild(folder) for module in studies]
    cases = stored_runs(folder)
    from studies.run.report.page import write_report

    over_all = [importlib.import_module(STARTS_MODULE).rebuild(folder)] if (folder / STARTS_FILE).is_file() else []
    return [*(write_report(case) for case in cases), *over_all]
