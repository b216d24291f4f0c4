"""Safe angles: the incidence at which a material gives right depth, as `franbv safe-angles` measures it for a planner.

table = read_safe_angles(Path("safe_angles.json"))
table.angles("iron:blasted", roll_deg=0).is_safe(35.0)
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

SAFE_ANGLES_FORMAT = 1
"""Of the file; it rises when a field is renamed or means something else."""


@dataclass(frozen=True)
class AngleBin:
    """What was found between two angles of incidence (between surface normal and view ray)."""

    from_deg: float
    """Smallest angle [deg]."""
    to_deg: float
    """Largest angle, that itself not [deg]."""
    views: int
    """Views that see enough of the part there; only they count below."""
    effective_views: float
    """How many views of one size would tell as much: a few that see most of the surface count for more."""
    part_pixels: int
    """Full-resolution pixels of the part in them [px]."""
    right_pixels: int
    """Of them: with depth, and that right [px]."""
    share: float | None
    """Of the surface that has right depth [0, 1]; None where no view counts."""
    lower_bound: float | None
    """Of that share over all views that could have been taken, with the table's confidence; None where the
    effective views are too few to know."""
    matte_share: float | None
    """Share that has right depth or would have it if the surface were matte: the rest is lost to shape and camera."""
    views_below: int
    """Views in which less than the table's share of the surface has right depth."""
    views_below_at_most: float | None
    """Upper bound, with the table's confidence, of the share of such views; None as before."""
    lost_to: str | None
    """Commonest cause of missing or false depth, by its name among the labels; None where all is right."""

    @property
    def is_known(self) -> bool:
        """Whether enough views count."""
        return self.lower_bound is not None


@dataclass(frozen=True)
class SafeRange:
    """Neighbouring bins, each of which is safe."""

    from_deg: float
    """Where the first begins [deg]."""
    to_deg: float
    """Where the last ends [deg]."""
    share: float
    """Of the surface in all its bins that has right depth [0, 1]."""
    lower_bound: float
    """The smallest of its bins."""


@dataclass(frozen=True)
class RollAngles:
    """One material under one roll of the camera."""

    roll_deg: float
    """Turn of the camera about its optical axis, 0 = baseline horizontal [deg]."""
    ranges: tuple[SafeRange, ...]
    """All that are safe, the widest first; empty where none is."""
    bins: tuple[AngleBin, ...]
    """From 0 to 90 deg without gaps."""

    def is_safe(self, incidence_deg: float) -> bool:
        """Whether this angle lies in a safe range: what is not known is not safe."""
        return any(span.from_deg <= incidence_deg <= span.to_deg for span in self.ranges)


@dataclass(frozen=True)
class MaterialAngles:
    """One material."""

    material: str
    """By name, `metal:finish`; `own` for what the real part is made of."""
    rolls: tuple[RollAngles, ...]


@dataclass(frozen=True)
class SafeAngles:
    """A whole table: a material's ranges hold for what it was measured for, and nothing else."""

    target_share: float
    """Of the surface that must have right depth [0, 1]."""
    confidence: float
    """Of each lower bound by itself [0, 1]."""
    least_views: int
    """Effective views that must see a bin before it is known."""
    least_pixels: int
    """Pixels of the part that a view must have in a bin to count [px]."""
    measured_for: Mapping[str, Any]
    """Part or mesh, light, distance, camera and its settings; units stand in the names."""
    materials: tuple[MaterialAngles, ...]

    def angles(self, material: str, roll_deg: float) -> RollAngles:
        """Of a material at a roll; ValueError that names what there is where this one was not measured."""
        found = {(entry.material, line.roll_deg): line for entry in self.materials for line in entry.rolls}
        if (material, roll_deg) not in found:
            known = ", ".join(f"{name} at {roll:g} deg" for name, roll in found)
            raise ValueError(f"no safe angles of {material} at roll {roll_deg:g} deg; there are those of {known}")
        return found[material, roll_deg]


def read_safe_angles(path: Path) -> SafeAngles:
    """The table in a file; ValueError in one line for another format or what is no such file, OSError for none."""
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        found = stored["format"]
        if found == SAFE_ANGLES_FORMAT:
            return _table(stored)
    except (ValueError, KeyError, TypeError) as error:
        words = f"{type(error).__name__}: {error}"
        raise ValueError(f"{path}: is no table of safe angles ({words}); make it with franbv safe-angles") from error
    raise ValueError(
        f"{path}: was written by an older or newer version (format {found}, here {SAFE_ANGLES_FORMAT}); read it with "
        "that version, or give franbv safe-angles again"
    )


def _table(stored: Mapping[str, Any]) -> SafeAngles:
    fields = {name: value for name, value in stored.items() if name in SafeAngles.__dataclass_fields__}
    materials = (
        MaterialAngles(entry["material"], tuple(_roll(line) for line in entry["rolls"]))
        for entry in stored["materials"]
    )
    return SafeAngles(**{**fields, "materials": tuple(materials)})


def _roll(line: Mapping[str, Any]) -> RollAngles:
    ranges = tuple(SafeRange(**span) for span in line["ranges"])
    return RollAngles(line["roll_deg"], ranges, tuple(AngleBin(**entry) for entry in line["bins"]))
