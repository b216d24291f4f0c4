"""The projectors' patterns: as many dots as stated, no two nearer than allowed, all within the field, mean one."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from render.imager.chip import OV2740, OV9282
from render.imager.exposure import electrons_per_radiance
from render.imager.settings import ImagerSettings
from render.light.pattern import D415_DOTS, PROJECTORS, dot_pattern, dot_positions, projector_dots

FIELDS_DEG = {"d435i": (86.0, 57.0), "d415": (67.0, 41.0)}
"""Of the projectors (D400 datasheet)."""


@pytest.mark.parametrize("model", PROJECTORS)
def test_dots_fill_the_field(model):
    """In the plane at 1 m the field measures 2 tan(half angle); its dots keep their distance."""
    dots = PROJECTORS[model]
    half = np.tan(np.radians(FIELDS_DEG[model]) / 2)
    centres = dot_positions(np.random.default_rng(0), dots)
    assert len(centres) == pytest.approx(dots.density * 4 * half.prod(), abs=1)
    assert np.all(np.abs(centres) <= half)
    assert np.all(np.abs(centres).max(axis=0) > 0.98 * half)
    distances, _ = KDTree(centres).query(centres, 2)
    assert distances[:, 1].min() >= dots.minimum_spacing


@pytest.mark.parametrize("model", PROJECTORS)
def test_patterns_spread_one_over_the_field(model):
    """Relative brightness: its mean is one, four texels or so make a dot's width, and it is always the same."""
    pattern, dots = dot_pattern(PROJECTORS[model]), PROJECTORS[model]
    assert pattern.sharp.mean(dtype=float) == pytest.approx(1)
    assert 3 < dots.fwhm / dots.texel < 5
    assert dot_pattern(PROJECTORS[model]) is pattern
    sides = np.array(pattern.sharp.shape[::-1]) * dots.texel
    np.testing.assert_allclose(sides, 2 * np.array(dots.half_field), atol=dots.texel)


def test_the_d415_has_the_dots_that_are_stated():
    """10,000, each on a tenth of a thousandth of the field."""
    assert PROJECTORS["d415"].density * PROJECTORS["d415"].field_area == pytest.approx(D415_DOTS)


def test_smaller_pixels_gather_less():
    """By their areas, (3.0 / 1.4)^2 = 4.59: Intel says that the D435 is about five times as sensitive."""
    d435i, d415 = (electrons_per_radiance(1000.0, ImagerSettings(), chip) for chip in (OV9282, OV2740))
    assert d435i / d415 == pytest.approx(4.59, abs=0.01)


@pytest.mark.parametrize(
    ("model", "focal_px", "point_px"),
    [
        # 2.25 um of lens on pixels of 3 um and of 1.5 x 1.4 um; 1/6 + 1/12 px^2 of rectification and pixel.
        ("d435i", 642.0, 2.3548 * np.sqrt(0.75**2 + 0.25)),
        ("d415", 899.5, 2.3548 * np.sqrt((2.25 / 2.1) ** 2 + 0.25)),
    ],
)
def test_width_of_the_dots(model, focal_px, point_px):
    """A dot as wide as asked for in 1280x720 images is narrower by the spread of a point, in squares; its place, power
    and density stay, and four texels make it whatever its width."""
    dots = projector_dots(model, 4.0)
    assert np.hypot(dots.fwhm * focal_px, point_px) == pytest.approx(4.0, rel=1e-3)
    assert dots.fwhm / dots.texel == pytest.approx(PROJECTORS[model].fwhm / PROJECTORS[model].texel)
    assert (dots.density, dots.minimum_spacing, dots.seed) == (
        PROJECTORS[model].density,
        PROJECTORS[model].minimum_spacing,
        PROJECTORS[model].seed,
    )
    assert projector_dots(model) is PROJECTORS[model]
