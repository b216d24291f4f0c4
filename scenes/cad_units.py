"""The unit of a CAD file: stated by the user or fixed by the format, never guessed; absurd sizes are refused."""

from pathlib import Path

from materials.input_error import InputError

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254}
"""Metres per unit [m]."""
IN_METRES = (".glb", ".gltf")
"""glTF 2.0 fixes the metre; not every exporter heeds it, so a stated unit wins."""
SELF_STATED = (".step", ".stp")
"""STEP states its unit and is converted to metres on reading, so a stated unit has nothing to say."""
SMALLEST, LARGEST = 0.005, 1.0
"""Longest side that a part may have [m] (choice): two depth pixels at 0.3 m; the width of the table."""


def metres_per_unit(path: Path, units: str | None, longest_side: float) -> float:
    """Scale from file to metres [m per unit]; raises InputError if the unit is missing, unknown or absurd.

    longest_side: of the bounding box, in the file's unit.
    """
    suffix = path.suffix.lower()
    if units is not None and units not in METRES:
        raise InputError(f"{path}: unknown unit {units}; pass --units mm, cm, m or in")
    if units is None and suffix not in IN_METRES + SELF_STATED:
        raise InputError(f"{path}: {suffix[1:].upper()} files carry no unit; pass --units mm, cm, m or in")
    unit = "m" if units is None or suffix in SELF_STATED else units
    if not SMALLEST <= longest_side * METRES[unit] <= LARGEST:
        raise InputError(f"{path}: {_absurd(longest_side, unit)}")
    return METRES[unit]


def _absurd(longest_side: float, units: str) -> str:
    size = longest_side * METRES[units]
    fitting = [unit for unit in METRES if SMALLEST <= longest_side * METRES[unit] <= LARGEST]
    found = f"bounding box is {_length(size)} long with --units {units}"
    if not fitting:
        return f"{found}; parts are {_length(SMALLEST)} to {_length(LARGEST)} long, so scale it in CAD"
    others = " or ".join(f"--units {unit} ({_length(longest_side * METRES[unit])})" for unit in fitting)
    return f"{found}; parts are {_length(SMALLEST)} to {_length(LARGEST)} long; pass {others}"


def _length(metres: float) -> str:
    return f"{metres:.4g} m" if metres >= 1 else f"{metres * 1000:.4g} mm"
