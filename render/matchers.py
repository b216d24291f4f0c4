"""The stereo matchers by name."""

from materials.input_error import InputError
from render.matcher import StereoMatcher
from render.sgbm_matcher import SgbmMatcher


def matcher_by_name(name: str) -> StereoMatcher:
    """`sgbm`: OpenCV's StereoSGBM."""
    if name == "sgbm":
        return SgbmMatcher()
    raise InputError(f"matcher {name!r}: unknown; use sgbm")
