"""The metals' lobes against Mitsuba's own `roughconductor`, with the compensation written a second time as a plugin."""

import numpy as np
import pytest
from scipy.stats import chi2

from materials.lights import Band
from materials.material import ConductorNumbers, RoughConductor
from render.light.microfacets import MetalLobes
from render.world import backend
from render.world.reflectances import Reflectances
from tests.judges.judged_bsdf import metal_description

N = 4000
SINGLE_PRECISION = 2e-3
"""Relative, of values and densities in single precision (99.5 % quantile)."""
METALS = [
    RoughConductor("polished", 3.249, 4.905, 0.02, 0.02),
    RoughConductor("ground", 3.249, 4.905, 0.05, 0.15),
    RoughConductor("blasted", 2.588, 8.169, 0.3, 0.3),
    RoughConductor("milled", 0.276, 5.42, 0.08, 0.5),
]


def upper(rng, n=N):
    """Directions even over the upper hemisphere, away from grazing, where single precision shows."""
    z = rng.uniform(0.05, 1.0, n)
    azimuth = rng.uniform(0, 2 * np.pi, n)
    radius = np.sqrt(1 - z**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z]).astype(np.float32)


def lobes_of(metal, wi, band=Band.WHITE_LED):
    mi = backend.mitsuba()
    body = mi.UInt32(np.zeros(wi.shape[1], np.uint32))
    return MetalLobes.at(Reflectances.of([metal], band), body, mi.Vector3f(wi), mi.Bool(True))


@pytest.mark.parametrize("metal", METALS, ids=lambda m: m.name)
def test_values_and_densities_are_those_of_mitsuba(metal):
    """Everywhere on the hemisphere, but for single precision."""
    mi = backend.mitsuba()
    import drjit as dr

    rng = np.random.default_rng(0)
    wi = upper(rng)
    # Half of the directions near the mirrored one, where the lobe is.
    near = wi * [[-1], [-1], [1]] + metal.alpha_u * rng.normal(size=wi.shape)
    wo = np.where(np.arange(N) % 2, upper(rng), near / np.linalg.norm(near, axis=0)).astype(np.float32)
    (value,), pdf = lobes_of(metal, wi).towards(mi.Vector3f(wo), mi.Bool(True), (0,))
    si = dr.zeros(mi.SurfaceInteraction3f, N)
    si.wi = mi.Vector3f(wi)
    expected, expected_pdf = mi.load_dict(metal_description(metal)).eval_pdf(mi.BSDFContext(), si, mi.Vector3f(wo))
    for ours, theirs in ((value.numpy(), expected.x.numpy()), (pdf.numpy(), expected_pdf.numpy())):
        error = np.abs(ours - theirs) / (np.abs(theirs) + 1e-3)
        assert np.quantile(error, 0.995) < SINGLE_PRECISION
        assert theirs.max() > 1


def test_oxide_lies_beside_the_metal():
    """Value: (1 - s) metal + s rho cos / pi."""
    mi = backend.mitsuba()
    bare = METALS[2]
    oxidised = RoughConductor("oxidised", bare.n, bare.k, bare.alpha_u, bare.alpha_v, 0.4, 0.1)
    rng = np.random.default_rng(1)
    wi, wo = upper(rng), upper(rng)
    values = [lobes_of(m, wi).towards(mi.Vector3f(wo), mi.Bool(True), (0,))[0][0].numpy() for m in (bare, oxidised)]
    np.testing.assert_allclose(values[1], 0.6 * values[0] + 0.4 * 0.1 * wo[2] / np.pi, rtol=1e-4, atol=1e-6)


def test_each_band_has_its_own_indices():
    """Under the lamps a metal looks as one does that has those n, k at 850 nm; the density is that of 850 nm."""
    mi = backend.mitsuba()
    red = RoughConductor("red", 0.276, 5.42, 0.3, 0.3, lamps=((Band.WHITE_LED, ConductorNumbers(0.6, 2.6, 0.0)),))
    alone = RoughConductor("alone", 0.6, 2.6, 0.3, 0.3)
    rng = np.random.default_rng(2)
    wi, wo = upper(rng), mi.Vector3f(upper(rng))
    both, pdf = lobes_of(red, wi).towards(wo, mi.Bool(True), (0, 1))
    (single,), single_pdf = lobes_of(alone, wi).towards(wo, mi.Bool(True), (0,))
    np.testing.assert_allclose(both[1].numpy(), single.numpy(), rtol=1e-5)
    np.testing.assert_allclose(pdf.numpy(), single_pdf.numpy(), rtol=1e-6)
    assert np.mean(both[0].numpy()) > 1.1 * np.mean(both[1].numpy())


@pytest.mark.parametrize("metal", METALS, ids=lambda m: m.name)
def test_directions_are_drawn_by_the_density(metal):
    """Of many sampled directions as many fall into each cell of the hemisphere as the density's integral there says
    (chi-square, 0.1 %). Directions below the surface are lost; they count as one more cell."""
    mi = backend.mitsuba()
    n, rows, columns, fine = 200_000, 24, 24, 40
    rng = np.random.default_rng(3)
    wi = np.broadcast_to(np.array([[np.sin(0.9)], [0.0], [np.cos(0.9)]], np.float32), (3, n)).copy()
    u, v = rng.random(n), rng.random((2, n))
    drawn = lobes_of(metal, wi).sampled(mi.Float(u.astype(np.float32)), mi.Point2f(v.astype(np.float32)))
    x, y, z = (np.array(a) for a in (drawn.x, drawn.y, drawn.z))
    # Cells even in cos and azimuth, so a cell's solid angle is the same everywhere.
    row, column = (z * rows).astype(int), ((np.arctan2(y, x) / (2 * np.pi) + 0.5) * columns).astype(int) % columns
    above = z > 0
    counts = np.bincount(np.minimum(row, rows - 1)[above] * columns + column[above], minlength=rows * columns)
    cos = (np.arange(rows * fine) + 0.5) / (rows * fine)
    azimuth = ((np.arange(columns * fine) + 0.5) / (columns * fine) - 0.5) * 2 * np.pi
    c, a = np.meshgrid(cos, azimuth, indexing="ij")
    s = np.sqrt(1 - c**2)
    wo = np.stack([s * np.cos(a), s * np.sin(a), c]).reshape(3, -1).astype(np.float32)
    _, pdf = lobes_of(metal, np.repeat(wi[:, :1], wo.shape[1], axis=1)).towards(mi.Vector3f(wo), mi.Bool(True), (0,))
    blocks = pdf.numpy().reshape(rows, fine, columns, fine).astype(float)
    expected = n * blocks.mean(axis=(1, 3)).ravel() * 2 * np.pi / (rows * columns)
    kept = expected > 5
    statistic = np.sum((counts[kept] - expected[kept]) ** 2 / expected[kept])
    rest = counts[~kept].sum() - expected[~kept].sum()
    assert abs(rest) < 5 * np.sqrt(max(expected[~kept].sum(), 1)) + 5
    assert statistic < chi2.ppf(0.999, np.count_nonzero(kept) - 1)


@pytest.mark.parametrize("metal", METALS[1:], ids=lambda m: m.name)
def test_lobes_are_reciprocal(metal):
    """f(i, o) = f(o, i) (Helmholtz)."""
    mi = backend.mitsuba()
    rng = np.random.default_rng(4)
    a, b = upper(rng), upper(rng)
    values = [
        lobes_of(metal, i).towards(mi.Vector3f(o), mi.Bool(True), (0,))[0][0].numpy() / o[2]
        for i, o in ((a, b), (b, a))
    ]
    np.testing.assert_allclose(values[0], values[1], rtol=5e-3, atol=1e-5)
