"""Whether missing or false depth lies on a mirror, or on dull surface that something else kept from being measured.

A highlight that drowns the dots leaves the same hole on matte surface as a mirror does. But matte surface is measured
from aslant, and a mirror hardly is. What is known of that is the run's own record. Surface that faces the same way is
likely to be of one finish, and parts are likely to be of one finish: so of a place count first the views from aslant
that measured surface like it or did not; then that surface like it was measured at all, which is expected to do as the
whole run's does; then the views from aslant that measured the place itself or passed it. Holes at the place itself say
nothing, since they are what is asked about. Each is a number of trials of one beta-binomial (Gelman et al., Bayesian
Data Analysis, 3rd ed. 2013, section 2.4).
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import label
from scipy.spatial.transform import RigidTransform

from franbv.model import Model
from franbv.robust.evidence import INCIDENCE_DEG, EvidenceMap, incidence_range, with_scans
from franbv.robust.hypothesis import visible
from franbv.robust.settings import RobustSettings

ASLANT = INCIDENCE_DEG.index(45.0)
"""Range of incidence that counts as aslant, 45 to 60 deg (choice: beyond what mirrors are measured at, and before what
no matcher holds)."""
ALIKE = 0.9
"""Cosine between normals of surface that faces the same way (choice: 26 deg)."""
MOST_KNOWN = 600
"""Voxels of the map that are asked, evenly among all (choice: of a part of 20 cm every third)."""


class _Looks(NamedTuple):
    """Of places, how many scans saw each from aslant."""

    measured: Float[np.ndarray, "n"]
    passed: Float[np.ndarray, "n"]
    lost: Float[np.ndarray, "n"]
    """Without any depth."""


def measured_aslant(
    model: Model, places: Float[np.ndarray, "n 3"], normals: Float[np.ndarray, "n 3"], settings: RobustSettings
) -> Float[np.ndarray, "n"]:
    """Expected share of views from aslant that measure the surface at each place [0, 1], told from all scans but the
    last. normals: unit, towards the camera."""
    grid = with_scans(model.voxel_map)
    if len(grid.scans) < 2 or not len(places):
        return np.full(len(places), 1.0 / (1.0 + settings.mirror_trials))
    every = max(1, len(model.object.occupied) // MOST_KNOWN)
    known = model.object.occupied[::every]
    facing = grid.normals_at(known)
    looks, trials = _looks_from_aslant(grid, known, facing, settings), every / settings.pixels_per_trial
    successes, failures = trials * looks.measured, trials * (looks.passed + looks.lost)
    of_run = (1.0 + successes.sum()) / (2.0 + successes.sum() + failures.sum())
    alike = (normals @ facing.T > ALIKE).astype(float)
    a = 1.0 + alike @ (successes + trials * of_run)
    b = settings.mirror_trials + alike @ (failures + trials * (1.0 - of_run))
    here = _looks_from_aslant(grid, places, normals, settings)
    return (settings.alike_trials * a / (a + b) + here.measured) / (settings.alike_trials + here.measured + here.passed)


def of_dull_surface(
    pixels: Bool[np.ndarray, "h w"], shares: Float[np.ndarray, "n"], settings: RobustSettings
) -> Bool[np.ndarray, "h w"]:
    """Those of the pixels whose region, of neighbouring ones, lies on dull surface, in the mean of its pixels. shares:
    `measured_aslant` of each pixel, row by row."""
    region = regions_of(pixels)[pixels]
    sums, counts = np.bincount(region, shares), np.bincount(region)
    dull = np.zeros(pixels.shape, bool)
    dull[pixels] = sums[region] > settings.dull * counts[region]
    return dull


def regions_of(pixels: Bool[np.ndarray, "h w"]) -> Int[np.ndarray, "h w"]:
    """Number of the region of neighbouring pixels that each is in, from 1; 0 elsewhere."""
    regions = np.zeros(pixels.shape, int)
    label(pixels, structure=np.ones((3, 3)), output=regions)
    return regions


def _looks_from_aslant(
    grid: EvidenceMap, places: Float[np.ndarray, "n 3"], normals: Float[np.ndarray, "n 3"], settings: RobustSettings
) -> _Looks:
    """Of all scans but the last."""
    scans = grid.scans[:-1]
    views = RigidTransform.concatenate([scan.T_world_cam for scan in scans])
    seen, cosine, distance, pixel = visible(grid, views, scans[0].intrinsics, places, normals, settings)
    lengths = np.stack([scan.lengths[at] for scan, at in zip(scans, pixel, strict=True)])
    aslant = seen & (incidence_range(cosine) == ASLANT)
    tolerance = settings.false_behind_voxels * grid.voxel_size
    outcomes = (np.abs(lengths - distance) < tolerance, lengths > distance + tolerance, lengths == 0)
    return _Looks(*(np.count_nonzero(aslant & outcome, axis=0).astype(float) for outcome in outcomes))
