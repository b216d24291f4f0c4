"""The rough conductor keeps the energy that the one-bounce model loses."""

import numpy as np
import pytest

from materials.material import Matte, RoughConductor
from render.light.sampling import Sampling
from render.world import backend
from render.world.bsdf import bsdf_description
from scenes.scene import Scene
from tests.physics.simple_scenes import wall
from tests.physics.test_radiance_laws import layers_of

PERFECT = {"n": 0.01, "k": 20.0}
"""Index of a metal that reflects all but R0 = 1 - 4 n / ((n + 1)^2 + k^2) = 0.9999."""


@pytest.mark.parametrize(("alpha_u", "alpha_v"), [(0.1, 0.1), (0.3, 0.3), (0.5, 0.5), (0.08, 0.25)])
def test_perfect_rough_metal_vanishes_in_a_furnace(alpha_u, alpha_v):
    """A metal without absorption under constant radiance 1 shows 1 whatever its roughness (white furnace test), where
    the one-bounce model shows 0.98, 0.86 and 0.68 at alpha 0.1, 0.3 and 0.5. Tolerance: the table's 0.002 and
    sampling."""
    metal = RoughConductor("perfect", **PERFECT, alpha_u=alpha_u, alpha_v=alpha_v)
    scene = Scene("furnace", wall(0.5, metal).bodies, (), 1.0)
    image = layers_of(scene, Sampling(max_depth=1, glossy_paths=256)).ambient
    assert image.mean() == pytest.approx(1.0, abs=0.01)


def test_sampling_agrees_with_density():
    """Of N sampled directions, as many fall into each octant-and-ring of the hemisphere as the density's integral says:
    chi-square by Mitsuba's own test of the BSDF."""
    backend.mitsuba()
    from mitsuba.chi2 import ChiSquareTest, SphericalDomain

    description = bsdf_description(RoughConductor("steel", 3.249, 4.905, 0.3, 0.5))
    sample, pdf = _adapter(description)
    test = ChiSquareTest(domain=SphericalDomain(), sample_func=sample, pdf_func=pdf, sample_dim=3, res=51, ires=8)
    assert test.run()


def _adapter(description):
    """Sampling and density functions of the BSDF for a view at 50 deg, in the form that `ChiSquareTest` takes."""
    mi = backend.mitsuba()
    import drjit as dr

    bsdf = mi.load_dict(description)
    theta = np.radians(50)
    view = mi.Vector3f(float(np.sin(theta)), 0.0, float(np.cos(theta)))

    def interaction(n):
        si = dr.zeros(mi.SurfaceInteraction3f, n)
        si.wi = dr.normalize(view + dr.zeros(mi.Vector3f, n))
        return si

    def sample(points):
        bs, weight = bsdf.sample(
            mi.BSDFContext(), interaction(dr.width(points)), points.x, mi.Point2f(points.y, points.z)
        )
        return bs.wo, dr.select(weight.x > 0, 1.0, 0.0)

    return sample, lambda wo: bsdf.pdf(mi.BSDFContext(), interaction(dr.width(wo)), wo)


def test_compensation_is_reciprocal():
    """f(i, o) = f(o, i) for directions drawn at random (Helmholtz)."""
    mi = backend.mitsuba()
    import drjit as dr

    bsdf = mi.load_dict(bsdf_description(RoughConductor("steel", 3.249, 4.905, 0.2, 0.5)))
    rng = np.random.default_rng(3)
    a, b = (mi.warp.square_to_uniform_hemisphere(mi.Point2f(rng.random((2, 500)).astype(np.float32))) for _ in range(2))
    values = []
    for i, o in ((a, b), (b, a)):
        si = dr.zeros(mi.SurfaceInteraction3f, 500)
        si.wi = i
        values.append((bsdf.eval(mi.BSDFContext(), si, o).x / o.z).numpy())
    np.testing.assert_allclose(values[0], values[1], rtol=2e-3, atol=1e-5)


def test_smooth_metal_stays_mitsubas_own():
    """A polished metal loses under 1 % between its facets and needs no second lobe."""
    assert bsdf_description(RoughConductor("steel", 3.249, 4.905, 0.03, 0.03))["type"] == "roughconductor"
    assert bsdf_description(Matte("matte", 0.5))["type"] == "diffuse"
