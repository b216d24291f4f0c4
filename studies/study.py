"""`franbv study QUESTION`: the studies by name; each is a module of its own that is imported when it is asked for."""

import importlib
import sys

from materials.input_error import InputError
from materials.suggestion import suggest

STUDIES = {
    "comparison": (
        "studies.comparison",
        "Whether FRA-NBV covers more than PB-NBV and ray-cast entropy, as the paper measured.",
    ),
    "sensitivity": (
        "studies.sensitivity",
        "Which materials and angles break the depth, the detector and the recovery.",
    ),
}
"""Study -> (module with `run(args) -> exit status`, the question it answers)."""


def run(args: list[str]) -> int:
    """Run the study that the first argument names."""
    if not args or args[0] in ("-h", "--help"):
        (sys.stdout if args else sys.stderr).write(overview())
        return 0 if args else 2
    if args[0] not in STUDIES:
        raise InputError(f"unknown study `{args[0]}`; {suggest(args[0], STUDIES)}")
    return importlib.import_module(STUDIES[args[0]][0]).run(args[1:])


def overview() -> str:
    """The help text."""
    width = max(map(len, STUDIES))
    lines = [f"  {name:<{width}}  {question}" for name, (_, question) in STUDIES.items()]
    return "\n".join(
        ["usage: franbv study STUDY [options]", "", *lines, "", "franbv study STUDY --help lists options.", ""]
    )
