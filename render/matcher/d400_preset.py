"""RealSense D400 presets: by name, from a preset file of the RealSense viewer, or as the text of such a file.

Presets count in the chip's units. What `D4Settings` holds belongs to the Default preset, so every other value is taken
in proportion: `param-secondpeakdelta` 650, twice the Default's, gives twice the matcher's default. Names, values and
keys: librealsense, `presets.cpp` (D43x; the D41x Default has the same values) and `json_loader.hpp`.
"""

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from materials.input_error import InputError
from materials.suggestion import suggest
from render.matcher.d4.settings import D4Settings

P1_KEYS = ("param-scanlinep1", "param-scanlinep1onediscon", "param-scanlinep1twodiscon")
P2_KEYS = ("param-scanlinep2", "param-scanlinep2onediscon", "param-scanlinep2twodiscon")
SECOND_PEAK, LEFT_RIGHT = "param-secondpeakdelta", "param-leftrightthreshold"
RSM_DIFFERENCE, RSM_REMOVE, RSM_ON = "param-rsmdiffthreshold", "param-rsmremovethreshold", "param-usersm"
SHIFT, UNITS = "param-disparityshift", "param-depthunits"
CLAMP_MIN, CLAMP_MAX, SET_POINT = "param-depthclampmin", "param-depthclampmax", "param-autoexposure-setpoint"
LASER_ON, LASER_POWER = "controls-laserstate", "controls-laserpower"
AUTO_EXPOSURE, EXPOSURE, GAIN = "controls-autoexposure-auto", "controls-autoexposure-manual", "controls-depth-gain"
MATCHER_KEYS = (*P1_KEYS, *P2_KEYS, SECOND_PEAK, LEFT_RIGHT, RSM_DIFFERENCE, RSM_REMOVE, RSM_ON, SHIFT)
"""What the matcher has a counterpart for."""
ALIASES = {"param-zunits": UNITS} | {f"aux-{key}": key for key in (SHIFT, UNITS, CLAMP_MIN, CLAMP_MAX, SET_POINT)}

RSM_WINDOW = 168
"""Neighbours that the chip's RSM stage counts, 13 x 13 - 1; the file holds shares of them (`json_loader.hpp`)."""

LIMITS = {
    **dict.fromkeys((*P1_KEYS, *P2_KEYS, SECOND_PEAK), (0, 1023)),
    LEFT_RIGHT: (0, 2047),
    RSM_DIFFERENCE: (0, 8),
    RSM_REMOVE: (0, 1),
    RSM_ON: (0, 1),
    SHIFT: (0, 512),
    UNITS: (1, 1_000_000),
    CLAMP_MIN: (0, 65536),
    CLAMP_MAX: (0, 65536),
    SET_POINT: (16, 4064),
    LASER_ON: (0, 2),
    LASER_POWER: (0, 360),
    AUTO_EXPOSURE: (0, 1),
    EXPOSURE: (1, 165_000),
    GAIN: (16, 248),
}
"""What a file may hold: the widths of the chip's registers; depth units from 1 um to 1 m; librealsense's options."""
VIEWER_WORDS = {"off": 0.0, "on": 1.0, "auto": 2.0, "false": 0.0, "true": 1.0}
"""Values that the viewer writes as words (`json_loader.hpp`)."""


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
    values: Mapping[str, float] = field(default_factory=dict)
    """What a file holds under known keys."""
    ignored: tuple[str, ...] = ()
    """Keys of the file that nothing here has a counterpart for."""

    @property
    def shift(self) -> int:
        """Start of the disparity search [px]."""
        return int(self.values.get(SHIFT, 0))

    @property
    def depth_unit(self) -> float:
        """Depth of one z16 step [m]."""
        return self.values.get(UNITS, 1000) / 1e6

    @property
    def text(self) -> str:
        """All that it says, as text that `load_preset` reads: equal for equal content."""
        return json.dumps(dict(sorted(self.values.items()))) if self.values else self.name

    @property
    def matcher_text(self) -> str:
        """What of it the matcher has a counterpart for, as text that `load_preset` reads: equal for equal content."""
        if not self.values:
            return self.name
        held = {key: self.values[key] for key in sorted(MATCHER_KEYS) if key in self.values}
        return json.dumps(held) if held else "default"


def load_preset(text: str, folder: Path | None = None) -> D400Preset:
    """The preset that a setting spells: one of the viewer's by name, a JSON file, or the JSON object itself.

    folder: where a relative path counts from; None = where the program runs.
    """
    if text.lstrip().startswith("{"):
        return _preset_from_text("preset", text)
    return preset_from_file((folder or Path()) / text) if is_file_name(text) else preset_by_name(text)


def is_file_name(text: str) -> bool:
    """Whether a preset is given as a file."""
    return not text.lstrip().startswith("{") and (text.lower().endswith(".json") or "/" in text)


def preset_by_name(name: str) -> D400Preset:
    """One of the viewer's presets; upper case, blanks and dashes do not matter."""
    key = name.strip().lower().replace(" ", "_").replace("-", "_")
    if key not in D400_PRESETS:
        raise InputError(f"preset {name!r}: unknown, and a file ends in .json; {suggest(key, D400_PRESETS)}")
    return D400Preset(key, _settings(D400_PRESETS[key]))


def preset_from_file(path: Path) -> D400Preset:
    """A preset file of the RealSense viewer: flat, or its values somewhere inside other objects."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{path}: no such preset file; presets by name are {', '.join(D400_PRESETS)}") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a preset file ({error}); export it from the viewer") from None
    return _preset_from_text(str(path), text)


def _preset_from_text(source: str, text: str) -> D400Preset:
    """A preset of JSON text. source: what messages call it."""
    values, ignored = {}, []
    for key, value in _parameters(source, text).items():
        known = ALIASES.get(key, key)
        if known in LIMITS:
            values[known] = _number(source, key, value, *LIMITS[known])
        else:
            ignored.append(key)
    settings = _settings({**D400_PRESETS["default"], **values})
    return D400Preset(Path(source).stem, settings, values, tuple(ignored))


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
        left_right_px=standard.left_right_px * values[LEFT_RIGHT] / default[LEFT_RIGHT],
        neighbour_px=values[RSM_DIFFERENCE],
        neighbour_least=round(values[RSM_REMOVE] * RSM_WINDOW) if values[RSM_ON] else 0,
    )


def _parameters(source: str, text: str) -> dict[str, object]:
    """The one object of the JSON text that holds known keys."""
    try:
        content = json.loads(text)
        found = [thing for thing in _objects(content) if any(ALIASES.get(key, key) in LIMITS for key in thing)]
    except (ValueError, RecursionError) as error:
        raise InputError(f"{source}: cannot be read as a preset file ({error}); export it from the viewer") from None
    if not found:
        raise InputError(
            f"{source}: holds no parameters of a D400 camera: no key is known; a preset file is one JSON object with "
            f"keys like {SECOND_PEAK}"
        )
    if len(found) > 1:
        raise InputError(f"{source}: holds {len(found)} objects with parameters; keep the one that is meant")
    return found[0]


def _objects(content: Any) -> Iterator[dict[str, object]]:
    """Every object in JSON content, the outer ones first."""
    if isinstance(content, dict):
        yield content
    for inner in content.values() if isinstance(content, dict) else content if isinstance(content, list) else ():
        yield from _objects(inner)


def _number(source: str, key: str, value: object, least: float, most: float) -> float:
    try:
        word = VIEWER_WORDS.get(value.strip().lower(), value) if isinstance(value, str) else value
        number = float(word) if isinstance(word, str | int | float) else math.nan
    except ValueError:
        number = math.nan
    if not least <= number <= most:
        raise InputError(f"{source}: {key} is {value!r}; give a number from {least:g} to {most:g}")
    return number
