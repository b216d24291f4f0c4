"""The stereo matchers by name."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from materials.input_error import InputError
from render.matcher.d4.matcher import D4Matcher
from render.matcher.d400_preset import D400Preset
from render.matcher.interface import StereoMatcher
from render.matcher.sgbm import SgbmMatcher

MATCHERS: dict[str, Callable[[], StereoMatcher]] = {
    "d4": D4Matcher,
    "sgbm": SgbmMatcher,
}
"""Matchers by their name in flags and configurations; a row here is all that makes one known."""

if TYPE_CHECKING:
    MatcherName = str
else:
    MatcherName = Literal[tuple(MATCHERS)]


def matcher_by_name(name: str, preset: D400Preset | None = None) -> StereoMatcher:
    """`d4`: fails like the D400's chip, under a preset's settings; `sgbm`: OpenCV's StereoSGBM, whatever the preset.

    Where the search begins is told to `match`.
    """
    if name not in MATCHERS:
        raise InputError(f"matcher {name!r}: unknown; use {' or '.join(MATCHERS)}")
    return D4Matcher(preset.settings) if name == "d4" and preset else MATCHERS[name]()
