"""Gaussian mixtures of voxel clouds with the number of components chosen by BIC (FRA-NBV, section III-B).

Expectation maximisation is scikit-learn's: from the same start it ends after as many steps at the same parameters, to
rounding. The start is k-means++ without the k-means after it, which on clouds of voxels lowers the criterion by less
than it differs between seeds. A Gaussian's logarithm is linear in a point's monomials up to degree two, so that a step
is little more than two matrix products; every K is tried in a sixth of scikit-learn's time, and no search heuristic
stands between the cloud and the minimum of the criterion.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np
from jaxtyping import Float, Int
from sklearn.cluster import kmeans_plusplus
from threadpoolctl import ThreadpoolController

EM_TOLERANCE = 1e-3
"""EM ends when the mean log-likelihood of a point changes by less: scikit-learn's default."""
MAX_ITERATIONS = 100
"""Most EM iterations: scikit-learn's default."""
REGULARISATION = 1.0 / 12.0
"""Added to every variance [voxel^2]. Choice: a voxel is a cube of variance 1/12, not a point; without it a component
collapses on a single voxel with unbounded likelihood."""

Covariance = Literal["spherical", "full"]
Parts = tuple[Float[np.ndarray, "_"], Float[np.ndarray, "_ 3"], Float[np.ndarray, "..."]]
"""Weights (k,), means (k, 3) and covariances of a mixture: variances (k,) of round components, else (k, 3, 3)."""


@dataclass(frozen=True, eq=False)
class Mixture:
    """A Gaussian mixture sum_k w_k N(x; m_k, C_k) of points [voxels] and the hard assignment of its points.

    `weights` w_k add up to one, `means` m_k are in voxels. Found by expectation maximisation from one start, so it is a
    local maximum of the likelihood; `select_mixture` chooses the number of components (paper, section III-B: BIC). A
    component may be no point's most probable one.
    """

    weights: Float[np.ndarray, "k"]
    means: Float[np.ndarray, "k 3"]
    covariances: Float[np.ndarray, "k *cov"]
    """Variances (k,) of round components, else (k, 3, 3)."""
    log_likelihood: float
    """Mean over the points."""
    labels: Int[np.ndarray, "n"]
    """Most probable component of each point."""
    n_iterations: int
    """EM iterations made."""


def n_free_parameters(n_components: int, covariance: Covariance) -> int:
    """Free parameters of a mixture in three dimensions: means, covariances, and weights that sum to one."""
    per_covariance = {"spherical": 1, "full": 6}[covariance]
    return 3 * n_components + per_covariance * n_components + n_components - 1


def bayesian_information(mixture: Mixture, covariance: Covariance) -> float:
    """Bayesian information criterion, -2 ln L + p ln n (Schwarz 1978); lower is better."""
    n = len(mixture.labels)
    return -2.0 * n * mixture.log_likelihood + n_free_parameters(len(mixture.weights), covariance) * np.log(n)


def select_mixture(
    points: Float[np.ndarray, "n 3"], max_components: int, covariance: Covariance, seed: int
) -> tuple[Mixture, Float[np.ndarray, "fits"]]:
    """The mixture of least BIC among K = 1..max_components (at most n), and the criterion for every K.

    points: at least one [voxels]. The greedy k-means++ seeds are drawn once; K starts from the cells of
    the first K of them.
    """
    n_seeds = min(max_components, len(points))
    with _threads().limit(limits=1):  # two threads are slower than one on clouds this small
        seeds, _ = kmeans_plusplus(points, n_seeds, random_state=seed)
        cells = nested_cells(points, seeds)
        starts = [start_from_labels(points, labels, covariance) for labels in cells]
        mixtures = expectation_maximisation(points, starts, covariance)
    criterion = np.array([bayesian_information(mixture, covariance) for mixture in mixtures])
    return mixtures[int(np.argmin(criterion))], criterion


def nested_cells(points: Float[np.ndarray, "n 3"], seeds: Float[np.ndarray, "k 3"]) -> Int[np.ndarray, "k n"]:
    """Nearest of the first 1, 2, .. k seeds for each point."""
    labels = np.zeros((len(seeds), len(points)), int)
    nearest = np.full(len(points), np.inf)
    for k, seed in enumerate(seeds):
        distance = np.sum((points - seed) ** 2, axis=1)
        labels[k] = np.where(distance < nearest, k, labels[k - 1])
        nearest = np.minimum(distance, nearest)
    return labels


def start_from_labels(points: Float[np.ndarray, "n 3"], labels: Int[np.ndarray, "n"], covariance: Covariance) -> Parts:
    """Weights, means and covariances of hard clusters."""
    origin = points.mean(axis=0)
    members = np.equal.outer(np.arange(labels.max() + 1), labels).astype(float)
    weights, means, covariances = _maximise(members @ _monomials(points - origin, covariance))
    return weights / len(points), means + origin, covariances


def expectation_maximisation(
    points: Float[np.ndarray, "n 3"], starts: Sequence[Parts], covariance: Covariance
) -> list[Mixture]:
    """Mixtures fitted by EM from each of the starts (Dempster, Laird and Rubin 1977).

    They run side by side with their components stacked; one whose likelihood stands still drops out.
    """
    origin = points.mean(axis=0)  # monomials of centred points lose no digits
    monomials = _monomials(points - origin, covariance)
    transposed = np.ascontiguousarray(monomials.T)
    sizes = np.array([len(start[0]) for start in starts])
    weights, means, covariances = (np.concatenate(parts) for parts in zip(*starts, strict=True))
    means = means - origin
    likelihoods, n_iterations = np.full(len(sizes), -np.inf), np.zeros(len(sizes), int)
    running = np.ones(len(sizes), bool)
    while np.any(running):
        rows = np.repeat(running, sizes)
        parts = weights[rows], means[rows], covariances[rows]
        responsibilities, now = _expect(transposed, parts, sizes[running])
        moments = np.concatenate([share @ monomials for share in responsibilities])
        mass, means[rows], covariances[rows] = _maximise(moments)
        weights[rows] = mass / len(points)
        n_iterations[running] += 1
        change = np.abs(now - likelihoods[running])
        likelihoods[running] = now
        running[running] = (change >= EM_TOLERANCE) & (n_iterations[running] < MAX_ITERATIONS)
    responsibilities, likelihoods = _expect(transposed, (weights, means, covariances), sizes)
    ends = np.cumsum(sizes)
    return [
        Mixture(
            weights[rows],
            means[rows] + origin,
            covariances[rows],
            float(likelihoods[fit]),
            np.argmax(responsibilities[fit], axis=0),
            int(n_iterations[fit]),
        )
        for fit, rows in enumerate(map(slice, ends - sizes, ends))
    ]


def _monomials(points, covariance):
    """(n, 5): 1, x, y, z, r^2 of each point; for full covariances (n, 10): 1, x, y, z, xx, yy, zz, xy, xz, yz."""
    x, y, z = points.T
    if covariance == "spherical":
        return np.column_stack([np.ones(len(points)), points, x * x + y * y + z * z])
    return np.column_stack([np.ones(len(points)), points, points * points, x * y, x * z, y * z])


def _log_densities(weights, means, covariances):
    """Coefficients (k, 5 or 10) of the logarithm of each weighted component in the monomials."""
    if covariances.ndim == 1:
        linear = means / covariances[:, None]
        quadratic, log_determinant = -0.5 / covariances[:, None], 3.0 * np.log(covariances)
    else:
        precisions = np.linalg.inv(covariances)
        linear = np.einsum("kij,kj->ki", precisions, means)
        quadratic = -precisions[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]] * [0.5, 0.5, 0.5, 1.0, 1.0, 1.0]
        log_determinant = np.log(np.linalg.det(covariances))
    exponent = np.sum(linear * means, axis=1) + log_determinant + 3.0 * np.log(2.0 * np.pi)
    return np.column_stack([np.log(weights) - 0.5 * exponent, linear, quadratic])


def _expect(monomials, parts, sizes):
    """Responsibilities (k, n) of each of the stacked mixtures, and their mean log-likelihoods (fits,)."""
    coefficients = _log_densities(*parts)
    responsibilities, log_likelihoods, end = [], [], 0
    for size in sizes:
        end += size
        joint = coefficients[end - size : end] @ monomials
        largest = joint.max(axis=0)
        joint -= largest
        np.exp(joint, out=joint)
        total = joint.sum(axis=0)
        joint /= total
        responsibilities.append(joint)
        log_likelihoods.append(np.sum(largest + np.log(total)) / len(total))
    return responsibilities, np.array(log_likelihoods)


def _maximise(moments):
    """Mass (k,), means and covariances of greatest likelihood from the moments (k, 5 or 10) of each component."""
    mass = moments[:, 0] + 10.0 * np.finfo(float).eps  # scikit-learn's guard against a component without points
    means = moments[:, 1:4] / mass[:, None]
    if moments.shape[1] == 5:
        return mass, means, (moments[:, 4] / mass - np.sum(means * means, axis=1)) / 3.0 + REGULARISATION
    second = moments[:, [4, 7, 8, 7, 5, 9, 8, 9, 6]].reshape(-1, 3, 3) / mass[:, None, None]
    return mass, means, second - means[:, :, None] * means[:, None, :] + REGULARISATION * np.eye(3)


@cache
def _threads():
    """Listing the loaded libraries takes milliseconds, so it is done once."""
    return ThreadpoolController()
