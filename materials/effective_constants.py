"""One n + ik that stands for a metal under a whole spectrum: what a renderer of one channel needs for a lamp's light.

Neither the mean of n nor that of k reflects as the spectrum does. Of the pairs with the spectrum's normal reflectance,

    R0(n, k) = sum over wavelengths of weight R0(n_i, k_i),

which lie on a circle, the one is taken that has its reflectance in a white furnace, too, the mean over all directions

    R_h(n, k) = sum over wavelengths of weight R_h(n_i, k_i).

Both are then exact, and so is the light of a rough metal to a good part, for facets meet light at all angles. At a
single angle it is right to 0.012 for the metals of the table, copper and brass being the farthest off, beyond 80 deg;
most are right to 0.005 (`tests/materials/test_effective_constants.py`).
"""

import numpy as np
from jaxtyping import Float
from scipy.optimize import brentq

from materials.fresnel import hemispherical_reflectance, normal_reflectance

_SCAN = 200
"""Steps along the circle of equal normal reflectance, between which the root is bracketed."""
_K_MIN = 1e-6
"""Extinction at the ends of the circle [-], where it would be 0 and the metal a dielectric."""


def effective_constants(
    n: Float[np.ndarray, "w"], k: Float[np.ndarray, "w"], weights: Float[np.ndarray, "w"]
) -> tuple[float, float]:
    """n and k [-] of the metal that reflects as this one does under the spectrum of these weights, of sum 1.

    ValueError for weights of another sum, and where no pair has both reflectances, which no metal comes near.
    """
    if abs(float(np.sum(weights)) - 1.0) > 1e-6:
        raise ValueError(f"weights have sum {np.sum(weights):g}, not 1")
    normal = float(sum(w * normal_reflectance(a, b) for w, a, b in zip(weights, n, k, strict=True)))
    furnace = float(sum(w * hemispherical_reflectance(a, b) for w, a, b in zip(weights, n, k, strict=True)))

    def extinction(index: float) -> float:
        """The k at which a metal of that index has the normal reflectance wanted."""
        squared = (normal * (index + 1.0) ** 2 - (index - 1.0) ** 2) / (1.0 - normal)
        return max(squared, _K_MIN**2) ** 0.5

    def excess(log_index: float) -> float:
        index = float(np.exp(log_index))
        return hemispherical_reflectance(index, extinction(index)) - furnace

    amplitude = normal**0.5
    end = float(np.log((1.0 + amplitude) / (1.0 - amplitude)))  # the circle runs from 1/x to x on the axis k = 0
    steps = np.linspace(-end, end, _SCAN + 1)
    values = np.array([excess(step) for step in steps])
    crossings = np.flatnonzero(values[:-1] * values[1:] <= 0.0)
    if len(crossings) == 0:
        raise ValueError(f"no n, k reflect {normal:.4f} along the normal and {furnace:.4f} from everywhere")
    step = brentq(excess, float(steps[crossings[0]]), float(steps[crossings[0] + 1]))
    assert isinstance(step, float)  # and not the pair that `full_output` gives
    index = float(np.exp(step))
    return index, extinction(index)
