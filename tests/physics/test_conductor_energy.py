"""The rough conductor keeps the energy that the one-bounce model loses."""

import pytest

from materials.material import RoughConductor
from render.light.sampling import Sampling
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
