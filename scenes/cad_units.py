"""The unit of a CAD file: stated by the user or fixed by the format, never guessed; absurd sizes are refused."""

from pathlib import Path

from materials.input_error import InputError

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254}
"""Metres per unit [m]."""
IN_METRES = (".glb", ".gltf")
"""glTF 2.0 fixes the metre; not every exporter heeds it, so a stated unit wins."""
SELF_STATED = (".step", ".stp")
"""STEP states its unit in the file and is converted to metres on reading, so a unit of the user's has no say."""
SMALLEST, LARGEST = 0.005, 1.0
"""Longest side that a part may have [m] (choice): two depth pixels at 0.3 m; the width of the table."""


def metres_per_unit(path: Path, units: str | None, longest_side: float, own: str | None = None) -> float:
    """Scale from file to metres [m per unit]; raises InputError if the unit is missing, unknown or absurd.

    longest_side: of the bounding box, in the file's unit, in metres for STEP.
    own: the unit that a STEP file states, in words.
    """
    suffix = path.suffix.lower()
    if units is not None and units not in METRES:
        raise InputError(f"{path}: unknown unit {units}; pass --units mm, cm, m or in")
    if units is None and suffix not in IN_METRES + SELF_STATED:
        raise InputError(f"{path}: {suffix[1:].upper()} files carry no unit; pass --units mm, cm, m or in")
    unit = "m" if units is None or suffix in SELF_STATED else units
    if not SMALLEST <= longest_side * METRES[unit] <= LARGEST:
        absurd = _absurd_of_itself(longest_side, own) if suffix in SELF_STATED else _absurd(longest_side, unit)
        raise InputError(f"{path}: {absurd}")
    return METRES[unit]


def unheeded_unit(units: str | None, own: str | None) -> tuple[str, ...]:
    """A notice where the user states another unit than the file does, which wins."""
    if own is None or units in (None, own):
        return ()
    return (f"the file states its own unit, {own}, which is taken; --units {units} has no say",)


def _absurd(longest_side: float, units: str) -> str:
    size = longest_side * METRES[units]
    fitting = [unit for unit in METRES if SMALLEST <= longest_side * METRES[unit] <= LARGEST]
    found = f"bounding box is {_length(size)} long with --units {units}"
    if not fitting:
        return f"{found}; parts are {_length(SMALLEST)} to {_length(LARGEST)} long, so scale it in CAD"
    others = " or ".join(f"--units {unit} ({_length(longest_side * METRES[unit])})" for unit in fitting)
    return f"{found}; parts are {_length(SMALLEST)} to {_length(LARGEST)} long; pass {others}"


def _absurd_of_itself(metres: float, own: str | None) -> str:
    """For a file that states its unit: what it says, and which factors would do."""
    stated = f"{_in_unit(metres, own)}, as the file's own unit is {own}" if own else f"{_length(metres)} long"
    factors = {"1/25.4": 1 / 25.4, "25.4": 25.4, "1/1000": 1e-3, "1000": 1e3, "1/10": 0.1, "10": 10.0}
    fitting = [
        f"by {name} ({_length(metres * factor)})"
        for name, factor in factors.items()
        if SMALLEST <= metres * factor <= LARGEST
    ]
    scale = f"scale it in CAD{', such as ' + ' or '.join(fitting) if fitting else ''}"
    return (
        f"bounding box is {stated}; parts are {_length(SMALLEST)} to {_length(LARGEST)} long; --units cannot change "
        f"what a STEP file states: {scale}, or export it again in its true unit"
    )


def _in_unit(metres: float, own: str) -> str:
    """The length as the file gives it, and in metres or millimetres where that is another word."""
    length = _length(metres)
    given = f"{metres / METRES[own]:.4g} {own}" if own in METRES else length
    return f"{length} long" if given == length else f"{given} ({length}) long"


def _length(metres: float) -> str:
    return f"{metres:.4g} m" if metres >= 1 else f"{metres * 1000:.4g} mm"
