"""Poses of `franbv frame`: whatever spells them, the mount's roll is in them."""

import numpy as np
import pytest

from scenes.build import part_scene
from studies.base.pose_text import camera_pose


@pytest.mark.parametrize("text", [None, "30,40,0.5", "eye:0.3,0.2,0.4"])
def test_poses_carry_the_roll(text):
    """From the same place along the same axis, at 90 deg with the image's x axis where its y axis was."""
    scene = part_scene("A1")
    upright, on_end = camera_pose(text, scene), camera_pose(text, scene, 90.0)
    np.testing.assert_allclose(on_end.translation, upright.translation)
    turned = upright.rotation.as_matrix() @ np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    np.testing.assert_allclose(on_end.rotation.as_matrix(), turned, atol=1e-12)
