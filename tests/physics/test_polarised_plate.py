"""Polarisers before a tilted plate, against Fresnel's r_s and r_p: dots and lamps apart, through the whole renderer."""

import numpy as np
import pytest

from franbv.frames import Intrinsics, look_at
from materials.catalog import material
from materials.fresnel import degree_of_polarisation, fresnel_amplitudes
from materials.material import Material, Matte, RoughConductor, RoughPlastic
from render.imager.polarisers import Polarisers
from render.light.pattern import d435_pattern
from render.light.projector import ProjectorLight
from render.light.radiance import RadianceLayers, render_layers
from render.light.sampling import Sampling
from render.world.mitsuba_scene import load_scene
from scenes.scene import Body, Scene
from tests.physics.simple_scenes import lamp_at, rectangle

ONE_PERCENT = 0.01
IMAGE = Intrinsics(20, 20, 800.0, 800.0, 9.5, 9.5)
DIRECT = Sampling(max_depth=1, glossy_paths=64, closing=False, photons=0)
ACROSS_DEG, ALONG_DEG = 0.0, 90.0
"""Axes of films whose light is s and p: the baseline lies across the plane of incidence."""


def smooth(name: str) -> RoughConductor:
    """The metal with a narrow lobe, whose facets all lie at the plate's own angle."""
    row = material(f"{name}:polished")
    assert isinstance(row, RoughConductor)
    return RoughConductor(name, row.n, row.k, 0.03, 0.03)


def reflectances(metal: RoughConductor, angle_deg: float) -> tuple[float, float]:
    """R_s and R_p."""
    r_s, r_p = fresnel_amplitudes(np.radians([angle_deg]), metal.n, metal.k)
    return float(np.abs(r_s[0]) ** 2), float(np.abs(r_p[0]) ** 2)


def layers(surface: Material, angle_deg: float, **films) -> RadianceLayers:
    """A plate seen under an angle, with projector and lamp where it mirrors them to the imager."""
    angle = np.radians(angle_deg)
    eye, source = (0.4 * np.array([side * np.sin(angle), 0, np.cos(angle)]) for side in (1, -1))
    plate = Body("plate", rectangle([0, 0, 0], [0, 0, 1], 0.3, 0.3), surface, True)
    world = load_scene(Scene("plate", (plate,), (lamp_at(source * 1.1, [0, 0, 0], 0.05, 10.0),), 0.0))
    light = ProjectorLight.at(look_at(source, np.zeros(3)), d435_pattern(), 0.3)
    polarisers = Polarisers(film="ideal", **films) if films else None
    return render_layers(world, light, IMAGE, look_at(eye, np.zeros(3)), DIRECT, polarisers=polarisers)


def shares(surface: Material, angle_deg: float, **films) -> tuple[float, float]:
    """Of the dots' and of the lamp's light, what films leave."""
    plain, behind = layers(surface, angle_deg), layers(surface, angle_deg, **films)
    return (
        float(behind.projector.sum() / plain.projector.sum()),
        float(behind.ambient.sum() / plain.ambient.sum()),
    )


@pytest.mark.parametrize("name", ["aluminium", "stainless_austenitic", "brass", "tungsten"])
@pytest.mark.parametrize("angle_deg", [45.0, 65.0])
def test_dots_and_lamps_pass_as_fresnel_says(name: str, angle_deg: float):
    """Of unpolarised light R_s / (R_s + R_p) passes along the plate's s, the rest along its p, half aslant."""
    metal = smooth(name)
    r_s, r_p = reflectances(metal, angle_deg)
    for axis, expected in ((ACROSS_DEG, r_s / (r_s + r_p)), (ALONG_DEG, r_p / (r_s + r_p)), (45.0, 0.5)):
        assert shares(metal, angle_deg, imagers_deg=axis) == pytest.approx([expected] * 2, rel=ONE_PERCENT)


def test_polarised_dots_and_lamps_are_reflected_with_r_s_and_r_p():
    """With films before the sources alone: half of the light is left, and of it R_s or R_p comes back instead of their
    mean."""
    steel = smooth("stainless_austenitic")
    r_s, r_p = reflectances(steel, 65.0)
    for axis, reflected in ((ACROSS_DEG, r_s), (ALONG_DEG, r_p)):
        found = shares(steel, 65.0, projector_deg=axis, lamps_deg=axis)
        assert found == pytest.approx([reflected / (r_s + r_p)] * 2, rel=ONE_PERCENT)


def test_a_clear_coat_polarises_most():
    """The coat of a paint over black sends back 83 % polarised light at 45 deg: at n = 1.5 amplitudes by Snell's law
    make R_s 9.2 % and R_p 0.85 %."""
    coat = RoughPlastic("coat over black", 1.5, 0.03, 0.0)
    found = np.array([shares(coat, 45.0, imagers_deg=axis) for axis in (ACROSS_DEG, ALONG_DEG)])
    degree = (found[0] - found[1]) / (found[0] + found[1])
    assert degree == pytest.approx([(9.201 - 0.847) / (9.201 + 0.847)] * 2, rel=ONE_PERCENT)


def test_degrees_of_polarisation_of_metals_at_45_deg():
    """5 % for aluminium, 13 % for stainless steel, 2 % for brass: a polariser before the lens does next to nothing
    there. By Azzam's relation r_p = r_s^2 at 45 deg, the degree is (1 - R_s) / (1 + R_s), whatever the metal."""
    angle = np.radians([45.0])
    for name, expected in (("aluminium", 0.05), ("stainless_austenitic", 0.13), ("brass", 0.02)):
        metal = smooth(name)
        degree = degree_of_polarisation(angle, metal.n, metal.k)[0]
        assert degree == pytest.approx(expected, abs=0.005)
        r_s = np.abs(fresnel_amplitudes(angle, metal.n, metal.k)[0][0]) ** 2
        assert degree == pytest.approx((1 - r_s) / (1 + r_s), abs=1e-12)


@pytest.mark.parametrize("crossed", [False, True])
def test_films_on_bare_metal_and_on_paint(crossed: bool):
    """Seen straight on, metal sends dots back as polarised as they came: crossed films take them, parallel ones leave
    half. Matte paint forgets: a quarter passes either way, of the lamp's unpolarised light half."""
    turn = 90.0 if crossed else 0.0
    on_metal = shares(RoughConductor("steel", 3.249, 4.905, 0.3, 0.3), 0.0, imagers_deg=turn, projector_deg=0.0)
    on_paint = shares(Matte("paint", 0.5), 0.0, imagers_deg=turn, projector_deg=0.0)
    assert on_paint == pytest.approx([0.25, 0.5], rel=1e-4)
    assert on_metal[1] == pytest.approx(0.5, rel=ONE_PERCENT)
    single_bounce = 0.5 * (1 - crossed)
    # Further bounces between facets of this roughness are 4 % of the light, and taken as depolarised.
    assert on_metal[0] == pytest.approx(single_bounce, abs=0.02)
