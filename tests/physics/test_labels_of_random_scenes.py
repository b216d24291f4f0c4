"""Whatever stands before the camera: every pixel without depth has exactly one cause, at both resolutions."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from materials.catalog import material
from render.d435i import SensorSettings, SimulatedD435i
from render.labels.causes import HOLES, Cause, is_hole, is_of
from render.labels.infrared import contrast
from render.labels.interventions import matched_at_first_surface
from render.labels.labels import label_frame
from render.light.sampling import Sampling
from scenes.scene import Body, Scene
from tests.physics.label_scenes import behind_camera, tilted_plate, wall_at
from tests.physics.simple_scenes import facing_x, rectangle

SURFACES = ("silver:mirror", "stainless_austenitic:polished", "aluminium:brushed", "iron:blasted", "primer", "rubber")
MEASURED_WITH = SensorSettings(profile="424x240", crop=(40, 24))
HOLE_CODES = np.array(HOLES, np.uint8)

numbers = st.integers(0, 2**32 - 1)


def random_scene(number: int) -> Scene:
    """Up to four plates of any material, size, place and tilt, with or without a wall and a lamp."""
    rng = np.random.default_rng(number)
    bodies = []
    for k in range(rng.integers(1, 5)):
        place = np.array([rng.uniform(0.06, 1.2), *rng.uniform(-0.15, 0.15, 2)])
        towards = rng.normal(0, 0.5, 3) - [0.3, 0, 0]
        mesh = rectangle(place, place + towards, *rng.uniform(0.02, 0.3, 2))
        bodies.append(Body(f"plate {k}", mesh, material(str(rng.choice(SURFACES))), True))
    if rng.random() < 0.6:
        bodies.append(wall_at(rng.uniform(0.3, 3.0), material(str(rng.choice(SURFACES)))))
    lamps = (behind_camera(float(rng.uniform(0, 60))),) if rng.random() < 0.6 else ()
    return Scene("random", tuple(bodies), lamps, 0.0)


@settings(max_examples=8, deadline=None, derandomize=True)
@given(numbers)
def test_every_invalid_pixel_has_exactly_one_cause(number: int):
    """Holes of the burst, found here from the raw frames, are just the pixels that a cause of missing depth is given
    to, one code each; false depth is told only of pixels with depth; outside the crop nothing is said."""
    camera = SimulatedD435i(
        random_scene(number), MEASURED_WITH, number % 7, Sampling(glossy_paths=8, refined_share=0.0)
    )
    measurement = camera.measure(facing_x(), 3)
    labels = label_frame(camera, facing_x(), measurement)
    assert camera.window is not None
    inside = np.zeros(labels.cause.shape, bool)
    inside[camera.window.slices] = True
    lost = np.sum(measurement.z16 == 0, axis=0) >= 2  # of three frames
    assert np.array_equal(np.isin(labels.cause, HOLE_CODES), lost & inside)
    assert np.all(labels.cause[inside & ~lost] == Cause.MEASURED)
    assert np.all(labels.cause[~inside] == Cause.UNMEASURED)
    assert not np.any(labels.false_depth & (lost | ~inside))
    assert not np.any(labels.false_by_reflection & ~labels.false_depth)
    lost_blocks = np.sum(measurement.burst.depths == 0, axis=0) >= 2
    assert np.array_equal(np.isin(labels.cause_decimated, HOLE_CODES), lost_blocks)
    assert np.all(labels.cause_decimated[~lost_blocks] == Cause.MEASURED)
    assert not np.any(labels.false_decimated & lost_blocks)


def test_most_of_the_random_scenes_have_holes_of_several_kinds():
    """The property is not empty: the first scenes of the generator lose thousands of pixels, to three groups of causes
    at the least, reflection among them."""
    groups, lost = set(), 0
    for number in range(6):
        camera = SimulatedD435i(random_scene(number), MEASURED_WITH, 0, Sampling(glossy_paths=8, refined_share=0.0))
        labels = label_frame(camera, facing_x(), camera.measure(facing_x(), 1))
        lost += int(is_hole(labels.cause).sum())
        groups |= {g for g in ("out_of_range", "occlusion", "no_overlap", "reflection") if is_of(labels.cause, g).any()}
    assert lost > 5000
    assert "reflection" in groups
    assert len(groups) >= 3


def test_even_darkness_has_no_contrast():
    """Of an image that is equal everywhere but in one spot the contrast far from it is zero, and nowhere undefined."""
    image = np.full((60, 80), 17, np.float32)
    image[20:30, 5:15] = 254.3
    found = contrast(image)
    assert np.all(np.isfinite(found))
    assert np.all(found[:, 40:] < 0.1)
    assert found[20, 10] > 20


def test_light_of_one_surface_leaves_a_lone_mirror_as_it_is():
    """A plate alone in the dark has no other surface to bring light: stopping paths at the first one changes nothing,
    so no pixel may count as lost to light between surfaces."""
    camera = SimulatedD435i(Scene("alone", (tilted_plate(material("iron:polished"), 20.0),), (), 0.0), MEASURED_WITH)
    measurement = camera.measure(facing_x(), 1)
    everywhere = np.ones(measurement.z16.shape[1:], bool)
    assert not matched_at_first_surface(camera, measurement, camera.truth(facing_x()), everywhere).any()
