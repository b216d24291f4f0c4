"""Polarised light of two metal plates against Mitsuba's own polarised variant: Stokes images of the same scene.

The lamp is seen by way of two plates whose planes of incidence are turned against each other, so that all of a Stokes
vector takes part. The judge is Mitsuba's `stokes` integrator around `path`, with `roughconductor` and `polarizer`.
"""

import sys

import numpy as np
import pytest

from franbv.frames import Intrinsics, look_at
from materials.material import RoughConductor
from render.imager.polarisers import Polarisers
from render.light.pattern import d435_pattern
from render.light.projector import ProjectorLight
from render.light.radiance import render_layers
from render.light.sampling import Sampling
from render.world import backend
from render.world.mitsuba_scene import load_scene
from scenes.scene import Body, Lamp, Mesh, Scene
from tests.physics.simple_scenes import lamp_at, rectangle

pytestmark = pytest.mark.slow

METAL = RoughConductor("steel", 3.249, 4.905, 0.05, 0.05)
FIRST, SECOND, LAMP = np.array([0.0, 0.0, 0.0]), np.array([0.3, 0.1, 0.05]), np.array([0.25, -0.1, 0.45])
"""Centres of the plates and of the lamp [m]."""
EYE = np.array([-0.3, 0.12, 0.2])
IMAGE = Intrinsics(24, 24, 240.0, 240.0, 11.5, 11.5)
TOLERANCE = 0.01
"""Of mean light in units of that without films."""
SPP = 4096


def mirror_between(before: np.ndarray, here: np.ndarray, behind: np.ndarray) -> Mesh:
    """A plate that throws light from one point to another."""
    ways = [(p - here) / np.linalg.norm(p - here) for p in (before, behind)]
    return rectangle(here, here + sum(ways), 0.2, 0.2)


PLATES = (mirror_between(EYE, FIRST, SECOND), mirror_between(FIRST, SECOND, LAMP))


def ours(polarisers: Polarisers | None) -> float:
    """Mean light of the lamp."""
    bodies = tuple(Body(f"plate {i}", mesh, METAL, True) for i, mesh in enumerate(PLATES))
    pose = look_at(EYE, FIRST)
    world = load_scene(Scene("two plates", bodies, (lamp(),), 0.0))
    light = ProjectorLight.at(pose, d435_pattern(), 0.0)
    sampling = Sampling(glossy_paths=1024, refined_share=0, closing=False, photons=0)
    return float(render_layers(world, light, IMAGE, pose, sampling, polarisers=polarisers).ambient.mean())


def lamp() -> Lamp:
    """Of 6 x 6 cm."""
    return lamp_at(LAMP, SECOND, 0.06, 10.0)


def judged_stokes(film_deg: float | None) -> np.ndarray:
    """Mean I, Q, U of the image, Q along its rows. film_deg: of an ideal polariser before the lamp."""
    backend.mitsuba()
    import mitsuba as mi

    mi.set_variant("llvm_ad_mono_polarized")
    try:
        return _stokes(mi, film_deg)
    finally:
        backend.mitsuba()


def _stokes(mi, film_deg: float | None) -> np.ndarray:
    def plate(pose, half, **more):
        matrix = pose.as_matrix() @ np.diag([half, half, 1.0, 1.0])
        return {"type": "rectangle", "to_world": mi.ScalarTransform4f(matrix.tolist()), **more}

    def constant(value):
        return {"type": "spectrum", "value": float(value)}

    steel = {"type": "roughconductor", "distribution": "ggx", "alpha": METAL.alpha_u}
    steel |= {"eta": constant(METAL.n), "k": constant(METAL.k)}
    scene = {"type": "scene", "integrator": {"type": "stokes", "nested": {"type": "path", "max_depth": 8}}}
    for i, mesh in enumerate(PLATES):
        centre = mesh.vertices.mean(axis=0)
        facing = centre + np.cross(mesh.vertices[1] - mesh.vertices[0], mesh.vertices[2] - mesh.vertices[1])
        scene[f"plate_{i}"] = plate(look_at(centre, facing), 0.1, bsdf={"type": "twosided", "bsdf": steel})
    shape, black = lamp(), {"type": "diffuse", "reflectance": constant(0.0)}
    light = {"type": "area", "radiance": constant(shape.radiance)}
    scene["lamp"] = plate(shape.T_world_lamp, shape.width / 2, emitter=light, bsdf=black)
    if film_deg is not None:
        before = shape.T_world_lamp.translation + 0.001 * shape.T_world_lamp.rotation.as_matrix()[:, 2]
        pose = type(shape.T_world_lamp).from_components(before, shape.T_world_lamp.rotation)
        scene["film"] = plate(pose, shape.width / 2 + 0.002, bsdf={"type": "polarizer", "theta": constant(film_deg)})
    to_world = look_at(EYE, FIRST).as_matrix() @ np.diag([-1.0, -1, 1, 1])
    scene["camera"] = {
        "type": "perspective",
        "fov": float(np.degrees(2 * np.arctan(IMAGE.width / (2 * IMAGE.fx)))),
        "near_clip": 1e-3,
        "to_world": mi.ScalarTransform4f(to_world.tolist()),
        "film": {
            "type": "hdrfilm",
            "width": IMAGE.width,
            "height": IMAGE.height,
            "rfilter": {"type": "box"},
            "pixel_format": "luminance",
        },
    }
    image = np.array(mi.render(mi.load_dict(scene), spp=SPP, seed=1))
    return image.mean(axis=(0, 1))[[0, 4, 7]]


FILMS = [None, 0.0, 45.0, 90.0]


@pytest.mark.parametrize("lamps_deg", FILMS)
def test_stokes_images_are_those_of_mitsuba(lamps_deg: float | None):
    """I, Q and U from four turns of an ideal film before the imager: I_0 + I_90, I_0 - I_90, I_45 - I_135, the last
    with the sign of an image whose y points down. Mitsuba turns its film the other way about the lamp."""
    theirs = judged_stokes(None if lamps_deg is None else -lamps_deg)
    seen = [ours(Polarisers(imagers_deg=a, lamps_deg=lamps_deg, film="ideal")) for a in (0.0, 45.0, 90.0, 135.0)]
    found = np.array([(sum(seen)) / 2, seen[0] - seen[2], seen[3] - seen[1]])
    sys.stdout.write(f"film before the lamp {lamps_deg}: I, Q, U ours {found}, Mitsuba's {theirs}\n")
    assert np.abs(found - theirs).max() < TOLERANCE * judged_stokes(None)[0]
    assert np.abs(theirs[1:]).max() > 10 * TOLERANCE * theirs[0]
