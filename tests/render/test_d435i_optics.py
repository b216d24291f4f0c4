"""The camera's optics from end to end: defocus near by, rows out of line, a filter, one exposure for both eyes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import j1

from materials.lights import Band
from materials.material import Matte
from render.d435i import SensorSettings, SimulatedD435i
from render.imager.band_pass import BandPass
from render.imager.expose import expose_burst
from render.imager.settings import ImagerSettings
from tests.physics.lit_wall import middle_of_field
from tests.physics.simple_scenes import facing_x, lamp_at, wall

DARK_ENOUGH = ImagerSettings(exposure_us=300.0, gain=32.0, vignetting_exponent=0.0, laser_modes=1e6)
"""No dot is clipped on a wall as near as these; no speckle, which would differ between draws."""


def camera_before_wall(distance: float, imager: ImagerSettings = DARK_ENOUGH, **settings) -> SimulatedD435i:
    """A camera with a held exposure before a matte wall, only its projector lit."""
    fixed = SensorSettings(crop=None, auto_exposure=False, imager=imager, **settings)
    return SimulatedD435i(wall(distance, Matte("wall", 0.5)), fixed, 1)


@pytest.mark.parametrize(("distance", "disc_px", "share"), [(0.15, 1.56, 0.15), (0.2, 1.05, 0.22)])
def test_dots_are_out_of_focus_near_by(distance, disc_px, share):
    """Against the Fourier transform of a disc, 2 J1(x) / x with x = pi d frequency, on the image in focus: what is left
    of the difference that defocus makes, a tenth and a fifth, is that so small discs are drawn on pixels as large as
    they."""
    imager = DARK_ENOUGH.model_copy(update={"exposure_us": 300.0 * (distance / 0.15) ** 2})
    camera = camera_before_wall(distance, imager)
    left, right = camera.render(facing_x())
    near = camera.expose(facing_x(), left, right, 40).lefts.mean(axis=0)
    sharp = expose_burst(left.projector, left.ambient, imager, 40, 1).mean(axis=0)
    frequency = np.hypot(np.fft.fftfreq(sharp.shape[0])[:, None], np.fft.rfftfreq(sharp.shape[1])[None, :])
    x = np.pi * disc_px * np.maximum(frequency, 1e-9)
    blurred = np.fft.irfft2(np.fft.rfft2(sharp) * 2 * j1(x) / x, sharp.shape)
    middle = middle_of_field(sharp.shape)
    left_over, made = (np.sqrt(np.mean((near - image)[middle] ** 2)) for image in (blurred, sharp))
    assert left_over < share * made


def test_rows_out_of_line():
    """The right image of a camera told 0.3 px is that of a straight one 0.3 px lower, by the phases of the cross
    spectrum along its columns; the left one is the same."""
    straight, askew = (camera_before_wall(0.4, row_misalignment_px=down) for down in (0.0, 0.3))
    layers = straight.render(facing_x())
    one, other = (camera.expose(facing_x(), *layers, 4) for camera in (straight, askew))
    np.testing.assert_array_equal(one.lefts, other.lefts)
    window = np.hanning(240)[:, None]
    before, after = (np.fft.rfft(window * m.rights.mean(axis=0)[60:300, 100:540], axis=0) for m in (one, other))
    cross, frequency = (after * before.conj()).sum(axis=1)[5:60], np.fft.rfftfreq(240)[5:60]
    weight = np.abs(cross) * frequency
    down = -np.sum(weight * np.angle(cross)) / np.sum(weight * 2 * np.pi * frequency)
    assert down == pytest.approx(0.3, abs=0.01)


def test_a_filter_takes_the_lamps_and_leaves_the_dots():
    """On the axis nine tenths of the dots' light are left; paint that is dark under the LED looks behind the
    filter as it does at 850 nm."""
    bright = DARK_ENOUGH.model_copy(update={"exposure_us": 2000.0})
    filtered = bright.model_copy(update={"band_pass": BandPass(width_nm=400.0)})
    plain, behind = camera_before_wall(0.4, bright), camera_before_wall(0.4, filtered)
    layers = plain.render(facing_x())
    grey = [c.expose(facing_x(), *layers, 2).lefts[:, 100:260, 200:440].mean() - 17 for c in (plain, behind)]
    assert grey[1] / grey[0] == pytest.approx(0.9, abs=0.01)
    lamp = lamp_at([-1.0, 0.0, 1.0], [0.4, 0, 0], 0.4, 1.0)
    lit = replace(wall(0.4, in_two_bands(), (lamp,)), lamp_band=Band.WHITE_LED)
    narrow = bright.model_copy(update={"band_pass": BandPass()})
    cameras = [SimulatedD435i(lit, SensorSettings(imager=imager), 1) for imager in (bright, narrow)]
    ambient = [camera.render(facing_x())[0].ambient[180, 320] for camera in cameras]
    assert ambient[1] / ambient[0] == pytest.approx(0.8 / 0.2, rel=1e-3)


def in_two_bands() -> Matte:
    """0.8 at 850 nm, 0.2 under white LEDs."""
    return Matte("paint", 0.8, lamps=((Band.WHITE_LED, 0.2),))


def test_longer_bursts_begin_alike_in_both_eyes():
    """Frames of a burst are the first of a longer one; what was exposed before does not matter."""
    camera = camera_before_wall(0.3, row_misalignment_px=0.2)
    layers = camera.render(facing_x())
    long, short = (camera.expose(facing_x(), *layers, n) for n in (5, 2))
    np.testing.assert_array_equal(long.lefts[:2], short.lefts)
    np.testing.assert_array_equal(long.rights[:2], short.rights)
    np.testing.assert_array_equal(long.z16[:2], short.z16)


def test_what_is_seen_follows_pose_and_materials():
    """It is kept for a pose, and made anew for another pose and for other materials."""
    camera = camera_before_wall(0.3)
    seen = camera.seen(facing_x())
    assert camera.seen(facing_x()) is seen
    twin = camera.changed(scene=wall(0.3, Matte("other", 0.2)))
    assert twin.seen(facing_x()) is not seen
    np.testing.assert_allclose(twin.seen(facing_x())[0].inverse_depth, seen[0].inverse_depth)
    np.testing.assert_allclose(seen[1].inverse_depth, 1 / 0.3, rtol=1e-5)


@pytest.mark.parametrize("before", [None, BandPass(width_nm=400.0)])
def test_a_filter_may_be_changed(before):
    """A camera changed to another filter, or to its first one, measures what a new one with that filter does."""
    lamp = lamp_at([-1.0, 0.0, 1.0], [0.4, 0, 0], 0.4, 1.0)
    lit = replace(wall(0.4, in_two_bands(), (lamp,)), lamp_band=Band.WHITE_LED)
    first, narrow = (DARK_ENOUGH.model_copy(update={"band_pass": one}) for one in (before, BandPass()))

    def camera(imager: ImagerSettings) -> SimulatedD435i:
        return SimulatedD435i(lit, SensorSettings(crop=None, auto_exposure=False, imager=imager), 1)

    changed, new = camera(first).changed(imager=narrow), camera(narrow)
    there, back = (c.measure(facing_x(), 1).lefts for c in (changed, changed.changed(imager=first)))
    np.testing.assert_array_equal(there, new.measure(facing_x(), 1).lefts)
    np.testing.assert_array_equal(back, camera(first).measure(facing_x(), 1).lefts)
    assert there.mean() < back.mean()
