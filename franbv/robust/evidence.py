"""A map that false depth cannot undo: hits and passes counted view by view, weighed by a mixture with mirrors in it.

A surface may let rays pass: a mirror shows what lies behind it. At what rate is not known and differs from place to
place, so it is integrated out. With h hits and k passes at a voxel

    L = ln [ (1 - m) B(1 + k, b + h) / B(1, b) + m B(1 + k, 1 + h) ] - h ln q - k ln (1 - q),

where m is the prior share of mirrors, Beta(1, b) the rate elsewhere and q the chance of a false hit (the beta-binomial
of e.g. Gelman et al., Bayesian Data Analysis, section 2.4; counts of hits and passes by themselves go back to Hähnel et
al., IROS 2003). One hit outlives a handful of passes, two agreeing views dozens of them, and a lone hit that many
views contradict is given up.

Once surface is confirmed, rays that end behind it without having grazed it are mirror images: their ends are taken
back, and so is what they passed behind the surface (an expectation step with hard decisions; Ulusoy, Geiger and Black,
3DV 2015, have the soft one). What they passed before it stays passed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Float32, Int
from scipy.ndimage import uniform_filter
from scipy.special import betaln

from franbv.parameters import Parameters
from franbv.robust.rays import SurfaceGrid, add_evidence, cells_of, first_surfaces
from franbv.robust.scans import Scan, scan_of
from franbv.robust.settings import RobustSettings
from franbv.sensing import DepthBurst
from franbv.voxel_map import VoxelMap, extent

INCIDENCE_DEG = (0.0, 15.0, 30.0, 45.0, 60.0, 90.0)
"""Edges of the ranges of incidence in which success is counted [deg] (choice: mirrors fail beyond 15 to 20)."""
N_TURNS = 2
"""Upright and on end."""
WINDOW = 5
"""Side of the neighbourhood that a normal is found in [voxels] (choice: the smallest that averages the steps of a
slanted plane)."""
TRUST_STEPS = 20
"""Steps in which hits and passes are told apart, of one whole hit (choice: finer than any trust is known)."""
LOG_ODDS_LIMIT = 30.0
"""Of a voxel, either way [-] (choice: beyond what single precision needs to tell apart)."""


class Tally(NamedTuple):
    """What scans say of each voxel."""

    hits: Float32[np.ndarray, "x y z"]
    """Views that have an end of a ray in it, weighted by trust."""
    passes: Float32[np.ndarray, "x y z"]
    """Views that only pass it, likewise."""


@dataclass(frozen=True, eq=False)
class EvidenceMap(VoxelMap):
    """The map, with the scans that it was made of: they are weighed anew with every burst."""

    scans: tuple[Scan, ...] = ()
    normals: Float32[np.ndarray, "x y z 3"] = field(default_factory=lambda: np.zeros((0, 0, 0, 3), np.float32))
    """Of occupied voxels, towards those who saw them; 0 elsewhere."""
    confirmed: Bool[np.ndarray, "x y z"] = field(default_factory=lambda: np.zeros((0, 0, 0), bool))
    """Occupied voxels that several views agree on."""
    points: Float32[np.ndarray, "x y z"] = field(default_factory=lambda: np.zeros((0, 0, 0), np.float32))
    """Depths that ended in each voxel and that nothing contradicts [-]."""
    successes: Float[np.ndarray, "2 b"] = field(default_factory=lambda: np.zeros((N_TURNS, len(INCIDENCE_DEG) - 1)))
    """Pixels that measured confirmed surface of the object, by turn of the camera and range of incidence."""
    failures: Float[np.ndarray, "2 b"] = field(default_factory=lambda: np.zeros((N_TURNS, len(INCIDENCE_DEG) - 1)))
    """Pixels that looked at it and saw nothing or something behind it."""
    believed: Tally | None = None
    """What all scans say as if none of them were contradicted; None = there is no scan."""

    @cached_property
    def surface(self) -> SurfaceGrid:
        """The confirmed surface, for rays."""
        return SurfaceGrid.of(self.normals, self.confirmed)

    def normals_at(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Normal of the voxel that each world point lies in; 0 where that is not occupied, and outside the grid."""
        index, inside = self.indices(points)
        found = np.zeros((len(points), 3))
        found[inside] = self.normals[tuple(index[inside].T)]
        return found


def integrate_robustly(
    voxel_map: VoxelMap, burst: DepthBurst, parameters: Parameters, settings: RobustSettings
) -> EvidenceMap:
    """The map with the burst in it. A map without scans is taken for an empty one.

    All scans are weighed anew, in rounds of finding surface and taking back what contradicts it: what was believed
    before does not bias what is believed now.
    """
    before = voxel_map if isinstance(voxel_map, EvidenceMap) else with_scans(voxel_map)
    scans = (*before.scans, scan_of(burst, parameters, settings))
    ends = [scan.lengths for scan in scans]
    passed = [_passed(scan, voxel_map.voxel_size, settings) for scan in scans]
    believed = _added(voxel_map, scans[-1:], ends[-1:], passed[-1:], before.believed)
    tolerance = settings.contradiction_voxels * voxel_map.voxel_size
    evidence, surfaces, cosines, kept = believed, [], [], ends
    log_odds, normals, confirmed = before.log_odds, before.normals, before.confirmed
    for number in range(settings.passes):
        if number > 0:
            behind = [scan.lengths > surface + tolerance for scan, surface in zip(scans, surfaces, strict=True)]
            crossed = [np.where(b, s - tolerance, e) for b, s, e in zip(behind, surfaces, passed, strict=True)]
            kept = [np.where(b, 0.0, e) for b, e in zip(behind, ends, strict=True)]
            evidence = _added(voxel_map, scans, kept, crossed)
        log_odds = occupancy(evidence, settings)
        normals = surface_normals(log_odds > 0, evidence.hits > 0)
        confirmed = (evidence.hits >= settings.confirmed_hits) & (log_odds > 0)
        surface = SurfaceGrid.of(normals, confirmed)
        surfaces, cosines = _surfaces(voxel_map, scans, surface, settings)
    table = parameters.table_height + parameters.table_clearance
    successes, failures = _trials(scans, surfaces, cosines, tolerance, table)
    points, towards = _points(voxel_map, scans, kept)
    normals *= np.where(np.sum(normals * towards, axis=-1, keepdims=True) < 0, np.float32(-1), np.float32(1))
    level = ((evidence.hits > 0) | (evidence.passes > 0)) & (log_odds == 0)
    return EvidenceMap(
        first=voxel_map.first,
        voxel_size=voxel_map.voxel_size,
        log_odds=log_odds,
        cancelled=level if level.any() else None,
        threshold=voxel_map.threshold,
        scans=scans,
        normals=normals,
        confirmed=confirmed,
        points=points,
        successes=successes,
        failures=failures,
        believed=believed,
    )


def _passed(scan: Scan, voxel_size: float, settings: RobustSettings) -> Float[np.ndarray, "n"]:
    """Length up to which each ray passes [m]: near its end it may be within the surface's voxels, the longer the more
    it grazes."""
    more = np.minimum(1.0 / np.maximum(scan.cosine.ravel(), 1e-3), settings.spared_voxels) - 1.0
    return np.maximum(scan.lengths - more * voxel_size, 0.0)


def _added(
    grid: VoxelMap,
    scans: Sequence[Scan],
    ends: Sequence[Float[np.ndarray, "n"]],
    crossed: Sequence[Float[np.ndarray, "n"]],
    to: Tally | None = None,
) -> Tally:
    """The evidence of these scans, and of what is there already."""
    shape = grid.log_odds.shape
    blank = np.zeros(shape, np.float32)
    evidence = Tally(to.hits.copy(), to.passes.copy()) if to else Tally(blank, blank.copy())
    for scan, end, cross in zip(scans, ends, crossed, strict=True):
        origin, directions = _in_cells(grid, scan)
        add_evidence(shape, origin, directions, end, cross, scan.trust.ravel(), *evidence)
    return evidence


def _points(
    grid: VoxelMap, scans: Sequence[Scan], kept: Sequence[Float[np.ndarray, "n"]]
) -> tuple[Float32[np.ndarray, "x y z"], Float32[np.ndarray, "x y z 3"]]:
    """How many ends of rays each voxel has, and the sum of the directions towards those who saw them."""
    shape = grid.log_odds.shape
    ends = np.concatenate([s.T_world_cam.translation + k[:, None] * s.rays for s, k in zip(scans, kept, strict=True)])
    rays = np.concatenate([scan.rays for scan in scans])
    index, inside = grid.indices(ends)
    inside &= np.concatenate(kept) > 0
    cell = np.ravel_multi_index(tuple(index[inside].T), shape)
    sums = [np.bincount(cell, weights, math.prod(shape)) for weights in (None, *-rays[inside].T)]
    points, *towards = (np.reshape(part, shape).astype(np.float32) for part in sums)
    return points, np.stack(towards, axis=-1)


def _surfaces(
    grid: VoxelMap, scans: Sequence[Scan], surface: SurfaceGrid, settings: RobustSettings
) -> tuple[list[Float[np.ndarray, "n"]], list[Float[np.ndarray, "n"]]]:
    """Length at which each ray of each scan first meets surface [m], and the cosine there."""
    lengths, cosines = [], []
    for scan in scans:
        origin, directions = _in_cells(grid, scan)
        reach = np.full(len(directions), np.inf)
        origins = np.broadcast_to(origin, directions.shape)
        length, cosine = first_surfaces(surface, origins, directions, settings.least_cosine, reach)
        lengths.append(length)
        cosines.append(cosine)
    return lengths, cosines


def occupancy(evidence: Tally, settings: RobustSettings) -> Float32[np.ndarray, "x y z"]:
    """L of each voxel by the formula at the head of the module; 0 where nothing was seen."""
    log_odds = np.zeros(evidence.hits.shape, np.float32)
    seen = (evidence.hits > 0) | (evidence.passes > 0)
    hits, passes = (np.rint(TRUST_STEPS * array[seen]).astype(np.int64) for array in evidence)
    if hits.size == 0:
        return log_odds
    columns = passes.max() + 1
    cell = hits * columns + passes
    asked = np.zeros((hits.max() + 1) * columns, bool)
    asked[cell] = True
    rows = np.flatnonzero(asked)  # few, so that the formula is asked seldom
    h, k = rows // columns / TRUST_STEPS, rows % columns / TRUST_STEPS
    m, b, q = settings.mirrors, settings.passing, settings.false_hit
    plain = np.log1p(-m) + betaln(1 + k, b + h) - betaln(1, b)
    mirror = np.log(m) + betaln(1 + k, 1 + h)
    found = np.logaddexp(plain, mirror) - h * np.log(q) - k * np.log1p(-q)
    table = np.zeros(asked.size, np.float32)
    table[rows] = np.clip(found, -LOG_ODDS_LIMIT, LOG_ODDS_LIMIT)
    log_odds[seen] = table[cell]
    return log_odds


def surface_normals(
    wanted: Bool[np.ndarray, "x y z"], support: Bool[np.ndarray, "x y z"]
) -> Float32[np.ndarray, "x y z 3"]:
    """Unit normals of some voxels, either way: the least axis of the support around each; 0 elsewhere."""
    normals = np.zeros((*wanted.shape, 3), np.float32)
    near = extent(wanted, margin=WINDOW // 2)
    inside, mask = wanted[near], support[near].astype(float)
    if not inside.any():
        return normals
    place = np.stack(np.meshgrid(*(np.arange(n, dtype=float) for n in mask.shape), indexing="ij"))

    def mean(values: Float[np.ndarray, "x y z"]) -> Float[np.ndarray, "n"]:
        return uniform_filter(values, WINDOW, mode="constant")[inside]

    weight = np.maximum(mean(mask), 1e-9)
    middle = np.stack([mean(mask * axis) / weight for axis in place])
    moments = np.zeros((int(inside.sum()), 3, 3))
    for i in range(3):
        for j in range(i, 3):
            moments[:, i, j] = moments[:, j, i] = mean(mask * place[i] * place[j]) / weight - middle[i] * middle[j]
    found = np.zeros((*inside.shape, 3), np.float32)
    found[inside] = np.linalg.eigh(moments)[1][:, :, 0]
    normals[near] = found
    return normals


def _in_cells(grid: VoxelMap, scan: Scan) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "n 3"]]:
    origin = cells_of(scan.T_world_cam.translation[None], grid.first, grid.voxel_size)[0]
    return origin, scan.rays / grid.voxel_size


def _trials(
    scans: Sequence[Scan],
    surfaces: list[Float[np.ndarray, "n"]],
    cosines: list[Float[np.ndarray, "n"]],
    tolerance: float,
    table: float,
) -> tuple[Float[np.ndarray, "2 b"], Float[np.ndarray, "2 b"]]:
    """Pixels that measured confirmed surface above the table, and that failed to. What ends before it says nothing: it
    is hidden."""
    shape = (N_TURNS, len(INCIDENCE_DEG) - 1)
    successes, failures = np.zeros(shape), np.zeros(shape)
    for scan, surface, cosine in zip(scans, surfaces, cosines, strict=True):
        height = scan.T_world_cam.translation[2] + np.where(np.isfinite(surface), surface, 0.0) * scan.rays[:, 2]
        expected = np.isfinite(surface) & (height > table)
        which = incidence_range(cosine)
        right = expected & (np.abs(scan.lengths - surface) <= tolerance)
        wrong = expected & ((scan.lengths == 0) | (scan.lengths > surface + tolerance))
        for counts, pixels in ((successes, right), (failures, wrong)):
            counts[scan.turn] += np.bincount(which[pixels], minlength=shape[1])
    return successes, failures


def incidence_range(cosine: Float[np.ndarray, "*n"]) -> Int[np.ndarray, "*n"]:
    """Number of the range of INCIDENCE_DEG that each cosine lies in."""
    angle = np.degrees(np.arccos(np.clip(cosine, 0.0, 1.0)))
    return np.clip(np.searchsorted(INCIDENCE_DEG, angle, side="right") - 1, 0, len(INCIDENCE_DEG) - 2)


def with_scans(grid: VoxelMap) -> EvidenceMap:
    """Any map as one that can be asked what an evidence map can: its surface is known, its scans are not."""
    if isinstance(grid, EvidenceMap):
        return grid
    known = {name: getattr(grid, name) for name in ("first", "voxel_size", "log_odds", "cancelled", "threshold")}
    points = grid.occupied.astype(np.float32)
    return EvidenceMap(
        **known, normals=surface_normals(grid.occupied, grid.occupied), confirmed=grid.occupied, points=points
    )
