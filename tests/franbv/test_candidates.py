"""Candidate poses: radius, aim, polar angles and spread against their closed forms."""

import numpy as np
import pytest

from franbv.candidates import candidate_poses, first_view, ring_counts
from franbv.frames import look_at
from franbv.geometry.oriented_box import axis_aligned_box
from franbv.parameters import Parameters

PARAMETERS = Parameters()
BOX = axis_aligned_box(np.array([0.0, 0.0, 0.0]), np.array([0.06, 0.08, 0.24]))  # half diagonal 0.13, centre at z 0.12


def test_candidates_stand_on_the_hemisphere_and_look_at_its_centre():
    """32 poses at gamma + half diagonal = 0.33 m from the centre, optical axis through it, polar 20, 40, 60, 80 deg."""
    poses = candidate_poses(BOX, PARAMETERS, 0.3)
    offset = np.array([T.translation for T in poses]) - BOX.centre
    assert len(poses) == 32
    np.testing.assert_allclose(np.linalg.norm(offset, axis=1), 0.33)
    axes = np.array([T.rotation.as_matrix()[:, 2] for T in poses])
    np.testing.assert_allclose(axes, -offset / 0.33, atol=1e-12)
    polar = np.degrees(np.arccos(offset[:, 2] / 0.33))
    np.testing.assert_allclose(np.unique(np.round(polar, 6)), [20, 40, 60, 80])


def test_poses_are_those_of_look_at():
    """Built all at once, each pose equals the one that `look_at` builds alone: image y axis down, world z up."""
    aimed = [(T, BOX.centre) for T in candidate_poses(BOX, PARAMETERS, 0.3)[::5]]
    for T, centre in [*aimed, (first_view(PARAMETERS, 77.0), np.array([0.0, 0.0, 0.06]))]:
        np.testing.assert_allclose(T.as_matrix(), look_at(T.translation, centre).as_matrix(), atol=1e-12)


def test_ring_counts_follow_ring_length():
    """sin(20, 40, 60, 80 deg) shares 32 as 3.86, 7.25, 9.77, 11.11; largest remainders give 4, 7, 10, 11."""
    np.testing.assert_array_equal(ring_counts(np.sin(np.radians([20, 40, 60, 80])), 32), [4, 7, 10, 11])
    assert ring_counts(np.array([1.0, 1.0, 1.0]), 2).sum() == 2


def test_azimuth_offset_turns_all_candidates():
    """Turning by alpha about the vertical through the centre maps the candidates for 0 onto those for alpha."""
    alpha = 0.7
    turn = np.array([[np.cos(alpha), -np.sin(alpha), 0], [np.sin(alpha), np.cos(alpha), 0], [0, 0, 1]])
    plain = np.array([T.translation for T in candidate_poses(BOX, PARAMETERS, 0.0)]) - BOX.centre
    turned = np.array([T.translation for T in candidate_poses(BOX, PARAMETERS, alpha)]) - BOX.centre
    np.testing.assert_allclose(turned, plain @ turn.T, atol=1e-12)


@pytest.mark.parametrize("azimuth", [0.0, 90.0, 215.0])
def test_first_view_stands_at_45_degrees(azimuth):
    """Elevation 45 deg and the given azimuth about the prior box's centre, at gamma + its half diagonal."""
    offset = first_view(PARAMETERS, azimuth).translation - [0, 0, 0.06]
    assert np.linalg.norm(offset) == pytest.approx(0.2 + np.sqrt(0.1**2 + 0.1**2 + 0.06**2))
    assert np.degrees(np.arcsin(offset[2] / np.linalg.norm(offset))) == pytest.approx(45.0)
    assert np.degrees(np.arctan2(offset[1], offset[0])) % 360 == pytest.approx(azimuth)


def test_poses_carry_the_roll():
    """Turned by phi clockwise about its own axis a camera looks the same way from the same place; its x axis has turned
    towards its old y axis: x cos phi + y sin phi. At 90 deg the image's left border looks up."""
    phi = np.radians(35.0)
    for roll, cosine, sine in ((35.0, np.cos(phi), np.sin(phi)), (90.0, 0.0, 1.0)):
        turned = Parameters(roll_deg=roll)
        pairs = [*zip(candidate_poses(BOX, PARAMETERS, 0.3), candidate_poses(BOX, turned, 0.3), strict=True)]
        pairs.append((first_view(PARAMETERS, 20.0), first_view(turned, 20.0)))
        for upright, rolled in pairs:
            x, y, z = upright.rotation.as_matrix().T
            np.testing.assert_allclose(rolled.translation, upright.translation)
            np.testing.assert_allclose(rolled.rotation.as_matrix()[:, 2], z, atol=1e-12)
            np.testing.assert_allclose(rolled.rotation.as_matrix()[:, 0], cosine * x + sine * y, atol=1e-12)
    assert -rolled.rotation.as_matrix()[2, 0] > 0
