"""Flags of one command as a typed model: a YAML file first, flags over it, and every mistake as one line."""

import contextlib
import io
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Generic, TypeVar

import tyro
from pydantic import BaseModel, ValidationError

from materials.input_error import InputError
from studies.base.config import check_finite, load_config, validation_line

HELP_INDENT = " " * 8
"""Tyro's indent of an option's description inside its boxes."""

REPEATABLE = "--material"
"""Takes several words, after one flag or each after a flag of its own; tyro would keep the last flag's alone."""

Settings = TypeVar("Settings", bound=BaseModel)
Parsed = TypeVar("Parsed")


@dataclass(frozen=True)
class CaseCommand(Generic[Settings]):
    """A command that makes one case: what decides the result (`settings`), and where and how it is given back."""

    settings: Annotated[Settings, tyro.conf.arg(name="")]
    out: Path
    """Output folder. The case gets a folder of its own in it; the same command finds a finished case there."""
    config: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """YAML file with any of the settings; flags override it."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


@dataclass(frozen=True)
class StartsCommand(CaseCommand[Settings]):
    """A command that makes one case, or one for each of many starts."""

    starts: Annotated[int, tyro.conf.arg(metavar="N")] = 1
    """Runs from N first views around the part, 360 / N deg apart, and their mean and spread: one run says little. The
    seeds are made from --seed and the azimuths."""
    workers: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Worker processes for many starts; the default is one for each processor."""
    record: Annotated[Path | None, tyro.conf.arg(metavar="FILE.mcap")] = None
    """Record the run: every burst, pose and decision, for `franbv replay` and other people's tools. Needs the extra
    `record`."""
    view: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Show the run in a browser on this computer while it lasts; the address is printed. Needs the extra `view`."""


@dataclass(frozen=True)
class RecordingCommand(Generic[Settings]):
    """A command that makes one case of a recording."""

    recording: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RECORDING")]
    """File or folder."""
    settings: Annotated[Settings, tyro.conf.arg(name="")]
    out: Path
    """Output folder. The case gets a folder of its own in it; the same command finds a finished case there."""
    config: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """YAML file with any of the settings, over those of the recording; flags override it."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""
    view: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Show the run in a browser on this computer while it lasts; the address is printed. Needs the extra `view`."""


AnyCommand = TypeVar("AnyCommand", bound=CaseCommand)


def parse_case_command(settings: type[Settings], args: list[str], prog: str, help_text: str) -> CaseCommand[Settings]:
    """The command that `args` spell; its `--config` file, if any, stands in for the defaults of `settings`."""
    return parse_wider_command(CaseCommand[settings], settings, args, prog, help_text)


def parse_wider_command(
    model: type[AnyCommand], settings: type[BaseModel], args: list[str], prog: str, help_text: str
) -> AnyCommand:
    """The same of a command that has flags beside those of every case: `model` adds them to `CaseCommand[settings]`."""
    file = _value_of("--config", args)
    default = model(settings=load_config(settings, Path(file)) if file else settings(), out=tyro.MISSING)
    command = parse(model, _gathered(REPEATABLE, args), prog, help_text, default)
    check_finite(command.settings, "the flags")
    return command


def parse(model: type[Parsed], args: list[str], prog: str, help_text: str, default: Parsed | None = None) -> Parsed:
    """`args` as a `model`; InputError with one line when they do not fit, SystemExit(0) after `--help`."""
    complaint = io.StringIO()
    try:
        with contextlib.redirect_stderr(complaint):
            # What is a model or none at all has flags only where a file gives it; subcommands would ask for an order.
            plain = (tyro.conf.AvoidSubcommands,)
            if default is None:
                return tyro.cli(model, args=args, prog=prog, description=help_text, config=plain)
            return tyro.cli(model, args=args, prog=prog, description=help_text, default=default, config=plain)
    except SystemExit as stop:
        if stop.code in (0, None):
            raise
        raise InputError(f"{condensed(complaint.getvalue())}; see {prog} --help") from None
    except ValidationError as error:  # of the settings themselves; those of nested models arrive condensed
        raise InputError(validation_line(error, "the flags")) from None


def condensed(complaint: str) -> str:
    """Tyro's boxed complaint as one line, without the help texts that it repeats."""
    lines = [re.sub(r"\x1b\[[0-9;]*m", "", line).rstrip("│ ") for line in complaint.splitlines()]
    lines = [line.removeprefix("│ ") for line in lines if line and line[0] not in "╭╰"]
    lines = [";" if line[:1] == "─" else line for line in lines if not line.startswith(HELP_INDENT)]
    lines = [line for line in lines if not re.match(r"For full helptext|\s+franbv .*--help", line)]
    text = " ".join(" ".join(lines).split()).split(" ; Argument helptext:")[0].replace(" ;", ";").rstrip("; .")
    return _without_pydantic(text) or "the flags cannot be understood"


def _without_pydantic(text: str) -> str:
    """The complaint of a model's field or validator in the words of the flags."""
    found = re.search(r"Error parsing (\S+): \d+ validation errors? for \w+ (.*?) \[type=\S+ input_value=(.*?), ", text)
    if not found:
        return text[:1].lower() + text[1:]
    model, problem, value = found.groups()
    parents = [part for part in model.split(".") if part != "settings"]
    if problem.startswith("Value error, "):
        where = f"--{'.'.join(parents)}.*: " if parents else ""
        return where + problem.removeprefix("Value error, ")
    field, problem = problem.split(" ", maxsplit=1)
    problem = problem.removeprefix("Value error, ")
    return f"--{'.'.join([*parents, field]).replace('_', '-')} {value}: {problem[0].lower()}{problem[1:]}"


def _value_of(flag: str, args: list[str]) -> str | None:
    """The value that follows `flag`, or that is joined to it by `=`."""
    for place, arg in enumerate(args):
        if arg == flag and place + 1 < len(args):
            return args[place + 1]
        if arg.startswith(f"{flag}="):
            return arg.removeprefix(f"{flag}=")
    return None


def _gathered(flag: str, args: list[str]) -> list[str]:
    """The same with all words of `flag` behind one, at the end."""
    others: list[str] = []
    words: list[str] = []
    inside = False
    for arg in args:
        if arg == flag or arg.startswith("--"):
            inside = arg == flag
        if arg.startswith(f"{flag}="):
            words.append(arg.removeprefix(f"{flag}="))
        elif arg != flag:
            (words if inside else others).append(arg)
    return [*others, flag, *words] if words else args
