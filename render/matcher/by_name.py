"""The stereo matchers by name."""

from materials.input_error import InputError
from render.matcher.d4.matcher import D4Matcher
from render.matcher.interface import StereoMatcher
from render.matcher.sgbm import SgbmMatcher

MATCHERS = {"d4": D4Matcher, "sgbm": SgbmMatcher}


def matcher_by_name(name: str) -> StereoMatcher:
    """`d4`: fails like the D400's chip; `sgbm`: OpenCV's StereoSGBM."""
    if name not in MATCHERS:
        raise InputError(f"matcher {name!r}: unknown; use {' or '.join(MATCHERS)}")
    return MATCHERS[name]()
