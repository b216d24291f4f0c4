"""Stokes rows along paths against fields traced in three dimensions, and Fresnel's Mueller matrix against Mitsuba's."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from materials.catalog import material
from materials.fresnel import conductor_reflectance, fresnel_amplitudes
from materials.input_error import InputError
from materials.lights import Band
from materials.material import Material, Matte, Measured, RoughConductor, RoughPlastic
from render.imager.polarisers import Polarisers
from render.light.microfacets import facet_lobe
from render.light.pattern import d435_pattern
from render.light.polarisation import Polarisation, facet_numbers
from render.light.projector import ProjectorLight
from render.light.scatter import Scattered
from render.light.stokes import fresnel_mueller
from render.world import backend
from render.world.mitsuba_scene import load_scene
from scenes.scene import Scene
from tests.physics.simple_scenes import facing_x, lamp_at, wall

N = 500
SINGLE_PRECISION = 5e-4
STEEL = RoughConductor("steel", 3.249, 4.905, 0.3, 0.3)
BRASS = RoughConductor("brass", 0.490, 5.269, 0.3, 0.3)
CLEAR = RoughPlastic("clear", 1.5, 0.3, 0.0)


@pytest.mark.parametrize("index", [(3.249, 4.905), (0.04, 5.965), (1.5, 0.0)])
def test_mueller_matrix_is_that_of_mitsuba_and_of_the_amplitudes(index: tuple[float, float]):
    """By Mitsuba's complex amplitudes, which have the sign of our r_s and the opposite one of r_p, or by ours."""
    mi = backend.mitsuba()
    theta = np.linspace(0.0, 1.5, 200)
    found = [x.numpy() for x in fresnel_mueller(mi.Float(np.cos(theta).astype(np.float32)), *map(mi.Float, index))]
    r_s, r_p = fresnel_amplitudes(theta, *index)
    their_s, their_p, *_ = mi.fresnel_polarized(mi.Float(np.cos(theta).astype(np.float32)), mi.Complex2f(*index))
    theirs = [mi.Float(x.real).numpy() + 1j * mi.Float(x.imag).numpy() for x in (their_s, their_p)]
    np.testing.assert_allclose(np.abs(theirs), np.abs([r_s, r_p]), atol=SINGLE_PRECISION)
    ours, product = r_s * np.conj(r_p), theirs[0] * np.conj(theirs[1])
    np.testing.assert_allclose(np.abs(np.real(ours)), np.abs(np.real(product)), atol=SINGLE_PRECISION)
    np.testing.assert_allclose(np.abs(np.imag(ours)), np.abs(np.imag(product)), atol=SINGLE_PRECISION)
    mean = (np.abs(r_s) ** 2 + np.abs(r_p) ** 2) / 2
    difference = (np.abs(r_s) ** 2 - np.abs(r_p) ** 2) / 2
    for x, expected in zip(found, (mean, difference / mean, np.real(ours) / mean, np.imag(ours) / mean), strict=True):
        np.testing.assert_allclose(x, expected, atol=SINGLE_PRECISION)


def unit(v: np.ndarray) -> np.ndarray:
    """Columns (3, n) of length one."""
    return v / np.linalg.norm(v, axis=0)


def across(v: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Unit vectors across `v` and a line."""
    return unit(np.cross(v.T, line).T)


def field_behind(field: np.ndarray, to_light: np.ndarray, to_viewer: np.ndarray, metal: RoughConductor) -> np.ndarray:
    """The field (3, n) that a facet sends on, by components across and in the plane of incidence."""
    half = unit(to_light + to_viewer)
    s = unit(np.cross(to_viewer.T, half.T).T)
    p_in, p_out = np.cross(-to_light.T, s.T).T, np.cross(to_viewer.T, s.T).T
    theta = np.arccos(np.clip(np.sum(half * to_light, axis=0), -1, 1))
    r_s, r_p = fresnel_amplitudes(theta, metal.n, metal.k)
    return r_s * np.sum(field * s, axis=0) * s + r_p * np.sum(field * p_in, axis=0) * p_out


def interaction(to_viewer: np.ndarray, to_light: np.ndarray):
    """With the normal half way between both directions."""
    mi = backend.mitsuba()
    import drjit as dr

    si = dr.zeros(mi.SurfaceInteraction3f, to_viewer.shape[1])
    half = unit(to_viewer + to_light).astype(np.float32)
    si.sh_frame = mi.Frame3f(mi.Normal3f(half))
    si.wi = si.to_local(mi.Vector3f(to_viewer.astype(np.float32)))
    return si


def bare(si, to_light: np.ndarray, surface: RoughConductor) -> Scattered:
    """What facets alone do with unpolarised light that comes from there."""
    mi = backend.mitsuba()

    wo = si.to_local(mi.Vector3f(to_light.astype(np.float32)))
    theta = np.arccos(np.clip(si.wi.z.numpy(), -1, 1)).astype(float)
    mean = mi.Float(conductor_reflectance(theta, surface.n, surface.k).astype(np.float32))
    value = facet_lobe(si.wi, wo, (mi.Float(surface.alpha_u), mi.Float(surface.alpha_v))) * mean
    return Scattered(value, [(value, mi.Float(1))], wo, mi.Float(1), (value, value))


def films(polarisers: Polarisers, *materials: Material) -> Polarisation:
    """Before a wall with a lamp; what reflects is the caller's."""
    mi = backend.mitsuba()
    scene = wall(1.0, Matte("wall", 0.5), (lamp_at([-1.0, 0, 0.5], [1.0, 0, 0], 0.1, 1.0),))
    world = load_scene(Scene("wall", scene.bodies, scene.lamps, 0.0))
    made = Polarisation.of(polarisers, world, ProjectorLight.at(facing_x(), d435_pattern(), 1.0), facing_x())
    return replace(made, facets=mi.Float(facet_numbers(materials, Band.PROJECTOR).ravel()))


def line(axis_deg: float, T: RigidTransform) -> np.ndarray:
    """What a film blocks, in the world: its axis turned by a quarter."""
    angle = np.radians(axis_deg + 90)
    return T.rotation.apply([np.cos(angle), np.sin(angle), 0.0])


@pytest.mark.parametrize("turns", [(0.0, 0.0, 0.0), (30.0, 75.0, -20.0), (90.0, 10.0, 130.0)])
def test_two_facets_turn_light_as_its_field_says(turns: tuple[float, float, float]):
    """A polarised source, steel, brass, a film before the imager: the share is |e . E|^2 of the field that is carried
    in three dimensions, over half of what both send on of unpolarised light. The projector and a lamp apart."""
    mi = backend.mitsuba()
    imager, projector, lamps = turns
    made = films(Polarisers(imagers_deg=imager, projector_deg=projector, lamps_deg=lamps, film="ideal"), STEEL, BRASS)
    rng = np.random.default_rng(0)
    first, second, light = (unit(rng.normal(size=(3, N))) for _ in range(3))
    body = [mi.UInt32(np.full(N, i, np.uint32)) for i in range(2)]
    seen = interaction(-first, second)
    rows = made.through_film(mi.Vector3f(first.astype(np.float32)))
    on_first = bare(seen, second, STEEL)
    device = mi.Vector3f(second.astype(np.float32))
    turned, rows = made.polarised(rows, seen, body[0], device, [], replace(on_first, to_lamps=[]))
    here = interaction(-second, light)
    on_second = bare(here, light, BRASS)
    towards = mi.Vector3f(light.astype(np.float32))
    last, _ = made.polarised(rows, here, body[1], towards, [towards], on_second)
    shares = [
        (turned.weight[band] / on_first.weight[band] * value / on_second.to_projector).numpy()
        for band, value in ((0, last.to_projector), (1, last.to_lamps[0][0]))
    ]
    lamp = lamp_at([-1.0, 0, 0.5], [1.0, 0, 0], 0.1, 1.0).T_world_lamp
    for share, source in zip(shares, (line(projector, facing_x()), line(lamps, lamp)), strict=True):
        field = field_behind(across(light, source).astype(complex), light, -second, BRASS)
        field = field_behind(field, second, -first, STEEL)
        passed = np.abs(np.sum(across(first, line(imager, facing_x())) * field, axis=0)) ** 2
        unpolarised = 1.0
        for (to_viewer, to_light), metal in zip(((-first, second), (-second, light)), (STEEL, BRASS), strict=True):
            cosine = np.sqrt(np.clip((1 + np.sum(to_viewer * to_light, axis=0)) / 2, 0, 1))
            unpolarised = unpolarised * conductor_reflectance(np.arccos(cosine), metal.n, metal.k)
        there = (1 + np.sum(-first * second, axis=0) > 0.1) & (1 + np.sum(-second * light, axis=0) > 0.1)
        np.testing.assert_allclose(share[there], (2 * passed / unpolarised)[there], atol=5e-3)
        assert there.sum() > N / 2


def test_matte_surfaces_and_oxide_forget():
    """Behind matte paint nothing is polarised; half of an oxidised metal's light keeps what it has where both send back
    as much."""
    mi = backend.mitsuba()
    oxidised = replace(STEEL, oxide_share=0.5, oxide_reflectance=0.5)
    made = films(Polarisers(imagers_deg=0.0, projector_deg=0.0, film="ideal"), Matte("matte", 0.5), oxidised)
    way = np.tile([[1.0], [0.0], [0.0]], N)
    si = interaction(-way, -way)
    lobes = bare(si, -way, STEEL)  # twice what facets of half the surface do: the oxide adds as much
    for body, share in ((0, 1.0), (1, 1.5)):
        rows = made.through_film(mi.Vector3f(way.astype(np.float32)))
        where = mi.UInt32(np.full(N, body, np.uint32))
        after, rows = made.polarised(
            rows, si, where, mi.Vector3f(-way.astype(np.float32)), [], replace(lobes, to_lamps=[])
        )
        np.testing.assert_allclose((after.to_projector / lobes.to_projector).numpy(), share, rtol=1e-4)
        if body == 0:
            assert not rows.bands[0].numpy().any()
            assert not rows.bands[1].numpy().any()


def test_facets_of_coats_are_clear_and_measured_files_are_refused(tmp_path):
    """A plastic's k is 0 in both bands; what is not known of a file is not made up."""
    numbers = facet_numbers([material("white_plastic"), CLEAR], Band.WHITE_LED)
    assert numbers[1].tolist() == pytest.approx([0.3, 0.3, 1.5, 0.0, 1.5, 0.0, 1.0, 0.0])
    assert numbers[0, 3] == numbers[0, 5] == 0
    with pytest.raises(InputError, match=r"plate: a measured file .* imager\.polarisers"):
        facet_numbers([Measured("plate", tmp_path / "plate.bsdf")], Band.WHITE_LED)
