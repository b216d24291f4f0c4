"""Surfaces seen from both sides, and what paths bring that stop at the first surface, told apart as they are traced."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from franbv.frames import look_at
from materials.catalog import material
from materials.input_error import InputError
from materials.material import Measured
from render.d435i import SensorSettings, SimulatedD435i
from render.light.paths import trace_paths
from render.light.radiance import RadianceLayers
from render.light.sampling import SampleSet, Sampling
from render.world import backend
from scenes.build import coupon_scene
from scenes.scene import Body, Mesh, Scene

SETTINGS = SensorSettings(profile="424x240", crop=None)
FEW = Sampling(glossy_paths=16, refined_share=0.0, indirect_directions=16)
SAMPLING_ERROR = 0.02
"""Relative, of the mean over the ball (choice)."""
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
    sampling = Sampling(max_depth=max_depth)
    light = trace_paths(camera.world, first.light, ray, pixel, index % N, samples, sampling)
    sums = (light.projector, light.lamps, light.projector_stopped, light.lamps_stopped)
    dr.eval(sums)
    return np.stack([values.numpy() for values in sums])


def open_or_closed(sky: float, lamps: str = "workshop", finish: str = "blasted") -> Scene:
    """A steel ball on the table, in a room or under a sky of this radiance."""
    scene = coupon_scene("ball", material(f"stainless_austenitic:{finish}"), lamps, room=sky == 0)
    return replace(scene, ambient_radiance=sky)


@pytest.mark.parametrize("sky", [0.0, 0.2])
def test_rendered_paths_stop_as_paths_of_one_vertex_do(sky: float):
    """On matte surfaces exactly, on the ball within the sampling error; and the mirror images are gone."""
    scene = open_or_closed(sky)
    camera = SimulatedD435i(scene, SETTINGS, sampling=FEW)
    rendered = camera.render(POSE)
    stopped = camera.stopped_at_first_surface(POSE, *rendered)
    once = camera.changed(max_depth=1).render(POSE)
    on_ball = camera.truth(POSE).body == 0
    matte = np.ones(on_ball.size, bool)
    assert rendered[0].stopped is not None
    matte[rendered[0].stopped.pixels] = False
    for name in ("projector", "ambient"):
        ours, theirs, whole = (getattr(side[0], name) for side in (stopped, once, rendered))
        assert np.array_equal(ours.ravel()[matte], theirs.ravel()[matte])
        assert ours[on_ball].mean() == pytest.approx(theirs[on_ball].mean(), rel=SAMPLING_ERROR)
        assert whole[on_ball].mean() > ours[on_ball].mean()


def test_layers_of_unknown_paths_cannot_be_stopped():
    """ValueError, rather than an image of something else."""
    camera = SimulatedD435i(open_or_closed(0.0), SETTINGS, sampling=FEW)
    bare = RadianceLayers(*np.zeros((2, 240, 424), np.float32))
    with pytest.raises(ValueError, match="without stopped paths"):
        camera.stopped_at_first_surface(POSE, bare, bare)


def test_ambient_light_scales_in_stopped_paths_too():
    """Lamps of twice the radiance, rendered and scaled."""
    scene = open_or_closed(0.0)
    twice = replace(scene, lamps=tuple(replace(lamp, radiance=2 * lamp.radiance) for lamp in scene.lamps))
    left, right = (SimulatedD435i(s, SETTINGS, sampling=FEW).render(POSE)[0] for s in (scene, twice))
    scaled = left.with_ambient_scaled(2.0)
    assert scaled.stopped is not None
    assert right.stopped is not None
    np.testing.assert_allclose(scaled.ambient, right.ambient, rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(scaled.stopped.layers, right.stopped.layers, rtol=1e-4, atol=1e-6)


def test_surfaces_look_alike_from_both_sides():
    """A ball turned inside out, faces and normals, is as bright as it was."""
    scene = open_or_closed(0.0)

    def turned(body: Body) -> Body:
        mesh = body.mesh
        normals = None if mesh.normals is None else -mesh.normals
        return replace(body, mesh=Mesh(mesh.vertices, mesh.faces[:, ::-1], mesh.uvs, normals))

    inside_out = replace(scene, bodies=tuple(turned(body) if body.is_part else body for body in scene.bodies))
    on_ball = SimulatedD435i(scene, SETTINGS).truth(POSE).body == 0
    assert on_ball.sum() > 500
    for name in ("projector", "ambient"):
        ours, theirs = (
            getattr(SimulatedD435i(s, SETTINGS, sampling=replace(FEW, glossy_paths=256)).render(POSE)[0], name)[
                on_ball
            ].mean()
            for s in (scene, inside_out)
        )
        assert theirs == pytest.approx(ours, rel=SAMPLING_ERROR)


def test_a_missing_bsdf_file_is_named(tmp_path: Path):
    """When it is first needed, in one line, though a loop is being recorded by then."""
    scene = coupon_scene("ball", Measured("chrome", tmp_path / "chrome.bsdf"), "workshop")
    with pytest.raises(InputError, match=r"chrome\.bsdf"):
        SimulatedD435i(scene, SETTINGS, sampling=FEW).render(POSE)
