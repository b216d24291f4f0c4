"""The mend for a name that does not exist: the nearest names, or all of them."""

import difflib
from collections.abc import Iterable


def suggest(name: str, known: Iterable[str]) -> str:
    """`did you mean x or y?` when something near exists, else `known: ...`."""
    names = list(known)
    near = difflib.get_close_matches(name.lower(), names, n=3)
    return f"did you mean {' or '.join(near)}?" if near else f"known: {', '.join(names)}"
