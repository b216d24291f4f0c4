"""What the commands say: results on stdout, progress and warnings on stderr, numbers as strict JSON."""

import json
import math
import sys
from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

JSON_SCHEMA = 1
"""Of what `--json` prints; it rises when a figure is renamed or means something else."""


def say(text: str) -> None:
    """One paragraph of the result, on stdout."""
    sys.stdout.write(text.rstrip("\n") + "\n")
    sys.stdout.flush()


def warn(text: str) -> None:
    """One line on stderr."""
    sys.stderr.write(text.rstrip("\n") + "\n")
    sys.stderr.flush()


def say_json(values: Mapping[str, Any]) -> None:
    """The summary for machines: one line, one object, with the version of what all such objects hold."""
    say(strict_json({"schema": JSON_SCHEMA, **values}))


def strict_json(values: Any, indent: int | None = None) -> str:
    """JSON without NaN and infinity, which its standard does not know: they become null."""
    return json.dumps(_finite(values), indent=indent, allow_nan=False)


def progress_bar(shown: bool = True) -> Progress:
    """A progress display on stderr that stays silent where nobody watches (no terminal), and where it is not wanted."""
    console = Console(stderr=True)
    return Progress(
        TextColumn("[progress.description]{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console,
        disable=not (shown and console.is_terminal),
        transient=True,
    )


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    if hasattr(value, "tolist"):  # numpy scalars and arrays
        return _finite(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
