"""The stereo matchers by name."""

from materials.input_error import InputError
from render.matcher.d4.matcher import D4Matcher
from render.matcher.d400_preset import D400Preset, preset_by_name
from render.matcher.interface import StereoMatcher
from render.matcher.sgbm import SgbmMatcher

MATCHERS = ("d4", "sgbm")


def matcher_by_name(name: str, preset: D400Preset | None = None) -> StereoMatcher:
    """`d4`: fails like the D400's chip; `sgbm`: OpenCV's StereoSGBM, which has of a preset the search's start alone."""
    preset = preset or preset_by_name("default")
    if name not in MATCHERS:
        raise InputError(f"matcher {name!r}: unknown; use {' or '.join(MATCHERS)}")
    return D4Matcher(preset.settings, preset.shift) if name == "d4" else SgbmMatcher(shift=preset.shift)
