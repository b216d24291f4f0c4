"""The command line: imports only the command that is asked for, and turns bad input into one line and exit status 2."""

import contextlib
import importlib
import os
import signal
import sys
import traceback
from collections.abc import Iterator, Sequence

from materials.input_error import InputError
from materials.suggestion import suggest

COMMANDS = {
    "doctor": ("studies.cli.doctor", "Check that this machine can render; say what to mend when it cannot."),
    "frame": ("studies.cli.frame", "Take one frame of a part and write every layer of it, truth included."),
    "match": ("studies.cli.match", "Match a real infrared pair; score the depth against a reference."),
    "reconstruct": ("studies.cli.reconstruct", "Reconstruct a part view by view and report how it went."),
    "replay": ("studies.cli.replay", "Detect and plan on a recording, with no robot."),
    "calibrate hand-eye": ("studies.cli.calibrate", "Calibrate where the camera sits on the flange of an arm."),
    "safe-angles": (
        "studies.safe_angles.command",
        "At which angles of incidence a material gives right depth: a card for each, a table for planners.",
    ),
    "advise": (
        "studies.advise.command",
        "Which remedy for shiny metal helps on this part: ranked with intervals, the best combination as files.",
    ),
    "study sensitivity": (
        "studies.sensitivity.command",
        "Which materials and angles break the depth, the detector and the recovery.",
    ),
    "study comparison": (
        "studies.comparison.command",
        "Whether FRA-NBV covers more than PB-NBV and ray-cast entropy, as the paper measured.",
    ),
    "study readings": (
        "studies.readings.command",
        "Which reading of what the paper's text leaves open makes its table.",
    ),
    "study thresholds": (
        "studies.thresholds.command",
        "Which thresholds are safe for declared parts, with which confidence.",
    ),
    "study mitigations": (
        "studies.mitigations.command",
        "Which remedy for shiny metal wins on which metal, finish and shape, and which common advice is wrong.",
    ),
    "run": ("studies.cli.robot:run", "Reconstruct with a real camera on a real arm; a dry run unless told to move."),
    "record": ("studies.cli.robot:record", "Take bursts of a real camera by hand; nothing is moved."),
    "cameras": ("studies.cli.robot:cameras", "List the RealSense cameras that are plugged in."),
    "dataset make": (
        "studies.dataset.make.command",
        "Render labelled depth of random scenes from a declared distribution.",
    ),
    "dataset check": ("studies.dataset.check.command", "Verify every byte, label, pose and unit of a dataset."),
    "dataset show": ("studies.dataset.show.command", "Make a contact sheet and statistics of a dataset."),
    "monitor": ("studies.cli.monitor", "Hold a cell's runs against the declared domain of a threshold certificate."),
    "report": ("studies.cli.report", "Rebuild the HTML report from the stored results."),
}
"""Command, of one word or two -> (module with `run(args) -> exit status`, or another function of it, what it does)."""

DEBUG_VARIABLE = "FRANBV_DEBUG"
"""Set to 1, an error in one line is preceded by where it came from."""
DONE, CHECK_FAILED, BAD_INPUT = 0, 1, 2
"""Exit statuses."""


class Stopped(KeyboardInterrupt):
    """SIGINT or SIGTERM arrived; unfinished work is put away on the way out."""

    def __init__(self, signal_number: int) -> None:
        super().__init__(signal.Signals(signal_number).name)
        self.exit_status = 128 + signal_number  # the shells' convention


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command that `argv` (without the program's name) spells; returns the exit status."""
    args = list(sys.argv[1:] if argv is None else argv)
    if not args or args[0] in ("-h", "--help", "help"):
        (sys.stdout if args else sys.stderr).write(overview())
        return DONE if args else BAD_INPUT
    if args[0] == "--version":
        from importlib.metadata import version

        sys.stdout.write(f"franbv {version('franbv')}\n")
        return DONE
    try:
        with _stopped_by_signals():
            return _run(args)
    except InputError as error:
        if os.environ.get(DEBUG_VARIABLE) == "1":
            traceback.print_exc()
        return _complain(args[0], str(error), BAD_INPUT)
    except Stopped as stop:
        return _complain(args[0], f"stopped by {stop}; the same command takes the work up again", stop.exit_status)
    except BrokenPipeError:
        sys.stderr.close()  # whoever read us has gone; say nothing more
        return DONE


def overview(group: str = "") -> str:
    """The help text of the program, or of the commands whose first word is `group`."""
    shown = {name: summary for name, (_, summary) in COMMANDS.items() if name.startswith(group)}
    width = max(map(len, shown))
    return "\n".join(
        [
            f"usage: franbv {group or 'COMMAND'} {'ACTION ' if group else ''}[options]",
            "",
            "Active-stereo depth of shiny metal, rendered with its holes, and the next-best-view planner it drives.",
            "",
            *(f"  {name:<{width}}  {summary}" for name, summary in shown.items()),
            "",
            "franbv COMMAND --help lists a command's options.",
            "Exit status: 0 done, 1 a check failed, 2 bad input. FRANBV_DEBUG=1 shows where an error came from.",
            "",
        ]
    )


OURS = ("franbv", "render", "scenes", "materials", "studies")
"""A module of these that is missing is a fault, anything else an extra that was not installed."""
FIRST_WORDS = {name.split()[0] for name in COMMANDS if " " in name}
"""First words of the commands of two."""


def _run(args: list[str]) -> int:
    if args[0] in FIRST_WORDS and (len(args) == 1 or args[1] in ("-h", "--help")):
        (sys.stdout if len(args) > 1 else sys.stderr).write(overview(args[0]))
        return DONE if len(args) > 1 else BAD_INPUT
    name = " ".join(args[:2]) if args[0] in FIRST_WORDS else args[0]
    if name not in COMMANDS:
        raise InputError(f"unknown command `{name}`; {suggest(name, COMMANDS)}")
    try:
        module, _, function = COMMANDS[name][0].partition(":")
        return getattr(importlib.import_module(module), function or "run")(args[len(name.split()) :])
    except ModuleNotFoundError as error:
        if (error.name or "franbv").split(".")[0] in OURS:
            raise
        raise InputError(f"needs the package {error.name}; pip install 'franbv[studies]'") from error
    except SystemExit as stop:  # after --help
        return int(stop.code or 0)


def _complain(command: str, message: str, status: int) -> int:
    line = " ".join(message.split())
    known = command in FIRST_WORDS or command in COMMANDS
    sys.stderr.write(f"franbv {command}: {line}\n" if known else f"franbv: {line}\n")
    return status


@contextlib.contextmanager
def _stopped_by_signals() -> Iterator[None]:
    """Both signals unwind the program, also where the shell made it deaf to Ctrl-C (background jobs)."""

    def stop(signal_number: int, frame: object) -> None:
        raise Stopped(signal_number)

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
