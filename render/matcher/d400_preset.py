"""RealSense D400 presets for the D4-like matcher: by name, or from a preset file of the RealSense viewer.

Presets count in the chip's units. What `D4Settings` holds belongs to the Default preset, so every other value is taken
in proportion: `param-secondpeakdelta` 650, twice the Default's, gives twice the matcher's default. Names, values and
keys: librealsense, `presets.cpp` (D43x) and `json_loader.hpp`.
"""

import json
import math
from dataclasses import dataclass, replace
from pathlib import Path

from materials.input_error import InputError
from materials.suggestion import suggest
from render.matcher.d4.matcher import D4Matcher
from render.matcher.d4.settings import D4Settings

P1_KEYS = ("param-scanlinep1", "param-scanlinep1onediscon", "param-scanlinep1twodiscon")
P2_KEYS = ("param-scanlinep2", "param-scanlinep2onediscon", "param-scanlinep2twodiscon")
SECOND_PEAK, LEFT_RIGHT = "param-secondpeakdelta", "param-leftrightthreshold"
RSM_DIFFERENCE, RSM_REMOVE, RSM_ON = "param-rsmdiffthreshold", "param-rsmremovethreshold", "param-usersm"
SHIFT, UNITS = "param-disparityshift", "param-depthunits"
ALIASES = {"param-zunits": UNITS, "aux-param-disparityshift": SHIFT, "aux-param-depthunits": UNITS}

RSM_WINDOW = 168
"""Neighbours that the chip's RSM stage counts, 13 x 13 - 1; the file holds shares of them (`json_loader.hpp`)."""
LEFT_RIGHT_STEPS = 32
"""`param-leftrightthreshold` counts 1/32 px."""

LIMITS = {
    **dict.fromkeys((*P1_KEYS, *P2_KEYS, SECOND_PEAK), (0, 1023)),
    LEFT_RIGHT: (0, 2047),
    RSM_DIFFERENCE: (0, 8),
    RSM_REMOVE: (0, 1),
    RSM_ON: (0, 1),
    SHIFT: (0, 512),
    UNITS: (1, 1_000_000),
}
"""What a file may hold: the widths of the chip's registers; depth units from 1 um to 1 m."""


def _preset(second_peak: float, left_right: float, p1: tuple, p2: tuple, difference: float, least: int) -> dict:
    values = {SECOND_PEAK: second_peak, LEFT_RIGHT: left_right, RSM_DIFFERENCE: difference, RSM_ON: 1}
    return {**values, RSM_REMOVE: least / RSM_WINDOW, **dict(zip(P1_KEYS + P2_KEYS, p1 + p2, strict=True))}


D400_PRESETS = {
    "default": _preset(325, 24, (60, 105, 70), (342, 190, 130), 4.0, 63),
    "high_accuracy": _preset(647, 10, (155, 160, 59), (190, 507, 493), 1.65625, 136),
    "high_density": _preset(222, 18, (55, 326, 134), (235, 506, 206), 1.21875, 82),
    "medium_density": _preset(600, 19, (132, 77, 234), (342, 390, 151), 1.8125, 81),
    "hand": _preset(31, 20, (63, 14, 119), (45, 21, 12), 3.8125, 92),
}
"""The viewer's presets, as far as the matcher has a counterpart."""


@dataclass(frozen=True)
class D400Preset:
    """What a preset means to the simulated camera.

    Values count in proportion to the Default preset's (head of the module). What the matcher has no counterpart for
    changes nothing and is named in `ignored`.
    """

    name: str
    """Of the preset or its file."""
    settings: D4Settings
    shift: int = 0
    """Start of the disparity search [px]."""
    depth_unit: float = 1e-3
    """Depth of one z16 step [m]."""
    ignored: tuple[str, ...] = ()
    """Keys of the file that the matcher has no counterpart for."""

    def matcher(self) -> D4Matcher:
        """The D4-like matcher under this preset."""
        return D4Matcher(self.settings, self.shift)


def preset_by_name(name: str) -> D400Preset:
    """One of the viewer's presets; upper case, blanks and dashes do not matter."""
    key = name.strip().lower().replace(" ", "_").replace("-", "_")
    if key not in D400_PRESETS:
        raise InputError(f"preset {name!r}: unknown; {suggest(key, D400_PRESETS)}")
    return D400Preset(key, _settings(D400_PRESETS[key]))


def preset_from_file(path: Path) -> D400Preset:
    """A preset file of the RealSense viewer, flat or with its values under `parameters`."""
    values, ignored = {}, []
    for key, value in _parameters(path).items():
        known = ALIASES.get(key, key)
        if known in LIMITS:
            values[known] = _number(path, key, value, *LIMITS[known])
        else:
            ignored.append(key)
    settings = _settings({**D400_PRESETS["default"], **values})
    return D400Preset(path.stem, settings, int(values.get(SHIFT, 0)), values.get(UNITS, 1000) * 1e-6, tuple(ignored))


def _settings(values: dict[str, float]) -> D4Settings:
    """The settings whose ratio to the defaults is that of `values` to the Default preset."""
    standard, default = D4Settings(), D400_PRESETS["default"]

    def scaled(ours: tuple[int, int, int], keys: tuple[str, ...]) -> tuple[int, int, int]:
        a, b, c = (round(value * values[key] / default[key]) for value, key in zip(ours, keys, strict=True))
        return a, b, c

    return replace(
        standard,
        p1=scaled(standard.p1, P1_KEYS),
        p2=scaled(standard.p2, P2_KEYS),
        second_peak=standard.second_peak * values[SECOND_PEAK] / default[SECOND_PEAK],
        left_right_px=values[LEFT_RIGHT] / LEFT_RIGHT_STEPS,
        neighbour_px=values[RSM_DIFFERENCE],
        neighbour_least=round(values[RSM_REMOVE] * RSM_WINDOW) if values[RSM_ON] else 0,
    )


def _parameters(path: Path) -> dict[str, object]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such preset file; presets by name are {', '.join(D400_PRESETS)}") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a preset file ({error}); export it from the viewer") from None
    parameters = content.get("parameters", content) if isinstance(content, dict) else None
    if not isinstance(parameters, dict):
        raise InputError(f"{path}: holds no parameters; a preset file is one JSON object of `param-...` keys")
    return parameters


def _number(path: Path, key: str, value: object, least: float, most: float) -> float:
    try:
        number = float(value) if isinstance(value, str | int | float) else math.nan
    except ValueError:
        number = math.nan
    if not least <= number <= most:
        raise InputError(f"{path}: {key} is {value!r}; give a number from {least:g} to {most:g}")
    return number
