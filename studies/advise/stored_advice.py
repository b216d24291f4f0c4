"""What a folder of an advice keeps, so that the page can be made from it alone."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.advise.advice import Advice, advice_json, read_advice
from studies.base.atomic_file import write_atomically
from studies.base.console import strict_json
from studies.base.reading import MALFORMED, reading

ADVICE = "advice.json"
"""File that the folder is known by."""
ADVICE_FORMAT = 2
"""Of the file; it rises when the page cannot be made from older ones."""


@dataclass(frozen=True)
class StoredAdvice:
    """The answer, and what is shown beside it."""

    title: str
    advice: Advice
    headline: str
    untried: tuple[str, ...]
    """Remedies for which there was no time."""
    impossible: tuple[str, ...]
    """Remedies for which the camera would have to stand where it cannot."""
    poses: tuple[str, ...]
    """As the command line spells them."""
    lost_before: dict[str, float]
    """Shares of the part's surface that the camera as it is set loses to each cause."""
    lost_after: dict[str, float]
    """The same as advised."""
    faces: tuple[dict[str, Any], ...]
    """`FaceRow`, as mappings."""
    pictures: tuple[dict[str, str], ...]
    """Of each explained pose, images as data URIs by name."""
    settings: dict[str, Any]
    versions: dict[str, str]
    wall_s: float
    """Of all commands on this folder [s]."""


def write_stored_advice(out: Path, stored: StoredAdvice) -> None:
    """Whole or not at all."""
    text = {"format": ADVICE_FORMAT, **vars(stored), "advice": advice_json(stored.advice)}
    write_atomically(out / ADVICE, strict_json(text, indent=1).encode())


def read_stored_advice(out: Path) -> StoredAdvice:
    """As it was written; InputError in one line if it cannot be read."""
    path = out / ADVICE
    with reading(path, "give the command again"):
        text = json.loads(path.read_text(encoding="utf-8"))
        if text.pop("format") != ADVICE_FORMAT:
            raise ValueError("written by another version")
        lists = {name: tuple(text.pop(name)) for name in ("untried", "impossible", "poses", "faces", "pictures")}
        return StoredAdvice(**{**text, **lists, "advice": read_advice(text["advice"])})


def stored_wall_s(out: Path) -> float:
    """What earlier commands took [s]; 0 without any, and where their answer cannot be read: it is written anew."""
    try:
        return float(json.loads((out / ADVICE).read_text(encoding="utf-8"))["wall_s"])
    except MALFORMED:
        return 0.0
