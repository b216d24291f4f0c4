"""Dots of rendered frames against those of real ones, and the measurement itself against drawn dots."""

import numpy as np
import pytest

from render.imager.settings import REFERENCE_LASER_POWER_MW, ImagerSettings
from render.light.pattern import BACKGROUND_SHARE, DOT_DENSITY, HALF_FIELD
from tests.physics.dot_statistics import REFERENCE_FOCAL_PX, dot_statistics
from tests.physics.lit_wall import DISTANCE, ROOM_LIGHT, lamp_irradiance, lit_wall, middle_of_field
from tests.physics.real_dots_on_box import FOCAL_PX, SIDES, real_dots

AS_REAL = 0.15
"""Relative difference that is allowed between rendered and real figures."""
REAL_DENSITY, REAL_SPACING, REAL_WIDTH, REAL_PEAK, REAL_PEDESTAL = 4.5, (10.6, 12.1, 13.4), 5.0, 3.8, 17.0
"""Measured on D435(i) frames at 1280x720: dots per 1000 px, nearest neighbour [px], width at half height [px], peak
over background, grey value in the dark [DN]."""


@pytest.fixture(scope="module", params=["1280x720", "640x360"])
def rendered_wall(request):
    return lit_wall(DISTANCE, request.param)


@pytest.fixture(scope="module")
def rendered(rendered_wall):
    """Statistics of the rendered wall's dots in dim room light."""
    image = rendered_wall.image_without_white(lamp_irradiance(ROOM_LIGHT))
    return dot_statistics(image, middle_of_field(image.shape), rendered_wall.focal_px)


def drawn_dots(width: float, spacing: float, height: float, background: float):
    """Round Gaussians on a jittered grid; returns the image and the places (n, 2)."""
    rng = np.random.default_rng(5)
    x, y = np.meshgrid(np.arange(20.0, 380.0, spacing), np.arange(20.0, 280.0, spacing))
    places = np.column_stack([x.ravel(), y.ravel()]) + rng.uniform(-1.0, 1.0, (x.size, 2))
    v, u = np.mgrid[:300, :400]
    image = np.full((300, 400), background)
    for px, py in places:
        image += height * np.exp(-4 * np.log(2) * ((u - px) ** 2 + (v - py) ** 2) / width**2)
    return np.clip(np.rint(image + rng.normal(0, 0.5, image.shape)), 0, 255).astype(np.uint8), places


@pytest.mark.parametrize("width", [3.7, 5.0])
def test_measurement_finds_what_was_drawn(width):
    """Dots drawn with known place, width and height, and half a grey value of noise: all are found, none is invented,
    and spacing, width and peak over background come back. The tails of neighbours at 12 px lift the background by
    less than 1 % of a dot's height."""
    image, places = drawn_dots(width, 12.0, 90.0, 47.0)
    region = np.zeros(image.shape, bool)
    region[10:290, 10:390] = True
    found = dot_statistics(image, region, REFERENCE_FOCAL_PX)
    gaps = np.linalg.norm(places[:, None] - places[None], axis=-1) + np.where(np.eye(len(places)), np.inf, 0)
    assert found.count == len(places)
    assert found.spacing == pytest.approx(np.percentile(gaps.min(axis=1), [10, 50, 90]), rel=0.02)
    assert found.width[1] == pytest.approx(width, rel=0.02)
    assert found.peak_over_background == pytest.approx((90 + 47 - 17) / (47 - 17), rel=0.05)
    assert found.clipped == 0


def test_dots_are_as_dense_and_as_wide_as_real_ones(rendered):
    """Density, nearest neighbours and width on a matte wall, in pixels of 1280x720: every one within 15 % of the real
    figure, in both profiles (real widths scale with the profile)."""
    assert rendered.clipped == 0
    assert rendered.density == pytest.approx(REAL_DENSITY, rel=AS_REAL)
    assert rendered.spacing == pytest.approx(REAL_SPACING, rel=AS_REAL)
    assert rendered.width[1] == pytest.approx(REAL_WIDTH, rel=AS_REAL)


def test_dots_stand_as_high_as_power_and_lamps_say(rendered):
    """Peak over background = 1 + dots / (lamps + veil), all as irradiance on the wall at distance z.

    The projector's P spreads over 4 tan tan z^2; a share v is veil, the rest is in Gaussian dots of density n in the
    image, each P (1 - v) / n with a peak of 4 ln 2 / (pi width^2) of it. The width is that of the image, lens
    included. Glare takes its share of all and lays as much of the mean over it. The dots' powers are clipped and vary
    by 15 %; 5 % are left for that and for speckle.
    """
    mean = REFERENCE_LASER_POWER_MW * 1e-3 / (4 * HALF_FIELD[0] * HALF_FIELD[1] * DISTANCE**2)
    share = 4 * np.log(2) / (np.pi * rendered.width[1] ** 2) * REFERENCE_FOCAL_PX**2 / DOT_DENSITY
    dots, veil = mean * (1 - BACKGROUND_SHARE) * share, mean * BACKGROUND_SHARE
    lamps, glare = lamp_irradiance(ROOM_LIGHT), ImagerSettings().veiling_glare
    background = (1 - glare) * (lamps + veil) + glare * (lamps + mean)
    assert rendered.peak_over_background == pytest.approx(1 + (1 - glare) * dots / background, rel=0.05)


@pytest.mark.parametrize("fwhm", [3.7, 4.4, 6.0])
def test_width_of_the_dots_can_be_set(fwhm):
    """Dots that are told to be so wide in 1280x720 images are so in rendered ones of a matte wall, density and places
    kept.

    Pixels and lens are no Gaussians, as which their spread is taken out, and a Gaussian is fitted: 3 % are left for it.
    """
    wall = lit_wall(DISTANCE, "1280x720", fwhm)
    image = wall.image_without_white(lamp_irradiance(ROOM_LIGHT))
    found = dot_statistics(image, middle_of_field(image.shape), wall.focal_px)
    assert found.width[1] == pytest.approx(fwhm, rel=0.03)
    assert found.density == pytest.approx(REAL_DENSITY, rel=0.05)


def test_dots_stand_as_high_as_real_ones(rendered):
    """At the distance of the one real frame at hand and in the light of the dimmest ordinary room, peak over
    background is within 15 % of the real 3.8. Lamp level and distance of the other real frames are not known: this
    says that power, pattern and lamps are of the right order together, no more."""
    assert rendered.peak_over_background == pytest.approx(REAL_PEAK, rel=AS_REAL)


@pytest.mark.parametrize("side", SIDES)
def test_dots_lie_as_on_a_real_box(rendered, side):
    """The same measurement on a real D435 frame, the matte side of a box: density and spacing of the rendered dots are
    within 15 %. Some 75 dots give the density to 5 % and its tenth percentile of spacing to 4 %. The dots of this
    frame are narrower than the rendered ones (3.8 px at 1280x720 instead of 4.9), which is not tested here."""
    real = dot_statistics(*real_dots(side), FOCAL_PX)
    assert rendered.density == pytest.approx(real.density, rel=AS_REAL)
    assert rendered.spacing == pytest.approx(real.spacing, rel=AS_REAL)


def test_darkness_is_the_pedestal(rendered_wall):
    """Without lamps, left of the projector's field, the grey value is the pedestal of real frames. The field begins
    tan 43 deg f - f 29 mm / z columns left of the middle, and 80 columns of 1280 are left beyond it."""
    image = rendered_wall.image(0.0, ImagerSettings())
    assert np.mean(image[:, : image.shape[1] // 20]) == pytest.approx(REAL_PEDESTAL, rel=AS_REAL)
