"""Parts that lie on the table and on each other, at rest and without touching each other's inside.

Parts are lowered one after the other, each in one of its stable poses, until the first contact. Where they would come
to rest is read off height maps that bound the surfaces from outside, so nothing intersects; the price is a gap between
parts of about a cell. A part stays only if it is in equilibrium for certain: its centre of mass lies above the hull of
its *firm* contacts, those with the table and those with a part below that lie above that part's own firm contacts.
Vertical forces at firm contacts then carry every weight down to the table and tip nothing. No part leans on another.
"""

from dataclasses import dataclass, field
from typing import no_type_check

import numba
import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import grey_dilation
from scipy.spatial import ConvexHull
from scipy.spatial.transform import RigidTransform

from scenes.scene import Mesh
from scenes.stable_poses import STABLE_MARGIN, inside_by

CELL = 0.002
"""Side of a cell of the height map [m] (choice: parts rest up to this much too high, and piles stay cheap)."""
SPACING = CELL / 2
"""No surface point is farther than this from a sample [m]: LATTICE / sqrt(3) and the diagonal of a THINNING cube."""
LATTICE, THINNING = 0.9e-3, 0.25e-3
"""Largest step of the samples on a triangle, and side of the cubes that keep one of theirs [m]."""
HALF_SIDE = 0.4
"""The map covers the table this far from its middle [m], its whole depth."""
CONTACT = SPACING
"""What comes this near to the first contact touches as well [m]: heights are not known better."""
TABLE = -1
"""Owner of a cell that nothing lies on."""


@dataclass(eq=False)
class Pile:
    """What lies on the table so far."""

    _top: Float[np.ndarray, "n n"] = field(default_factory=lambda: np.zeros((_CELLS, _CELLS)))
    _owner: Int[np.ndarray, "n n"] = field(default_factory=lambda: np.full((_CELLS, _CELLS), TABLE))
    _supports: list[Float[np.ndarray, "k 2"]] = field(default_factory=list)
    """Firm contacts of each part, world x and y [m]."""

    def resting_height(
        self, samples: Float[np.ndarray, "n 3"], pose: RigidTransform, centre: Float[np.ndarray, "3"]
    ) -> float | None:
        """Lower a part and leave it where it comes to rest; None, and nothing changes, where it would not stay.

        samples: of its surface by `surface_samples`, in its model frame [m]. pose: T_world_model of where it goes, its
        lowest point at z = 0. centre: of its mass, in its model frame [m]. Returns how far up it rests [m].
        """
        low, bottom, top = _height_bounds(samples, pose.as_matrix())
        high = low + bottom.shape
        if not bottom.size:
            return None
        window = np.s_[low[0] : high[0], low[1] : high[1]]
        # A surface point is within half a cell of a sample: one cell around and half a cell up bound it.
        around = np.s_[low[0] - 1 : high[0] + 1, low[1] - 1 : high[1] + 1]
        below = grey_dilation(self._top[around], size=(3, 3))[1:-1, 1:-1]
        occupied = below > 0
        gap = np.where(occupied, below + 2 * SPACING - bottom, -bottom)
        height = max(float(np.max(gap)), 0.0)
        firm = self._firm(window, gap >= height - CONTACT, occupied)
        if len(firm) < 3 or inside_by(firm, pose.apply(centre)[:2]) < STABLE_MARGIN:
            return None
        higher = height + top > self._top[window]
        self._top[window] = np.where(higher, height + top, self._top[window])
        self._owner[window] = np.where(higher, len(self._supports), self._owner[window])
        self._supports.append(firm)
        return height

    def _firm(
        self, window: tuple[slice, slice], touching: Bool[np.ndarray, "a b"], occupied: Bool[np.ndarray, "a b"]
    ) -> Float[np.ndarray, "k 2"]:
        """Contacts (world x and y) that can carry a weight."""
        rows, columns = np.nonzero(touching)
        points = (np.stack([rows + window[0].start, columns + window[1].start], axis=1) + 0.5) * CELL - HALF_SIDE
        # The owner of a cell whose height comes from its neighbour is that neighbour's: the topmost of all.
        around = np.s_[window[0].start - 1 : window[0].stop + 1, window[1].start - 1 : window[1].stop + 1]
        owner = grey_dilation(self._owner[around], size=(3, 3))[1:-1, 1:-1][rows, columns]
        firm = ~occupied[rows, columns]
        for part, support in enumerate(self._supports):
            mine = np.flatnonzero(~firm & (owner == part))
            equations = ConvexHull(support).equations
            inside = points[mine] @ equations[:, :2].T + equations[:, 2] <= 0
            firm[mine] = inside.all(axis=1)
        return points[firm]


_CELLS = round(2 * HALF_SIDE / CELL)


@no_type_check
@numba.njit(nogil=True, cache=True)
def _height_bounds(samples, pose):
    """The map's first cell (2,) that a part covers at this pose (4, 4), and from there on the lowest and the highest
    sample of every cell, infinite where there is none; of size 0 where the part reaches beyond the map."""
    low, high = np.array([_CELLS, _CELLS]), np.array([-1, -1])
    cells = np.zeros((len(samples), 2), np.int64)
    for k in range(len(samples)):
        x, y, z = samples[k]
        for axis in range(2):
            at = pose[axis, 0] * x + pose[axis, 1] * y + pose[axis, 2] * z + pose[axis, 3]
            cell = int(np.floor((at + HALF_SIDE) / CELL))
            cells[k, axis] = cell
            low[axis], high[axis] = min(low[axis], cell), max(high[axis], cell)
    if min(low[0], low[1]) < 1 or max(high[0], high[1]) > _CELLS - 2:
        return low, np.zeros((0, 0)), np.zeros((0, 0))
    shape = (high[0] - low[0] + 1, high[1] - low[1] + 1)
    bottom, top = np.full(shape, np.inf), np.full(shape, -np.inf)
    for k in range(len(samples)):
        x, y, z = samples[k]
        height = pose[2, 0] * x + pose[2, 1] * y + pose[2, 2] * z + pose[2, 3]
        i, j = cells[k, 0] - low[0], cells[k, 1] - low[1]
        bottom[i, j], top[i, j] = min(bottom[i, j], height), max(top[i, j], height)
    return low, bottom, top


def surface_samples(mesh: Mesh) -> Float[np.ndarray, "n 3"]:
    """Points on the surface that leave none of it farther than SPACING from one [m]."""
    corners = mesh.vertices[mesh.faces]
    longest = np.max(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2), axis=1)
    steps = np.maximum(np.ceil(longest / LATTICE).astype(int), 1)
    chunks = []
    for n in np.unique(steps):
        i, j = (index.ravel() for index in np.mgrid[: n + 1, : n + 1])
        weights = np.stack([i, j, n - i - j], axis=1)[i + j <= n] / n  # (lattice points, 3)
        chunks.append(np.einsum("pk,tkx->tpx", weights, corners[steps == n]).reshape(-1, 3))
    points = np.concatenate(chunks)
    cubes = np.floor(points / THINNING).astype(np.int64)
    cubes -= cubes.min(axis=0)
    size = cubes.max(axis=0) + 1
    return points[np.unique((cubes[:, 0] * size[1] + cubes[:, 1]) * size[2] + cubes[:, 2], return_index=True)[1]]
