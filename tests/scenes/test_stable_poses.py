"""How parts can lie: boxes on their faces, by solid angle; balls nowhere; what would tip over is left out."""

import numpy as np
import pytest

from scenes.primitives import box, cylinder, sphere
from scenes.scene import Mesh
from scenes.stable_poses import centre_of_mass, inside_by, stable_poses

SOLID_ANGLE_ERROR = 1e-9


def test_a_cube_lies_on_each_face_alike():
    """Six faces see the same solid angle, so the chances are 1/6 each."""
    poses = stable_poses(box((0.05, 0.05, 0.05)))
    assert [pose.chance for pose in poses] == pytest.approx([1 / 6] * 6, abs=SOLID_ANGLE_ERROR)


def test_chances_of_a_slab_follow_its_solid_angles():
    """A rectangle a x b seen from height d above its middle: 4 asin(ab / sqrt((a^2 + 4 d^2)(b^2 + 4 d^2))) of 4 pi."""
    a, b, c = 0.10, 0.06, 0.04
    faces = [(a, b, c), (a, c, b), (b, c, a)]
    expected = [
        np.arcsin(x * y / np.sqrt((x**2 + z**2) * (y**2 + z**2))) / np.pi for x, y, z in faces for _ in range(2)
    ]
    assert [pose.chance for pose in stable_poses(box((a, b, c)))] == pytest.approx(sorted(expected, reverse=True))


@pytest.mark.parametrize("face", range(6))
def test_the_face_points_down(face: int):
    """After the turn the lowest four corners of a box are level."""
    mesh = box((0.10, 0.06, 0.04))
    heights = np.unique(stable_poses(mesh)[face].rotation.apply(mesh.vertices)[:, 2].round(9))
    assert len(heights) == 2


def test_round_things_roll():
    """A ball has no face; a cylinder stands on its two ends and does not lie on its side."""
    assert len(stable_poses(cylinder(0.03, 0.05))) == 2
    assert stable_poses(sphere(0.03, 48)) == ()


def test_a_slanted_prism_does_not_stand_on_its_short_end():
    """Its centre of mass is beside that end: sheared by twice its width, the middle is a whole width aside."""
    mesh = box((0.03, 0.03, 0.06))
    sheared = mesh.vertices + mesh.vertices[:, [2, 0, 1]] * [1.0, 0, 0]  # x += z
    poses = stable_poses(Mesh(sheared, mesh.faces))
    lows = []
    for pose in poses:
        points = pose.rotation.apply(sheared)
        bottom = points[points[:, 2] < points[:, 2].min() + 1e-9]
        assert inside_by(bottom[:, :2], pose.rotation.apply(centre_of_mass(mesh))[:2]) > 0
        lows.append(np.ptp(points[:, 2]))
    assert min(lows) < 0.06 * np.cos(np.pi / 4) + 1e-9  # it lies on its slanted side


def test_centre_of_mass_of_a_solid_and_of_an_open_shell():
    """A box off the origin: its middle, by the divergence theorem; without a side: the middle of its hull."""
    mesh = box((0.1, 0.06, 0.04))
    offset = np.array([0.3, -0.2, 0.1])
    assert centre_of_mass(Mesh(mesh.vertices + offset, mesh.faces)) == pytest.approx(offset)
    lid = Mesh(mesh.vertices + offset, mesh.faces[:4])  # top and bottom only
    assert np.abs(centre_of_mass(lid) - offset).max() < 1e-9


def test_inside_by_is_the_distance_from_the_rim():
    """Of a square of side 2: 1 in its middle, 0.25 near a side, negative outside; a line carries nothing."""
    square = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    assert inside_by(square, np.zeros(2)) == pytest.approx(1)
    assert inside_by(square, np.array([0.75, 0])) == pytest.approx(0.25)
    assert inside_by(square, np.array([1.5, 0])) == pytest.approx(-0.5)
    assert inside_by(square[[0, 0, 2]], np.zeros(2)) == -np.inf
