"""Minimum-volume enclosing ellipsoids by Khachiyan's algorithm with away steps, many sets of points at once.

Every point carries a weight; the covariance of the weighted points, blown up until it holds them all, is the ellipsoid.
Each step moves weight to the point that sticks out most or from the one that matters least (Todd and Yildirim 2007, "On
Khachiyan's algorithm for the computation of minimum-volume enclosing ellipsoids"). Whatever the weights, no enclosing
ellipsoid is smaller than the one of shape 3 * covariance, so every result proves how far it is from the best.
"""

from itertools import product

import numpy as np
from jaxtyping import Float, Int

MAX_STEPS = 10_000
"""Guard against an endless loop; clusters of voxels take about a hundred steps."""
FLAT_VARIANCE = 1e-12
"""Share of the largest variance below which a set counts as flat: a choice, the square of single precision."""
START_DIRECTIONS = np.array([d for d in product((-1.0, 0.0, 1.0), repeat=3) if d > (0.0, 0.0, 0.0)])
"""Towards a cube's faces, edges and corners, one of each opposite pair: the outermost points along them are where the
weights start. Any start would do; from this one, clusters of voxels need the fewest steps."""


def enclosing_ellipsoids(
    points: Float[np.ndarray, "n 3"], labels: Int[np.ndarray, "n"], tolerance: float
) -> tuple[Float[np.ndarray, "k 3"], Float[np.ndarray, "k 3 3"]]:
    """Centres c and shapes S of an ellipsoid (x - c)^T S^-1 (x - c) <= 1 around each labelled set of points.

    labels: 0..k-1, each on at least four points, not all in one plane (else ValueError).
    tolerance: each volume exceeds the smallest possible one by at most this share.
    """
    if len(points) == 0:
        return np.zeros((0, 3)), np.zeros((0, 3, 3))
    sets = _padded(points, labels)
    origins = sets.mean(axis=1)  # (k, 3)
    scales = np.maximum(np.ptp(sets, axis=1).max(axis=1), np.finfo(float).tiny)  # (k,)
    sets = (sets - origins[:, None]) / scales[:, None, None]
    centres, covariances = _moments(sets, _optimal_weights(sets, tolerance))
    offsets = sets - centres[:, None]
    # The smallest blow-up that holds all points; the last one of them then lies on the ellipsoid.
    reach = np.einsum("kmi,kij,kmj->km", offsets, np.linalg.inv(covariances), offsets).max(axis=1)
    shapes = covariances * (reach * scales**2)[:, None, None]
    return centres * scales[:, None] + origins, shapes


def _padded(points, labels):
    """(k, m, 3): the points of each label, filled up with copies of the first one, which change no ellipsoid."""
    counts = np.bincount(labels)
    slots = np.tile(np.arange(counts.max()), (len(counts), 1))  # (k, m)
    slots[slots >= counts[:, None]] = 0
    first = np.cumsum(counts) - counts
    return points[np.argsort(labels, kind="stable")[slots + first[:, None]]]


def _optimal_weights(sets, tolerance):
    """Weights (k, m) whose ellipsoids are within the tolerance of the smallest ones."""
    lifted = np.concatenate([sets, np.ones((*sets.shape[:2], 1))], axis=2)  # (k, m, 4)
    weights = _first_weights(sets)
    inverse = np.linalg.inv(np.einsum("km,kmi,kmj->kij", weights, lifted, lifted))
    leverage = np.einsum("kmi,kij,kmj->km", lifted, inverse, lifted)  # 1 + squared Mahalanobis distance
    enough = 1.0 + 3.0 * (1.0 + tolerance) ** (2.0 / 3.0)
    rows = np.arange(len(sets))
    for _ in range(MAX_STEPS):
        most = np.argmax(leverage, axis=1)
        if np.all(leverage[rows, most] <= enough):
            return weights
        least = np.argmin(np.where(weights > 0.0, leverage, np.inf), axis=1)
        towards = leverage[rows, most] - 4.0 >= 4.0 - leverage[rows, least]
        chosen = np.where(towards, most, least)
        extreme = leverage[rows, chosen]
        size = np.where(leverage[rows, most] <= enough, 0.0, _step(extreme, weights[rows, chosen]))
        # Sherman and Morrison for the moment matrix (1 - size) X + size q q^T and what depends on it.
        direction = np.einsum("kij,kj->ki", inverse, lifted[rows, chosen])
        along = np.einsum("kmi,ki->km", lifted, direction)
        factor = size / (1.0 - size + size * extreme)
        rest = 1.0 - size[:, None]
        leverage = (leverage - factor[:, None] * along**2) / rest
        outer = direction[:, :, None] * direction[:, None, :]
        inverse = (inverse - factor[:, None, None] * outer) / rest[:, :, None]
        weights *= rest
        weights[rows, chosen] = np.maximum(weights[rows, chosen] + size, 0.0)
    raise RuntimeError(f"no enclosing ellipsoids within {tolerance} of the smallest after {MAX_STEPS} steps")


def _step(leverage, weight):
    """Share of weight that maximises the volume: towards an outer point (> 0), or away from an inner one (< 0).

    At most all of the point's own weight can be taken away.
    """
    all_of_it = -weight / np.maximum(1.0 - weight, np.finfo(float).tiny)
    best = np.where(leverage > 1.0, (leverage - 4.0) / (4.0 * np.maximum(leverage - 1.0, 1e-12)), -np.inf)
    return np.maximum(best, all_of_it)


def _first_weights(sets):
    """Equal weights (k, m) on the outermost points along the directions; on all points where those lie in a plane."""
    along = sets @ START_DIRECTIONS.T  # (k, m, directions)
    weights = np.zeros(sets.shape[:2])
    for outermost in (along.argmax(axis=1), along.argmin(axis=1)):
        np.put_along_axis(weights, outermost, 1.0, axis=1)
    weights /= weights.sum(axis=1, keepdims=True)
    weights[_flat(sets, weights)] = 1.0 / sets.shape[1]
    flat = _flat(sets, weights)
    if np.any(flat):
        raise ValueError(f"the points of set {np.argmax(flat)} lie in a plane: no ellipsoid around them is smallest")
    return weights


def _flat(sets, weights):
    spread = np.linalg.eigvalsh(_moments(sets, weights)[1])  # ascending
    return spread[:, 0] <= FLAT_VARIANCE * spread[:, 2]


def _moments(sets, weights):
    """Centres (k, 3) and covariances (k, 3, 3) of weighted points."""
    centres = np.einsum("km,kmi->ki", weights, sets)
    offsets = sets - centres[:, None]
    return centres, np.einsum("km,kmi,kmj->kij", weights, offsets, offsets)
