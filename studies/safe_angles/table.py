"""The table of safe angles of a folder, from its finished views, as planners read it."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from franbv.surfaces.safe_angles import SAFE_ANGLES_FORMAT, MaterialAngles, SafeAngles
from materials.input_error import InputError
from render.matcher.d400_preset import is_file_name
from studies.base.atomic_file import write_atomically
from studies.base.console import strict_json
from studies.safe_angles.angles import LEAST_BIN_PX, roll_angles
from studies.safe_angles.bounds import least_views
from studies.safe_angles.plan import AnglesPlan
from studies.safe_angles.settings import SafeAnglesSettings
from studies.sensitivity.counts import INCIDENCE_BIN_DEG
from studies.sensitivity.tables import Tables, gather_tables

SAFE_ANGLES = "safe_angles.json"
"""The table's file."""


def stored_tables(out: Path, plan: AnglesPlan) -> Tables:
    """The tables of the views that are finished; `sweep` is the material."""
    return gather_tables(out, [(view.material, view.digest) for view in plan.views])


def safe_angles_table(plan: AnglesPlan, tables: Tables) -> SafeAngles:
    """Bins and ranges of every material at every roll; InputError where no view shows the part."""
    rolls = {view.digest: view.roll_deg for view in plan.views}
    if tables.views and not any(row["part_pixels"] for row in tables.views):
        raise InputError(
            f"{tables.views[0]['subject']}: no view shows a pixel of it; choose a --distance from which it is seen, or "
            "a wider --sensor.crop"
        )
    rows = {
        (spec, roll): [r for r in tables.incidence if (r["material"], rolls[r["case"]]) == (spec, roll)]
        for spec in plan.settings.material
        for roll in plan.settings.rolls
    }
    materials = tuple(
        MaterialAngles(
            spec,
            tuple(
                roll_angles(roll, rows[spec, roll], plan.target_share, plan.confidence) for roll in plan.settings.rolls
            ),
        )
        for spec in plan.settings.material
    )
    return SafeAngles(
        plan.target_share,
        plan.confidence,
        least_views(plan.confidence),
        LEAST_BIN_PX,
        measured_for(plan.settings),
        materials,
    )


def write_safe_angles(out: Path, table: SafeAngles, versions: Mapping[str, str]) -> Path:
    """Write the table; returns its path."""
    stored = {"format": SAFE_ANGLES_FORMAT, "bin_width_deg": INCIDENCE_BIN_DEG, **asdict(table), "versions": versions}
    path = out / SAFE_ANGLES
    write_atomically(path, strict_json(stored, indent=1).encode())
    return path


def measured_for(settings: SafeAnglesSettings) -> dict[str, Any]:
    """What the table holds for, units in the names."""
    sensor = settings.sensor
    held = {} if sensor.auto_exposure else {"exposure_us": sensor.imager.exposure_us, "gain": sensor.imager.gain}
    return {
        "part": settings.part,
        "mesh": settings.mesh.name if settings.mesh else None,
        "bench": settings.bench,
        "lamps": settings.lamps,
        "room": settings.room,
        "distance_m": settings.distance,
        "poses": settings.poses,
        "most_polar_deg": settings.most_polar,
        "seed": settings.seed,
        "frames": settings.frames,
        "camera": sensor.model,
        "profile": sensor.profile,
        "sensor_preset": _preset_name(sensor.preset),
        "laser_mw": sensor.imager.laser_power_mw,
        "auto_exposure": sensor.auto_exposure,
        **held,
    }


def _preset_name(preset: str) -> str:
    """A preset's name, or its file's; one given as text has none."""
    return "text" if preset.lstrip().startswith("{") else Path(preset).name if is_file_name(preset) else preset
