"""What is computed once: light that both imagers see, paths of a pixel that gets more, the lamps' photons."""

from dataclasses import replace

import numpy as np
import pytest

from franbv.frames import look_at
from materials.catalog import material
from render.d435i import SensorSettings, SimulatedD435i
from render.light.caustics import from_lamps
from render.light.radiance import render_layers
from render.light.sampling import Sampling
from scenes.build import coupon_scene

SETTINGS = SensorSettings(profile="424x240", crop=None)
POSE = look_at(np.array([0.25, -0.15, 0.35]), np.array([0.0, 0.0, 0.03]))
FEW = Sampling(glossy_paths=16, refined_share=0.0, indirect_directions=16)
OF_MEAN, OF_PIXELS = 2e-3, 0.05
"""Relative: by how much the light of a whole image may differ, and that of 99 of 100 pixels: both ways interpolate what
differs by up to a tenth between the points around a pixel."""


@pytest.mark.parametrize("layer", ["projector", "ambient"])
def test_irradiance_is_the_same_from_either_imager(layer: str):
    """A matte surface looks alike from everywhere: the right image with the light that the left imager sees is the one
    that is rendered by itself."""
    camera = SimulatedD435i(coupon_scene("inside_corner", material("matte_paint")), SETTINGS)
    light, right = camera.projector_light(POSE), camera.rig.right_imager(POSE)
    _, shared = camera.render(POSE)
    alone = render_layers(camera.world, light, camera.rig.intrinsics, right, Sampling())
    ours, own = getattr(shared, layer), getattr(alone, layer)
    assert not np.array_equal(ours, own)
    assert ours.mean() == pytest.approx(own.mean(), rel=OF_MEAN)
    assert np.quantile(np.abs(ours - own), 0.99) < OF_PIXELS * own.mean()


def test_more_paths_are_those_of_a_larger_set():
    """Where nothing depends on how many there are, as sharp dots do not, all pixels taken again from 16 to 64 paths
    have the mean of 64."""
    scene = coupon_scene("ball", material("stainless_austenitic:ground"))
    further = replace(FEW, filtered=False, refined_share=1.0, refined_paths=64)
    at_once = replace(FEW, filtered=False, glossy_paths=64)
    ours, expected = (SimulatedD435i(scene, SETTINGS, sampling=s).render(POSE)[0] for s in (further, at_once))
    np.testing.assert_allclose(ours.projector, expected.projector, rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(ours.ambient, expected.ambient, rtol=1e-4, atol=1e-6)


def test_the_lamps_photons_are_shot_once():
    """They depend on no pose; another number of them, or another seed, is another set."""
    world = SimulatedD435i(coupon_scene("ball", material("stainless_austenitic:polished"))).world
    photons = from_lamps(world, 1024, 0)
    assert photons is not None
    assert from_lamps(world, 1024, 0) is photons
    assert from_lamps(world, 2048, 0) is not photons
    assert from_lamps(world, 1024, 1) is not photons
