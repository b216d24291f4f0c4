"""The command line: imports only the command that is asked for, and turns bad input into one line and exit status 2."""

import contextlib
import importlib
import signal
import sys
from collections.abc import Iterator, Sequence

from materials.input_error import InputError
from materials.suggestion import suggest

COMMANDS = {
    "doctor": ("studies.doctor", "Check that this machine can render; say what to mend when it cannot."),
    "frame": ("studies.frame", "Take one frame of a part and write every layer of it, truth included."),
    "match": ("studies.match", "Match a real infrared pair; score the depth against a reference."),
    "reconstruct": ("studies.reconstruct", "Reconstruct a part view by view and report how it went."),
    "study": ("studies.study", "Ask which materials and angles break depth, detector and recovery."),
    "dataset": ("studies.dataset.command", "Make, check and show datasets of labelled depth with reflective holes."),
    "report": ("studies.report_command", "Rebuild the HTML report from the stored results."),
}
"""Command -> (module with `run(args) -> exit status`, what it does)."""

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
            return _run(args[0], args[1:])
    except InputError as error:
        return _complain(args[0], str(error), BAD_INPUT)
    except Stopped as stop:
        return _complain(args[0], f"stopped by {stop}; the same command takes the work up again", stop.exit_status)
    except BrokenPipeError:
        sys.stderr.close()  # whoever read us has gone; say nothing more
        return DONE


def overview() -> str:
    """The help text of the program."""
    width = max(map(len, COMMANDS))
    lines = [f"  {name:<{width}}  {summary}" for name, (_, summary) in COMMANDS.items()]
    return "\n".join(
        [
            "usage: franbv COMMAND [options]",
            "",
            "Active-stereo depth of shiny metal, rendered with its holes, and the next-best-view planner it drives.",
            "",
            *lines,
            "",
            "franbv COMMAND --help lists a command's options.",
            "Exit status: 0 done, 1 a check failed, 2 bad input.",
            "",
        ]
    )


def _run(name: str, args: list[str]) -> int:
    if name not in COMMANDS:
        raise InputError(f"unknown command `{name}`; {suggest(name, COMMANDS)}")
    try:
        return importlib.import_module(COMMANDS[name][0]).run(args)
    except SystemExit as stop:  # after --help
        return int(stop.code or 0)


def _complain(command: str, message: str, status: int) -> int:
    line = " ".join(message.split())
    sys.stderr.write(f"franbv {command}: {line}\n" if command in COMMANDS else f"franbv: {line}\n")
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
