"""What a study's folder was asked to hold, so that its tables and its report can be built from the folder alone."""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from materials.input_error import InputError
from studies.base.atomic_file import write_atomically
from studies.base.config import Config
from studies.base.console import strict_json
from studies.base.reading import reading
from studies.work.maker import versions

PLAN = "study.json"
"""File of a sensitivity study."""
PLAN_FORMAT = 2
"""Of the file; it rises when a report cannot be made from older ones."""


@dataclass(frozen=True)
class Plan:
    """A study as it was asked for last."""

    title: str
    preset: dict[str, Any]
    """Resolved."""
    cases: tuple[tuple[str, str], ...]
    """(sweep, folder of the case) in the preset's order; a case that two sweeps share stands there twice."""
    versions: dict[str, str]


def write_plan(out: Path, title: str, preset: Config, cases: Iterable[tuple[str, str]]) -> Plan:
    """Put down what is wanted before the first case is measured; cases as in `Plan`."""
    plan = Plan(title, preset.model_dump(mode="json"), tuple(cases), versions())
    write_atomically(out / PLAN, strict_json({"format": PLAN_FORMAT, **vars(plan)}, indent=1).encode())
    return plan


def read_plan(out: Path) -> Plan:
    """The plan as it was written; InputError in one line if it cannot be read."""
    with reading(out / PLAN, "give the study's command again"):
        stored = json.loads((out / PLAN).read_text(encoding="utf-8"))
        if stored.get("format") != PLAN_FORMAT:
            raise InputError(
                f"{out / PLAN}: was written by an older or newer version (format {stored.get('format', 1)}, here "
                f"{PLAN_FORMAT}); read it with that version, or give the study's command again with another --out"
            )
        cases = tuple((sweep, case) for sweep, case in stored["cases"])
        return Plan(stored["title"], stored["preset"], cases, stored["versions"])
