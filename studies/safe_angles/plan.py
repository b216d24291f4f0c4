"""What a folder of safe angles was asked for last, so that table and page can be made from the folder alone."""

import json
from dataclasses import dataclass
from pathlib import Path

from materials.input_error import InputError
from studies.base.atomic_file import write_atomically
from studies.base.config import validated
from studies.base.console import strict_json
from studies.base.reading import reading
from studies.safe_angles.settings import SafeAnglesSettings
from studies.safe_angles.views import AnglesView
from studies.work.maker import versions

ANGLES_PLAN = "angles.json"
"""File that the folder is known by."""
ANGLES_PLAN_FORMAT = 1
"""Of the file; it rises when table and page cannot be made from older ones."""


@dataclass(frozen=True)
class PlannedView:
    """One view of the table."""

    material: str
    roll_deg: float
    digest: str
    """Folder of its case."""


@dataclass(frozen=True)
class AnglesPlan:
    """What is wanted."""

    settings: SafeAnglesSettings
    target_share: float
    """Of the surface that must have right depth [0, 1]."""
    confidence: float
    """Of each lower bound [0, 1]."""
    views: tuple[PlannedView, ...]
    versions: dict[str, str]


def write_angles_plan(
    out: Path, settings: SafeAnglesSettings, target_share: float, confidence: float, views: list[AnglesView]
) -> AnglesPlan:
    """Put down what is wanted before the first view is measured."""
    planned = tuple(PlannedView(view.material, view.roll_deg, view.digest) for view in views)
    plan = AnglesPlan(settings, target_share, confidence, planned, versions())
    stored = {
        "format": ANGLES_PLAN_FORMAT,
        **vars(plan),
        "settings": settings.model_dump(mode="json"),
        "views": [vars(view) for view in planned],
    }
    write_atomically(out / ANGLES_PLAN, strict_json(stored, indent=1).encode())
    return plan


def read_angles_plan(out: Path) -> AnglesPlan:
    """The plan as it was written; InputError in one line if it cannot be read."""
    path = out / ANGLES_PLAN
    with reading(path, "give the command again"):
        stored = json.loads(path.read_text(encoding="utf-8"))
        if stored["format"] != ANGLES_PLAN_FORMAT:
            raise InputError(
                f"{path}: was written by an older or newer version (format {stored['format']}, here "
                f"{ANGLES_PLAN_FORMAT}); read it with that version, or give the command again with another --out"
            )
        settings = validated(SafeAnglesSettings, stored["settings"], str(path))
        views = tuple(PlannedView(**view) for view in stored["views"])
        return AnglesPlan(settings, stored["target_share"], stored["confidence"], views, stored["versions"])
