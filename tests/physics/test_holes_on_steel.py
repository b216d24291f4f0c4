"""Where depth goes missing on steel coupons: more, the smoother the metal; hardly any on matte ones."""

import numpy as np
import pytest

from franbv.frames import look_at
from materials.material import Matte, RoughConductor
from render.d435i import SensorSettings, SimulatedD435i
from scenes.build import coupon_scene

STEEL = {"n": 3.249, "k": 4.905}
"""Austenitic stainless steel at 850 nm (Karlsson and Ribbing 1982)."""
DISTANCE = 0.3
"""Of the camera from the coupon's middle [m]: that of a next best view."""
EDGE_PX = 6
"""Margin inside the coupon that is left out: holes there may come from the silhouette."""


def hole_share(coupon: str, material, elevation_deg: float) -> float:
    """Share of pixels without depth inside the coupon, away from its silhouette and visible to both imagers."""
    import cv2

    scene = coupon_scene(coupon, material)
    camera = SimulatedD435i(scene, SensorSettings(crop=None), seed=3)
    vertices = scene.part_mesh().vertices
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    elevation = np.radians(elevation_deg)
    pose = look_at(centre + DISTANCE * np.array([np.cos(elevation), 0, np.sin(elevation)]), centre)
    truth = camera.truth(pose)
    part = [i for i, body in enumerate(scene.bodies) if body.is_part]
    inside = np.isin(truth.body, part) & truth.visible_from_right
    inside = cv2.erode(inside.astype(np.uint8), np.ones((2 * EDGE_PX + 1,) * 2)) > 0
    assert inside.sum() > 500
    return float(np.mean(camera.measure(pose, 3).z16[:, inside] == 0))


@pytest.mark.parametrize("coupon", ["plate", "ball"])
def test_matte_coupon_has_no_holes(coupon):
    """A matte surface inside range, lit and seen by both imagers, gives depth: under 1 % holes."""
    assert hole_share(coupon, Matte("matte", 0.5), 55) < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("coupon", ["plate", "inside_corner"])
def test_holes_vanish_with_roughness(coupon):
    """Rougher steel sends light to both imagers from everywhere: the hole share falls from alpha 0.03 to 0.4, over
    views at three elevations (a single view may miss every highlight). Convex coupons are left out: they show the
    matcher a small sharp mirror image, which it takes for a surface, and so give false depth instead of holes
    (`test_false_depth`)."""
    shares = [
        np.mean([hole_share(coupon, RoughConductor("steel", **STEEL, alpha_u=a, alpha_v=a), e) for e in (35, 55, 75)])
        for a in (0.03, 0.1, 0.2, 0.4)
    ]
    assert shares[0] > 0.1
    assert shares[0] > shares[2] > shares[3]
    assert shares[1] > shares[3]
