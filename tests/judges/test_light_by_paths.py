"""Rendered layers against Mitsuba's path integrator, pixel by pixel, for every class of material and every part.

The judge follows each path to its end by chance; ours looks most light up where it varies slowly, ends paths in
radiosity, and finds caustics from the other side. A pixel is wrong when the two differ by more than their own spread
over seeds explains, with the limit that no pixel of a right image passes but with a chance of 5 % (Sidak).
"""

import sys
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at
from materials.catalog import material
from materials.material import Material, Measured
from render.d435i import SimulatedD435i
from render.light.pattern import d435_pattern
from render.light.radiance import render_layers
from render.light.sampling import Sampling
from render.sensor import SensorSettings
from render.world.surface import surface_map
from scenes.build import coupon_scene, part_scene, scene_on_table
from scenes.parts import EARLIER_PARTS
from scenes.primitives import box, moved
from scenes.scene import Body, Scene
from tests.judges.path_judge import Estimate, judged_layers, share_beyond
from tests.materials.rgl_file import spectral_measurement, write_tensor_file

pytestmark = pytest.mark.slow

SETTINGS = SensorSettings(profile="424x240", crop=None)
WINDOW = (112, 60, 200, 120)
"""Of the image: left, top, width, height [px]. The part and what it throws light onto."""
POSE = look_at(np.array([0.25, -0.15, 0.35]), np.array([0.0, 0.0, 0.03]))
SEEDS, SPP, OURS = 16, 16, 12
"""Images of the judge, its paths a pixel in each, and images of ours: all pixels of one share their samples, so that it
may be off as a whole."""
BEYOND = 0.01
"""Share of pixels that may lie beyond the limit."""
OF_CLASSES = 0.02
"""Relative: by how much the mean over a material's pixels may differ, beyond three sigma of the two means."""
LEAST_PIXELS = 100
"""Of a material that is compared [px]."""


@dataclass(frozen=True)
class Verdict:
    """Of one layer."""

    beyond: float
    """Share of pixels beyond the limit."""
    ratios: dict[str, tuple[float, float]]
    """Ours over the judge's, and the standard deviation of that by the seeds of both, by material."""

    def __str__(self) -> str:
        means = ", ".join(f"{name} {ratio:.3f} +- {sigma:.3f}" for name, (ratio, sigma) in self.ratios.items())
        return f"{100 * self.beyond:.2f} % beyond; {means}"

    @property
    def is_right(self) -> bool:
        return self.beyond <= BEYOND and all(abs(r - 1) <= OF_CLASSES + 3 * s for r, s in self.ratios.values())


def judged(scene: Scene, pose: RigidTransform = POSE) -> dict[str, Verdict]:
    """Both layers of a scene, as the left imager sees them."""
    camera = SimulatedD435i(scene, SETTINGS)
    intrinsics, light = camera.rig.intrinsics.cropped(*WINDOW), camera.projector_light(pose)
    ours = [render_layers(camera.world, light, intrinsics, pose, Sampling(), seed) for seed in range(OURS)]
    theirs = judged_layers(
        scene, d435_pattern(), float(light.mean[0]), intrinsics, pose, camera.rig.projector(pose), SEEDS, SPP
    )
    body = surface_map(camera.world, intrinsics, pose).body
    names = {number: b.material.name for number, b in enumerate(scene.bodies)}
    verdicts = {}
    for layer, images in zip(("projector", "ambient"), theirs, strict=True):
        of_ours = np.stack([getattr(layers, layer) for layers in ours])
        mine, judge = Estimate.of(of_ours), Estimate.of(images)
        ratios = {}
        for name in dict.fromkeys(names.values()):
            there = np.isin(body, [number for number, other in names.items() if other == name])
            if np.count_nonzero(there) >= LEAST_PIXELS:
                means = [stack[:, there].mean(axis=1) for stack in (of_ours, images)]
                sigma = np.hypot(*(m.std(ddof=1) / np.sqrt(len(m)) / m.mean() for m in means))
                ratios[name] = float(means[0].mean() / means[1].mean()), float(sigma)
        verdicts[layer] = Verdict(share_beyond(mine, judge), ratios)
        sys.stdout.write(f"{scene.name}, {layer}: {verdicts[layer]}\n")
    return verdicts


def clutter() -> Scene:
    """Parts of a pile: a bright steel block and six rubber cubes of 6 mm on the table, some of them touching it."""

    def placed(name: str, size: tuple[float, float, float], at: tuple[float, float], spec: str) -> Body:
        pose = RigidTransform.from_translation([*at, size[2] / 2])
        return Body(name, moved(box(size), pose), material(spec), is_part=True)

    block = placed("block", (0.08, 0.05, 0.04), (0.0, 0.0), "iron:bright")
    places = [(0.05, 0.0), (0.044, 0.02), (-0.05, 0.01), (0.0, -0.035), (0.02, -0.05), (-0.02, -0.03)]
    cubes = [placed(f"cube_{i}", (0.006, 0.006, 0.006), place, "rubber") for i, place in enumerate(places)]
    return scene_on_table("pile with small clutter", (block, *cubes))


MATERIALS = (
    "matte_paint",
    "white_plastic",
    "dyed_black_plastic",
    "stainless_austenitic:polished@alpha=0.02",
    "aluminium:bright",
    "copper:ground",
    "brass:brushed",
    "stainless_austenitic:blasted",
    "aluminium:coarse_blasted",
    "iron:oxidised",
)
"""Matte, coated, and metals of alpha 0.02 to 0.5, isotropic or with a lay, bare or oxidised."""


@pytest.mark.parametrize("spec", MATERIALS)
def test_a_ball_of_every_class_of_material(spec: str):
    """On the table in the room, under LED panels and dots."""
    verdicts = judged(replace(coupon_scene("ball", material(spec), radius=0.045), name=f"ball of {spec}"))
    assert all(verdict.is_right for verdict in verdicts.values()), "\n".join(map(str, verdicts.values()))


def test_a_ball_of_measured_material(tmp_path):
    """An RGL file of a wide lobe that reflects about a half. The BSDF is the same in both, the paths are not."""
    arrays = spectral_measurement(np.linspace(360, 1000, 9))
    path = write_tensor_file(tmp_path / "a.bsdf", arrays | {"spectra": 0.05 * arrays["spectra"]})
    made: Material = Measured("measured", path)
    verdicts = judged(replace(coupon_scene("ball", made, radius=0.045), name="ball of a measured material"))
    assert all(verdict.is_right for verdict in verdicts.values()), "\n".join(map(str, verdicts.values()))


@pytest.mark.parametrize("part", EARLIER_PARTS)
def test_the_parts_in_their_own_materials(part: str):
    """From where a reconstruction looks first, or near it."""
    pose = look_at(np.array([0.3, -0.2, 0.35]), np.array([0.0, 0.0, 0.05]))
    verdicts = judged(part_scene(part), pose)
    assert all(verdict.is_right for verdict in verdicts.values()), "\n".join(map(str, verdicts.values()))


def test_an_inside_corner_of_bright_steel():
    """Mutual mirror images, and dots thrown from one plate to the other and onto the table."""
    verdicts = judged(coupon_scene("inside_corner", material("stainless_austenitic:bright")))
    assert all(verdict.is_right for verdict in verdicts.values()), "\n".join(map(str, verdicts.values()))


def test_a_pile_with_small_clutter():
    """Bodies of a few pixels have their own light and albedo."""
    verdicts = judged(clutter())
    assert all(verdict.is_right for verdict in verdicts.values()), "\n".join(map(str, verdicts.values()))


def test_the_judge_sees_a_wrong_image():
    """The light of paths of three vertices without the rest is found wrong: the test can fail."""
    scene = coupon_scene("ball", material("matte_paint"), radius=0.045)
    camera = SimulatedD435i(scene, SETTINGS)
    k, light = camera.rig.intrinsics.cropped(*WINDOW), camera.projector_light(POSE)
    cut = Sampling(closing=False)
    mine = [render_layers(camera.world, light, k, POSE, cut, seed).ambient for seed in range(OURS)]
    theirs = judged_layers(scene, d435_pattern(), float(light.mean[0]), k, POSE, camera.rig.projector(POSE), 4, SPP)[1]
    assert np.mean(mine) < 0.97 * np.mean(theirs)
