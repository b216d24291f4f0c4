"""Draws from the declared weights and ranges."""

import math
from collections.abc import Mapping

import numpy as np

from materials.catalog import finish_names
from materials.finishes import FINISHES
from studies.dataset.config import Materials


def pick(rng: np.random.Generator, weights: Mapping[str, float]) -> str:
    """A name, as often as its weight says."""
    names = sorted(weights)  # so that the order in the file does not matter
    shares = np.array([weights[name] for name in names], float)
    return names[int(rng.choice(len(names), p=shares / shares.sum()))]


def log_uniform(rng: np.random.Generator, limits: tuple[float, float]) -> float:
    """A number whose logarithm is uniform between those of the limits."""
    return float(limits[0] * (limits[1] / limits[0]) ** rng.random())


def drawn_material(rng: np.random.Generator, materials: Materials) -> str:
    """`own`, or the name of a material for a whole part, its roughness included."""
    kind = pick(rng, materials.kind)
    if kind == "own":
        return "own"
    if kind == "non_metal":
        return pick(rng, materials.non_metals)
    metal = pick(rng, materials.metals)
    # A metal that grows no oxide cannot be oxidised.
    fitting = finish_names(metal, materials.of_user)
    finish = pick(rng, {name: weight for name, weight in materials.finishes.items() if name in fitting})
    if materials.roughness == "nominal":
        return f"{metal}:{finish}"
    surface, place = FINISHES[finish], rng.random()
    # One place in both ranges: along and across the lay are rough together.
    u, v = (_between(limits, place) for limits in (surface.range_u, surface.range_v))
    return f"{metal}:{finish}@alpha={u:.4f}" if surface.isotropic else f"{metal}:{finish}@alpha={u:.4f},{v:.4f}"


def _between(limits: tuple[float, float], place: float) -> float:
    return math.exp(math.log(limits[0]) + place * math.log(limits[1] / limits[0]))
