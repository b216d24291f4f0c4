"""The camera behind polarisers: what it renders, keeps, and refuses."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from materials.input_error import InputError
from materials.material import Material, Matte, Measured, RoughConductor, RoughPlastic
from render.d435i import SimulatedD435i
from render.imager.polarisers import Polarisers
from render.imager.settings import ImagerSettings
from render.light.sampling import Sampling
from render.sensor import SensorSettings
from scenes.scene import Body, Scene
from tests.physics.simple_scenes import facing_x, lamp_at, rectangle, wall

FEW = Sampling(glossy_paths=8, refined_share=0, max_depth=1, closing=False)
CROSSED = Polarisers(imagers_deg=90.0, projector_deg=0.0, film="ideal")
STEEL = RoughConductor("steel", 3.249, 4.905, 0.15, 0.15)


def camera(scene: Scene, polarisers: Polarisers | None, **imager) -> SimulatedD435i:
    settings = SensorSettings(profile="424x240", crop=None, imager=ImagerSettings(polarisers=polarisers, **imager))
    return SimulatedD435i(scene, settings, sampling=FEW)


def lit_wall(surface: Material) -> Scene:
    """A wall square to the camera at 0.4 m under a lamp, over all of the image."""
    return wall(0.4, surface, (lamp_at([-1.0, 0, 1.0], [0.4, 0, 0], 0.4, 5.0),))


def test_without_films_nothing_changes():
    """A camera with a place for films and none in it renders the bits of one without the place."""
    scene = lit_wall(STEEL)
    for ours, plain in zip(
        camera(scene, Polarisers()).render(facing_x()), camera(scene, None).render(facing_x()), strict=True
    ):
        np.testing.assert_array_equal(ours.projector, plain.projector)
        np.testing.assert_array_equal(ours.ambient, plain.ambient)


def test_matte_scenes_are_darker_by_one_factor():
    """Crossed or not: a quarter of the dots, half of the lamps, and the same share of what the projector's shadows
    lack; the camera exposes longer instead."""
    scene = wall(0.4, Matte("paint", 0.5), (lamp_at([-1.0, 0, 1.0], [0.4, 0, 0], 0.1, 5.0),))
    post = Body("post", rectangle([0.3, 0.0, 0.0], [0, 0, 0], 0.02, 0.1), Matte("post", 0.5), True)
    scene = replace(scene, bodies=(*scene.bodies, post))
    plain, behind = camera(scene, None), camera(scene, CROSSED)
    for side in (0, 1):
        ours, all_of_it = behind.render(facing_x())[side], plain.render(facing_x())[side]
        np.testing.assert_allclose(ours.projector, all_of_it.projector / 4, rtol=1e-5)
        np.testing.assert_allclose(ours.ambient, all_of_it.ambient / 2, rtol=1e-5)
        shadows = (c.dots_in_shadow(facing_x())[side] for c in (behind, plain))
        np.testing.assert_allclose(next(shadows), next(shadows) / 4, rtol=1e-5)
    exposures = [c.measure(facing_x(), 1).imager.exposure_us for c in (plain, behind)]
    assert exposures[1] > 1.5 * exposures[0]


def test_crossed_films_take_the_dots_from_metal_and_leave_its_lamps():
    """Between projector and imager facets lie square to both, where metal keeps the polarisation: next to nothing comes
    back, stopped at the first surface or not. Of the lamp, which it sees aslant, half is left, give or take half of its
    degree of polarisation: at most 10 % of that light for this steel below 45 deg."""
    scene = lit_wall(STEEL)
    plain, behind = camera(scene, None), camera(scene, CROSSED)
    pairs = [(c.render(facing_x()), c) for c in (plain, behind)]
    for light in ([pair[0] for pair, _ in pairs], [c.stopped_at_first_surface(facing_x(), *p)[0] for p, c in pairs]):
        bright = light[0].projector > 0.1 * light[0].projector.max()
        assert bright.sum() > 100
        assert light[1].projector[bright].mean() < 0.005 * light[0].projector[bright].mean()
        assert light[1].ambient.mean() == pytest.approx(light[0].ambient.mean() / 2, rel=0.1)


def test_films_may_be_changed():
    """A camera that is changed to other films renders what a new one with them does."""
    scene = lit_wall(STEEL)
    changed = camera(scene, None).changed(imager=ImagerSettings(polarisers=CROSSED))
    np.testing.assert_array_equal(
        changed.render(facing_x())[0].projector, camera(scene, CROSSED).render(facing_x())[0].projector
    )


@pytest.mark.parametrize("base", [0.0, 0.7])
def test_crossed_films_take_the_coats_highlight_and_leave_its_base(base: float):
    """A clear coat over black goes dark; over white a quarter of what the base sends back is left, whose share of all
    light is known from the coat over black."""
    coat = RoughPlastic("coat", 1.5, 0.2, base)
    plain, behind = (camera(lit_wall(coat), films).render(facing_x())[0].projector for films in (None, CROSSED))
    gloss = camera(lit_wall(replace(coat, reflectance=0.0)), None).render(facing_x())[0].projector
    there = gloss > 0.2 * gloss.max()
    highlight, of_base = float(gloss[there].mean()), float((plain - gloss)[there].mean())
    assert float(behind[there].mean()) == pytest.approx(0.25 * of_base, rel=0.02, abs=0.005 * highlight)


def test_measured_materials_are_refused_behind_films(tmp_path: Path):
    """One line that names the material and the way out."""
    scene = wall(0.4, Measured("gold foil", tmp_path / "gold.bsdf"))
    with pytest.raises(InputError, match="gold foil: a measured file does not say how it polarises light"):
        camera(scene, CROSSED).render(facing_x())
