"""Where steel becomes rough enough for stereo: the bend of the unusable share lies near B / (2 Z), at two distances."""

import numpy as np
import pytest

from franbv.frames import look_at
from materials.material import RoughConductor
from render.d435i import SensorSettings, SimulatedD435i
from render.labels.outcome import burst_outcome
from render.light.sampling import Sampling
from scenes.build import coupon_scene
from scenes.coupons import plate_centre_height
from tests.physics.test_holes_on_steel import STEEL

ALPHAS = (0.01, 0.02, 0.035, 0.05, 0.07, 0.1, 0.14, 0.2, 0.3)
BASELINE = 0.05
FACTOR = 2.0
"""The half-vector argument tells the place of the bend to no more than this."""


def unusable_share(alpha: float, distance: float) -> float:
    """Share of the facing pixels of a plate, seen straight from above, that have no depth or a false one.

    Facing: view rays within B / (2 Z) of the axis: there the half-vectors of projector and imagers lie within about
    B / (2 Z) of the normal.
    """
    scene = coupon_scene("plate", RoughConductor(f"steel {alpha}", alpha_u=alpha, alpha_v=alpha, **STEEL))
    middle = np.array([0.0, 0.0, plate_centre_height(0.1)])
    pose = look_at(middle + np.array([0.0, 0.0, distance]), middle, -np.array([np.cos(0.35), np.sin(0.35), 0.0]))
    camera = SimulatedD435i(scene, SensorSettings(), 2, Sampling(glossy_paths=32, refined_share=0.0))
    outcome = burst_outcome(camera, camera.measure(pose, 3), camera.truth(pose))
    f, cx, cy = 321.0, 319.5, 179.5
    v, u = np.mgrid[:360, :640]
    facing = np.hypot((u - cx) / f, (v - cy) / f) < BASELINE / (2 * distance)
    return float(np.mean((outcome.invalid | outcome.is_false)[facing]))


@pytest.mark.slow
@pytest.mark.parametrize("distance", [0.3, 0.5])
def test_share_bends_where_the_half_vectors_part(distance: float):
    """Half-vectors of the two imagers differ by B / (2 Z). A lobe much narrower shows its highlight to one imager or at
    two places, a much wider one looks alike to both: the share falls to half of its peak within a factor of two of it,
    is large well below and gone well above."""
    theory = BASELINE / (2 * distance)
    shares = np.array([unusable_share(alpha, distance) for alpha in ALPHAS])
    peak = shares.max()
    last = int(np.flatnonzero(shares >= peak / 2)[-1])
    assert last + 1 < len(ALPHAS)
    along = (shares[last] - peak / 2) / (shares[last] - shares[last + 1])
    bend = ALPHAS[last] * (ALPHAS[last + 1] / ALPHAS[last]) ** along
    assert theory / FACTOR <= bend <= theory * FACTOR
    assert peak > 0.25
    assert shares[-1] < 0.05
