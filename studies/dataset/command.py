"""`franbv dataset make|check|show`: each is a module of its own that is imported when it is asked for."""

import importlib
import sys

from materials.input_error import InputError
from materials.suggestion import suggest

ACTIONS = {
    "make": ("studies.dataset.make", "Render labelled depth of random scenes from a declared distribution."),
    "check": ("studies.dataset.check", "Verify every byte, label, pose and unit of a dataset."),
    "show": ("studies.dataset.show", "Make a contact sheet and statistics of a dataset."),
}
"""Action -> (module with `run(args) -> exit status`, what it does)."""


def run(args: list[str]) -> int:
    """Run the action that the first argument names."""
    if not args or args[0] in ("-h", "--help"):
        (sys.stdout if args else sys.stderr).write(overview())
        return 0 if args else 2
    if args[0] not in ACTIONS:
        raise InputError(f"unknown action `{args[0]}`; {suggest(args[0], ACTIONS)}")
    return importlib.import_module(ACTIONS[args[0]][0]).run(args[1:])


def overview() -> str:
    """The help text."""
    width = max(map(len, ACTIONS))
    lines = [f"  {name:<{width}}  {what}" for name, (_, what) in ACTIONS.items()]
    return "\n".join(
        ["usage: franbv dataset ACTION [options]", "", *lines, "", "franbv dataset ACTION --help lists options.", ""]
    )
