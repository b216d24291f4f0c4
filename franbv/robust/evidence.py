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

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float, Float32
from scipy.ndimage import uniform_filter
from scipy.special import betaln

from franbv.parameters import Parameters
from franbv.robust.rays import add_evidence, cells_of, first_surfaces
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
TRUST_STEPS = 100
"""Steps in which hits and passes are told apart, of one whole hit (choice: finer than any trust is known)."""
LOG_ODDS_LIMIT = 30.0
"""Of a voxel, either way [-] (choice: beyond what single precision needs to tell apart)."""


@dataclass(frozen=True, eq=False)
class EvidenceMap(VoxelMap):
    """The map, with the scans that it was made of: they are weighed anew with every burst."""

    scans: tuple[Scan, ...] = ()
    normals: Float32[np.ndarray, "x y z 3"] = field(default_factory=lambda: np.zeros((0, 0, 0, 3), np.float32))
    """Of confirmed surface, 0 elsewhere."""
    successes: Float[np.ndarray, "2 b"] = field(default_factory=lambda: np.zeros((N_TURNS, len(INCIDENCE_DEG) - 1)))
    """Pixels that measured confirmed surface, by turn of the camera and range of incidence."""
    failures: Float[np.ndarray, "2 b"] = field(default_factory=lambda: np.zeros((N_TURNS, len(INCIDENCE_DEG) - 1)))
    """Pixels that looked at it and saw nothing or something behind it."""


def integrate_robustly(
    voxel_map: VoxelMap, burst: DepthBurst, parameters: Parameters, settings: RobustSettings
) -> EvidenceMap:
    """The map with the burst in it. A map without scans is taken for an empty one."""
    scans = voxel_map.scans if isinstance(voxel_map, EvidenceMap) else ()
    return weighed(voxel_map, (*scans, scan_of(burst, parameters, settings)), settings)


def weighed(grid: VoxelMap, scans: tuple[Scan, ...], settings: RobustSettings) -> EvidenceMap:
    """The map of these scans, in rounds of finding surface and taking back what contradicts it."""
    shape = grid.log_odds.shape
    surfaces = [np.full(scan.depth.size, np.inf) for scan in scans]
    cosines = [np.zeros(scan.depth.size) for scan in scans]
    tolerance = settings.contradiction_voxels * grid.voxel_size
    hits = passes = np.zeros(shape, np.float32)
    normals, log_odds = np.zeros((*shape, 3), np.float32), np.zeros(shape, np.float32)
    for _ in range(settings.passes):
        hits, passes = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
        for scan, surface in zip(scans, surfaces, strict=True):
            behind = scan.lengths > surface + tolerance
            ends = np.where(behind, 0.0, scan.lengths)
            crossed = np.where(behind, surface - tolerance, scan.lengths)
            origin, directions = _in_cells(grid, scan)
            add_evidence(shape, origin, directions, ends, crossed, scan.trust.ravel(), hits, passes)
        log_odds = occupancy(hits, passes, settings)
        confirmed = (hits >= settings.confirmed_hits) & (log_odds > 0)
        normals = surface_normals(confirmed, hits > 0)
        for number, scan in enumerate(scans):
            origin, directions = _in_cells(grid, scan)
            origins, reach = np.tile(origin, (len(directions), 1)), np.full(len(directions), np.inf)
            surfaces[number], cosines[number] = first_surfaces(
                shape, origins, directions, normals, settings.least_cosine, reach
            )
    successes, failures = _trials(scans, surfaces, cosines, tolerance)
    touched = (hits > 0) | (passes > 0)
    level = touched & (log_odds == 0)
    return EvidenceMap(
        first=grid.first,
        voxel_size=grid.voxel_size,
        log_odds=log_odds,
        cancelled=level if level.any() else None,
        threshold=grid.threshold,
        scans=scans,
        normals=normals,
        successes=successes,
        failures=failures,
    )


def occupancy(
    hits: Float32[np.ndarray, "x y z"], passes: Float32[np.ndarray, "x y z"], settings: RobustSettings
) -> Float32[np.ndarray, "x y z"]:
    """L of each voxel by the formula at the head of the module; 0 where nothing was seen."""
    log_odds = np.zeros(hits.shape, np.float32)
    seen = (hits > 0) | (passes > 0)
    steps = np.rint(TRUST_STEPS * np.stack([hits[seen], passes[seen]])).astype(np.int64)
    pairs, back = np.unique(steps[0] << 32 | steps[1], return_inverse=True)  # few, so that the formula is asked seldom
    h, k = (pairs >> 32) / TRUST_STEPS, (pairs & 0xFFFFFFFF) / TRUST_STEPS
    m, b, q = settings.mirrors, settings.passing, settings.false_hit
    plain = np.log1p(-m) + betaln(1 + k, b + h) - betaln(1, b)
    mirror = np.log(m) + betaln(1 + k, 1 + h)
    found = np.logaddexp(plain, mirror) - h * np.log(q) - k * np.log1p(-q)
    log_odds[seen] = np.clip(found, -LOG_ODDS_LIMIT, LOG_ODDS_LIMIT).astype(np.float32)[back]
    return log_odds


def surface_normals(
    confirmed: Bool[np.ndarray, "x y z"], support: Bool[np.ndarray, "x y z"]
) -> Float32[np.ndarray, "x y z 3"]:
    """Unit normals of the confirmed voxels, either way: the least axis of the support around each; 0 elsewhere."""
    normals = np.zeros((*confirmed.shape, 3), np.float32)
    near = extent(confirmed, margin=WINDOW // 2)
    inside, mask = confirmed[near], support[near].astype(float)
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
    scans: tuple[Scan, ...],
    surfaces: list[Float[np.ndarray, "n"]],
    cosines: list[Float[np.ndarray, "n"]],
    tolerance: float,
) -> tuple[Float[np.ndarray, "2 b"], Float[np.ndarray, "2 b"]]:
    """Pixels that measured confirmed surface, and that failed to. What ends before it says nothing: it is hidden."""
    shape = (N_TURNS, len(INCIDENCE_DEG) - 1)
    successes, failures = np.zeros(shape), np.zeros(shape)
    for scan, surface, cosine in zip(scans, surfaces, cosines, strict=True):
        expected = np.isfinite(surface)
        which = incidence_range(cosine)
        right = expected & (np.abs(scan.lengths - surface) <= tolerance)
        wrong = expected & ((scan.lengths == 0) | (scan.lengths > surface + tolerance))
        for counts, pixels in ((successes, right), (failures, wrong)):
            counts[scan.turn] += np.bincount(which[pixels], minlength=shape[1])
    return successes, failures


def incidence_range(cosine: Float[np.ndarray, "n"]) -> np.ndarray:
    """Number of the range of INCIDENCE_DEG that each cosine lies in."""
    angle = np.degrees(np.arccos(np.clip(cosine, 0.0, 1.0)))
    return np.clip(np.searchsorted(INCIDENCE_DEG, angle, side="right") - 1, 0, len(INCIDENCE_DEG) - 2)


def with_scans(grid: VoxelMap) -> EvidenceMap:
    """Any map as one that can be asked what an evidence map can: its surface is known, its scans are not."""
    if isinstance(grid, EvidenceMap):
        return grid
    known = {name: getattr(grid, name) for name in ("first", "voxel_size", "log_odds", "cancelled", "threshold")}
    return EvidenceMap(**known, normals=surface_normals(grid.occupied, grid.occupied))
