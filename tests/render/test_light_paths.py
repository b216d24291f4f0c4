"""What paths bring that stop at the first surface, told apart while the whole paths are traced."""

from dataclasses import replace

import numpy as np
import pytest

from franbv.frames import look_at
from materials.catalog import material
from render import backend
from render.d435i import SensorSettings, SimulatedD435i
from render.light_paths import trace_paths
from render.sampling import SampleSet
from scenes.build import coupon_scene

POSE = look_at(np.array([0.25, -0.15, 0.35]), np.array([0.0, 0.0, 0.03]))
N = 4


@pytest.mark.parametrize("lamps", ["workshop", "off"])
@pytest.mark.parametrize("sky", [0.0, 0.2])
def test_stopped_paths_are_paths_of_one_vertex(lamps, sky):
    """By the same samples, whole paths have brought by their first vertex exactly what paths of one vertex bring: from
    metal and matte surfaces, with and without lamps, in closed and open surroundings. And whole paths bring more."""
    scene = replace(
        coupon_scene("ball", material("stainless_austenitic:ground"), lamps, room=sky == 0), ambient_radiance=sky
    )
    camera = SimulatedD435i(scene, SensorSettings(profile="424x240"))
    whole, single = (light_of_paths(camera, max_depth) for max_depth in (3, 1))
    for stopped, alone in zip(whole[2:], single[:2], strict=True):
        assert np.array_equal(stopped, alone)
    assert np.all(whole[:2] >= single[:2])
    assert np.any(whole[0] > single[0])


def light_of_paths(camera: SimulatedD435i, max_depth: int) -> np.ndarray:
    """The four sums of N paths a pixel (4, paths)."""
    mi = backend.mitsuba()
    import drjit as dr

    first = camera.view(POSE).left
    height, width = first.shape
    index = dr.arange(mi.UInt32, height * width * N)
    pixel = index // N
    ray = first.imager.ray(mi.Float(pixel % width), mi.Float(pixel // width))
    samples = SampleSet.sobol(N, 3)
    light = trace_paths(camera.world, first.light, ray, pixel, index % N, samples, max_depth)
    sums = (light.projector, light.lamps, light.projector_stopped, light.lamps_stopped)
    dr.eval(sums)
    return np.stack([values.numpy() for values in sums])
