"""Our light transport against Blender's Cycles: a closed room with boxes and a plate, square by square.

Both trace the same triangles. Cycles finds all paths from the camera by chance and leaves none out, so it is right but
for noise; ours looks most light up where it varies slowly.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.frames import Intrinsics, look_at
from materials.material import Material, Matte, RoughConductor
from render.light.pattern import BLUR_LEVELS, DotPattern
from render.light.projector import ProjectorLight
from render.light.radiance import render_layers
from render.light.sampling import Sampling
from render.world.mitsuba_scene import load_scene
from render.world.surface import surface_map
from scenes.primitives import box, moved
from scenes.primitives import rectangle as facing_up
from scenes.scene import Body, Lamp, Mesh, Scene
from tests.judges.blender import EvenProjector, cycles_radiance, needs_cycles

pytestmark = pytest.mark.slow

IMAGE = Intrinsics(320, 240, 210.0, 210.0, 159.5, 119.5)
EYE = look_at(np.array([-0.55, -0.35, 0.75]), np.array([0.0, 0.0, 0.05]))
PROJECTOR = EvenProjector(look_at(np.array([-0.50, -0.38, 0.75]), np.array([0.0, 0.0, 0.05])), (0.9, 0.55), 0.3)
BLOCK = 8
"""Side of the squares that are compared [px]."""
OF_BODIES = 0.03
"""Relative: by how much a body's mean radiance may differ."""
OF_BLOCKS = 0.05
"""Relative: by how much a square's may, but for one in fifty: those in corners, where light is interpolated."""
DARK = 0.05
"""Of the median square: darker ones are not compared, since Cycles' noise is not small there."""
FINE = Sampling(
    subpixels=16, lamp_points=64, lamp_strides_px=(1,), indirect_directions=512, indirect_strides_px=(4, 1),
    glossy_paths=256, filtered=False,
)  # fmt: skip
"""So fine that what is left is the transport and not its sampling: paths of three vertices closed by radiosity,
caustics by photons. Unfiltered, so that the projector's field ends hard."""


def flat(mesh: Mesh) -> Mesh:
    """Without normals and texture coordinates, which isotropic flat faces do not need."""
    return Mesh(mesh.vertices, mesh.faces)


def placed(mesh: Mesh, at: tuple[float, float, float], turned: tuple[float, float] = (0.0, 0.0)) -> Mesh:
    """Turned about y, then about z [deg]."""
    return flat(moved(mesh, RigidTransform.from_components(at, Rotation.from_euler("yz", turned, degrees=True))))


def room(plate: Material) -> Scene:
    """A room of 2 m with a lamp of 0.5 x 0.3 m under its ceiling; boxes on the floor; a plate that leans over them."""
    walls = placed(box((2.0, 2.0, 2.0)), (0.0, 0.0, 1.0))
    inward = Mesh(walls.vertices, walls.faces[:, ::-1])
    bodies = {
        "room": (inward, Matte("room", 0.5)),
        "table": (placed(facing_up(0.9, 0.8), (0.0, 0.0, 0.001)), Matte("table", 0.4)),
        "tall": (placed(box((0.12, 0.12, 0.26)), (0.12, 0.16, 0.131), (0, 25)), Matte("tall", 0.7)),
        "low": (placed(box((0.25, 0.10, 0.06)), (-0.10, -0.18, 0.031), (0, -15)), Matte("low", 0.2)),
        "cube": (placed(box((0.09, 0.09, 0.09)), (-0.12, 0.12, 0.046), (0, 40)), Matte("cube", 0.6)),
        "plate": (placed(box((0.004, 0.25, 0.20)), (0.20, -0.06, 0.11), (20, -5)), plate),
    }
    down = Rotation.from_euler("xz", (180, 20), degrees=True)
    lamp = Lamp("lamp", RigidTransform.from_components([-0.5, 0.2, 1.9], down), 0.5, 0.3, 20.0)
    return Scene("judged", tuple(Body(name, *rest, name != "room") for name, rest in bodies.items()), (lamp,), 0.0)


MATTE = Matte("plate", 0.7)
SATIN, BLASTED = (RoughConductor("plate", 2.588, 8.169, alpha, alpha) for alpha in (0.1, 0.3))
"""Aluminium (Rakic 1995)."""
MODELLED_OTHERWISE = {BLASTED: "plate"}
"""What is not compared: the radiance of rough metal itself, to which each renderer adds the light of further bounces
between facets by a model of its own (with it the plate differs by 8 %, without it by 0.2 %). Ours is held against a
random walk (tests/physics/test_energy_compensation.py). What the metal throws onto other bodies is compared."""


PLATE_TOO_DARK = pytest.mark.xfail(
    raises=AssertionError,
    strict=True,
    reason="the plate itself mirrors 8 % too little of the light that reaches it by way of others; others are right",
)


def radiance(scene: Scene, of_projector: bool) -> np.ndarray:
    """Ours, of one light or the other [W m^-2 sr^-1]."""
    even = np.ones((64, 64), np.float32)
    pattern = DotPattern(PROJECTOR.half_field, even, np.stack([even] * BLUR_LEVELS), sigma=1e-3)
    light = ProjectorLight.at(PROJECTOR.T_world_projector, pattern, PROJECTOR.mean)
    layers = render_layers(load_scene(scene), light, IMAGE, EYE, FINE)
    return layers.projector if of_projector else layers.ambient


def squares(image: np.ndarray) -> np.ndarray:
    """Means over BLOCK x BLOCK pixels."""
    height, width = image.shape
    return image.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK).mean(axis=(1, 3))


@pytest.mark.parametrize("of_projector", [False, True], ids=["lamp", "projector"])
@pytest.mark.parametrize(
    ("plate", "samples"),
    [
        pytest.param(MATTE, 64, id="matte"),
        pytest.param(SATIN, 128, id="satin"),
        pytest.param(BLASTED, 128, id="blasted"),
    ],
)
def test_radiance_is_that_of_cycles(
    plate: Material, samples: int, of_projector: bool, tmp_path: Path, request: pytest.FixtureRequest
):
    """Light is light: two renderers that share no code agree on every body and, at the size of a few dots, on every
    place. The radiance of a Lambertian body is its irradiance times albedo over pi, so the table's tells what reaches
    it: from lamp or projector, by way of walls and boxes, and thrown by the plate."""
    needs_cycles()
    if plate is SATIN and of_projector:
        request.applymarker(PLATE_TOO_DARK)
    scene = room(plate)
    theirs = cycles_radiance(scene, IMAGE, EYE, tmp_path, PROJECTOR if of_projector else None, samples)
    mine, body = radiance(scene, of_projector), surface_map(load_scene(scene), IMAGE, EYE).body
    seen = {b.name: body == number for number, b in enumerate(scene.bodies)}
    left_out = seen.pop(MODELLED_OTHERWISE.get(plate, ""), np.zeros(body.shape, bool))
    of_bodies = {name: float(mine[there].mean() / theirs[there].mean() - 1) for name, there in seen.items()}
    a, b = squares(mine), squares(theirs)
    kept = (b > DARK * np.median(b)) & (squares(left_out.astype(float)) == 0)
    off = np.abs(a[kept] / b[kept] - 1)
    of_squares = float(np.percentile(off, 98))
    figures = ", ".join(f"{name} {error:+.1%}" for name, error in of_bodies.items()) + f"; squares {of_squares:.1%}"
    assert max(map(abs, of_bodies.values())) < OF_BODIES, figures
    assert of_squares < OF_BLOCKS, figures
