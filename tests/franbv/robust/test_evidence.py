"""The mixture against integrals, and the map on mirrors that are made by hand."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import beta

from franbv.frames import look_at, rolled
from franbv.parameters import Parameters
from franbv.robust.evidence import (
    EvidenceMap,
    Tally,
    incidence_range,
    integrate_robustly,
    occupancy,
    surface_normals,
    with_scans,
)
from franbv.robust.settings import RobustSettings
from franbv.voxel_map import empty_map
from tests.franbv.analytic_camera import AnalyticCamera
from tests.franbv.robust.mirror_camera import BOX, MirrorCamera

SETTINGS, PARAMETERS = RobustSettings(), Parameters(n_frames=1)


@pytest.mark.parametrize(("hits", "passes"), [(1, 0), (1, 4), (0, 1), (0.3, 1), (2, 12), (3, 20), (0, 15), (1.3, 2.6)])
def test_log_odds_are_the_integral_over_the_rate(hits: float, passes: float):
    """Numerically, over the rate at which a surface lets rays pass, mirrors and others."""
    m, b, q = SETTINGS.mirrors, SETTINGS.passing, SETTINGS.false_hit

    def likelihood(rate: float) -> float:
        prior = (1 - m) * beta(1, b).pdf(rate) + m
        return prior * rate**passes * (1 - rate) ** hits

    occupied = quad(likelihood, 0, 1, epsabs=0, epsrel=1e-9, limit=200)[0]
    expected = np.log(occupied) - hits * np.log(q) - passes * np.log(1 - q)
    found = occupancy(Tally(np.array([[[hits]]], np.float32), np.array([[[passes]]], np.float32)), SETTINGS)
    assert found[0, 0, 0] == pytest.approx(expected, abs=2e-3)


def test_who_outweighs_whom():
    """One view is not undone by one contradiction, nor two by a dozen; a lone one is given up in the end."""
    hits, passes = np.array([[[1, 2, 1, 0]]], np.float32), np.array([[[1, 12, 40, 1]]], np.float32)
    np.testing.assert_array_equal(occupancy(Tally(hits, passes), SETTINGS) > 0, [[[True, True, False, False]]])
    assert occupancy(Tally(hits * 0, passes * 0), SETTINGS).max() == 0


def test_normals_of_a_plane():
    """A tilted sheet of voxels; nothing off it, and nothing without one."""
    x, _, z = np.meshgrid(*(np.arange(24.0),) * 3, indexing="ij")
    normal = np.array([0.6, 0.0, 0.8])
    sheet = np.abs(normal[0] * x + normal[2] * z - 16) < 0.6
    found = surface_normals(sheet, sheet)
    inner = sheet.copy()
    inner[[0, 1, 2, -3, -2, -1]] = inner[:, [0, 1, 2, -3, -2, -1]] = inner[:, :, [0, 1, 2, -3, -2, -1]] = False
    assert np.abs(found[inner] @ normal).min() > np.cos(np.radians(10))
    assert not found[~sheet].any()
    assert not surface_normals(np.zeros_like(sheet), sheet).any()


def test_ranges_of_incidence():
    """By angle; grazing counts to the last."""
    angles = np.radians([0.0, 14.9, 15.1, 44.0, 59.0, 61.0, 90.0])
    np.testing.assert_array_equal(incidence_range(np.cos(angles)), [0, 0, 1, 2, 3, 4, 4])


def views_of(camera: AnalyticCamera, eyes: list[tuple[float, float, float]], roll: float) -> EvidenceMap:
    """The map of these views of the box's middle."""
    voxel_map = empty_map(PARAMETERS)
    for eye in eyes:
        burst = camera.capture(rolled(look_at(np.array(eye), np.array([0, 0, 0.04])), roll), 1)
        voxel_map = integrate_robustly(voxel_map, burst, PARAMETERS, SETTINGS)
    assert isinstance(voxel_map, EvidenceMap)
    return voxel_map


def on_the_mirror(voxel_map: EvidenceMap) -> np.ndarray:
    """What the map holds of points well inside the mirroring side."""
    x, z = np.meshgrid(np.linspace(-0.03, 0.03, 9), np.linspace(0.02, 0.06, 6))
    points = np.stack([x.ravel(), np.full(x.size, BOX[1][1]), z.ravel()], axis=1)
    index, inside = voxel_map.indices(points)
    assert inside.all()
    near = [
        voxel_map.log_odds[tuple((index + np.array([0, dy, 0])).T)] for dy in (-1, 0)
    ]  # the side runs between two layers
    return np.maximum(*near)


def test_two_views_face_on_outlast_a_dozen_through_a_mirror():
    """Views that look through the side carve it; two that measure it bring it back, and say who failed."""
    oblique = [(x, 0.3, 0.12) for x in np.linspace(-0.35, 0.35, 12) if abs(x) > 0.12]
    through = views_of(MirrorCamera(), oblique, 90.0)
    assert (on_the_mirror(through) < 0).mean() > 0.5
    both = views_of(MirrorCamera(), [*oblique, (0.0, 0.3, 0.06), (0.03, 0.3, 0.06)], 90.0)
    assert (on_the_mirror(both) > 0).mean() > 0.9
    assert both.failures[1, 1:].sum() > 50
    assert both.failures[1, 0] < 0.2 * both.successes[1, 0]


def test_a_map_without_scans():
    """It is an empty one, and has all that can be asked."""
    plain = empty_map(PARAMETERS)
    empty = with_scans(plain)
    assert empty.scans == ()
    assert empty.normals.shape == (*plain.log_odds.shape, 3)
    assert with_scans(empty) is empty
