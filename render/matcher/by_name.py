"""The stereo matchers by name."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from materials.input_error import InputError
from render.matcher.d4.matcher import D4Matcher
from render.matcher.interface import StereoMatcher
from render.matcher.sgbm import SgbmMatcher

MATCHERS: dict[str, Callable[[], StereoMatcher]] = {"d4": D4Matcher, "sgbm": SgbmMatcher}
"""Matchers by their name in flags and configurations; a row here is all that makes one known."""

if TYPE_CHECKING:
    MatcherName = str
else:
    MatcherName = Literal[tuple(MATCHERS)]


def matcher_by_name(name: str) -> StereoMatcher:
    """`d4`: fails like the D400's chip; `sgbm`: OpenCV's StereoSGBM."""
    if name not in MATCHERS:
        raise InputError(f"matcher {name!r}: unknown; use {' or '.join(MATCHERS)}")
    return MATCHERS[name]()
