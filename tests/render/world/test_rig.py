"""Stream profiles: each shows one chip, whole or cropped; Min-Z and the left band follow from f B."""

import numpy as np
import pytest

from franbv.frames import decimated_intrinsics, look_at, rolled
from materials.input_error import InputError
from render.depth.decimation import crop_centre
from render.sensor import SensorSettings
from render.world.rig import CAMERA_MODELS, camera_rig, d435i_rig, left_band

PUBLISHED_640X480 = (382.9, 384.2, 385.2, 386.9)
"""fx of four D435s at 640x480 [px] (librealsense issues 3474 and 11511, realsense-ros issues 2788 and 2935)."""


def test_the_crop_has_the_published_focal_length():
    """640x480 lies among published calibrations, and within 0.1 % of 1.2 times 640x360, the ratio of their heights."""
    focal = d435i_rig("640x480").intrinsics.fx
    assert min(PUBLISHED_640X480) < focal < max(PUBLISHED_640X480)
    assert focal / d435i_rig("640x360").intrinsics.fx == pytest.approx(1.2, rel=1e-3)


@pytest.mark.parametrize("model", CAMERA_MODELS)
def test_streams_show_one_chip(model):
    """The lens's focal length over the width of a stream's pixel on the chip is fx, to the rounding of the table."""
    for width, height in CAMERA_MODELS[model].focal_lengths_px:
        rig = camera_rig(model, f"{width}x{height}")
        assert rig.chip.focal_length / rig.chip.pitch(width) == pytest.approx(rig.intrinsics.fx, rel=5e-3)
        assert rig.chip.width / rig.chip.height == pytest.approx(width / height)


def test_a_crop_is_no_scaling():
    """640x480 shows the chip's 800 rows and 1067 of its 1280 columns: 1.667 native pixels a side instead of 2."""
    chip = d435i_rig("640x480").chip
    assert (chip.width, chip.height) == (pytest.approx(1066.67, abs=0.01), 800)
    assert chip.native_pixels(640) == pytest.approx((800 / 480) ** 2)


@pytest.mark.parametrize(
    ("model", "profile", "focal_baseline", "min_z"),
    [
        ("d435i", "640x480", 19.25, 0.1528),
        ("d435i", "640x360", 16.05, 0.1274),
        ("d415", "1280x720", 49.4725, 0.3926),
        ("d415", "640x360", 24.736, 0.1963),
    ],
)
def test_min_z_is_the_end_of_the_search(model, profile, focal_baseline, min_z):
    """f B over 126 disparities, whatever the roll: it belongs to the imagers, not to how they hang."""
    for roll in (0.0, 90.0):
        rig = SensorSettings(model=model, profile=profile, roll_deg=roll).rig
        assert rig.focal_baseline == pytest.approx(focal_baseline, abs=5e-4)
        assert rig.min_z == pytest.approx(min_z, abs=1e-4)
        assert rig.max_z == np.inf


def test_a_shift_moves_both_ends_of_the_range():
    """With 25 px more, 16.05 / 151 and 16.05 / 25."""
    rig = SensorSettings(preset='{"param-disparityshift": 25}').rig
    assert (rig.min_z, rig.max_z) == (pytest.approx(16.05 / 151), pytest.approx(16.05 / 25))


def test_the_paper_s_crop_has_equal_margins():
    """80 x 60 to 60 x 40 leaves out ten on every side."""
    rig = d435i_rig("640x480")
    reduced = decimated_intrinsics(rig.intrinsics, 8)
    numbered = np.arange(60 * 80, dtype=np.uint16).reshape(1, 60, 80)
    cropped, _ = crop_centre(numbered, reduced, SensorSettings().crop)
    np.testing.assert_array_equal(cropped, numbered[:, 10:50, 10:70])


@pytest.mark.parametrize(("roll", "side"), [(90.0, "+z"), (-90.0, "-z"), (0.0, "+y"), (180.0, "-y")])
def test_the_left_band_turns_with_the_camera(roll, side):
    """A wall at 0.3 m across the view: the f B / Z leftmost columns, 16.05 / 0.3 = 53.5 px, have no partner. Upright
    the camera, which looks along +x, has its left at +y; on end clockwise it has it above, at +z."""
    rig, distance = d435i_rig(), 0.3
    pose = rolled(look_at(np.zeros(3), np.array([1.0, 0.0, 0.0])), roll)
    band = left_band(rig, np.full((360, 640), distance))
    assert band.sum(axis=1).tolist() == [54] * 360
    points = pose.apply((rig.intrinsics.pixel_directions() * distance).reshape(-1, 3)).reshape(360, 640, 3)
    sideways = float(f"{side[0]}1") * points[..., "xyz".index(side[1])]
    assert sideways[band].min() > sideways[~band].max()
    edge = (rig.intrinsics.cx - 53.5) / rig.intrinsics.fx * distance
    assert sideways[band].min() == pytest.approx(edge, abs=distance / rig.intrinsics.fx)


def test_profiles_are_named_with_the_camera():
    """What there is not is said with what there is."""
    with pytest.raises(InputError, match="RealSense D415's; use one of 1280x720"):
        camera_rig("d415", "800x600")
