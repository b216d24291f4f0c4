"""The true surface that a reconstruction is judged against: what of it can be seen, and the distance to all of it."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float

from franbv.evaluation.reference import Reference, distance_to_samples
from materials.input_error import InputError
from scenes.reference_points import part_box, reference_points
from scenes.scene import Scene

N_REFERENCE = 10_000
"""Reference points (choice: the standard error of a coverage is at most 0.5 points)."""
N_DRAWN = 40_000
"""Points drawn first; of most parts more than a quarter can be seen (choice)."""
MOST_DRAWN = 16 * N_DRAWN
"""Points drawn at most. A part of which fewer than one in 64 can be seen keeps fewer reference points."""
N_DISTANCE = 300_000
"""Samples of the whole surface for distances: 0.2 mm apart on 0.04 m^2 (`distance_to_samples`)."""
BASE_HEIGHT = 0.001
"""The face that a part stands on is what faces down this near to its lowest point [m] (choice: more than tessellation
and broken edges take away, less than any foot)."""
BASE_COSINE = 0.99
"""Least cosine between that face's normal and straight down (choice: within 8 deg)."""
REFERENCE_SEED = 0
"""The points belong to the part and not to the run, so that runs can be compared."""

Visible = Callable[[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]], Bool[np.ndarray, "n"]]
"""(points [m], outward unit normals) -> whether some view of the upper hemisphere sees each."""


def reference_surface(scene: Scene, visible: Visible) -> Reference:
    """Area-uniform points on the visible part of the surface and on its base, and the distance to the whole of it."""
    drawn = N_DRAWN
    while True:
        points, normals = reference_points(scene, drawn, REFERENCE_SEED)
        seen = np.flatnonzero(visible(points, normals))[:N_REFERENCE]
        if len(seen) == N_REFERENCE or drawn >= MOST_DRAWN:
            break
        drawn *= 4
    if len(seen) == 0:
        raise InputError(f"{scene.name}: no point of its surface can be seen from above; are its faces turned inward?")
    samples, _ = reference_points(scene, N_DISTANCE, REFERENCE_SEED + 1)
    # The drawn points are in random order, so the first ones are as uniform as all, and those of the base among them as
    # dense as those that can be seen.
    taken = seen[-1] + 1 if len(seen) == N_REFERENCE else drawn
    low = part_box(scene)[0, 2]
    is_base = (normals[:taken, 2] < -BASE_COSINE) & (points[:taken, 2] < low + BASE_HEIGHT)
    return Reference(points[seen], distance_to_samples(samples), points[:taken][is_base])
