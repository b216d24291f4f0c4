"""A part as an obstacle: points all over its surface, and whether a point lies inside it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from scenes.scene import Mesh

SAMPLE_SPACING = 0.003
"""Mean distance of neighbouring surface points [m] (choice: below the clearance, so that nothing slips between)."""
SAMPLE_SEED = 0
"""The points are a property of the part, not of the run."""


@dataclass(frozen=True, eq=False)
class Solid:
    """One or several closed meshes as an obstacle.

    Open ones work as far as the solid angle tells inside from outside. The surface is known by points SAMPLE_SPACING
    apart on average, the inside by the winding number.
    """

    triangles: Float[np.ndarray, "m 3 3"]
    """Corners, world [m]."""
    samples: KDTree
    """Points on the surface, all mesh corners among them, world [m]."""

    @classmethod
    def from_mesh(cls, mesh: Mesh) -> "Solid":
        """The solid that a mesh encloses."""
        triangles = np.asarray(mesh.vertices, float)[mesh.faces]
        corners = np.unique(triangles.reshape(-1, 3), axis=0)
        return cls(triangles, KDTree(np.concatenate([corners, _surface_points(triangles)])))

    def samples_within(self, centre: Float[np.ndarray, "3"], radius: float) -> Float[np.ndarray, "n 3"]:
        """The surface points in a ball, world [m]."""
        return self.samples.data[self.samples.query_ball_point(centre, radius)]

    def winding_number(self, point: Float[np.ndarray, "3"]) -> float:
        """How often the surface encloses a point: 1 inside, 0 outside; its solid angle over 4 pi.

        Source: van Oosterom and Strackee (1983) for one triangle, Jacobson et al. (2013) for their sum.
        """
        lower, upper = self.samples.mins, self.samples.maxes
        if np.any(point < lower) or np.any(point > upper):
            return 0.0
        a, b, c = np.moveaxis(self.triangles - point, 1, 0)  # (m, 3) each
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        ab, bc, ca = (np.einsum("mi,mi->m", x, y) for x, y in ((a, b), (b, c), (c, a)))
        volume = np.einsum("mi,mi->m", a, np.cross(b, c))
        return float(np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb).sum() / (2 * np.pi))


def _surface_points(triangles: Float[np.ndarray, "m 3 3"]) -> Float[np.ndarray, "n 3"]:
    """Area-uniform points, one for each SAMPLE_SPACING squared."""
    rng = np.random.default_rng(SAMPLE_SEED)
    areas = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1) / 2
    count = int(np.ceil(areas.sum() / SAMPLE_SPACING**2))
    chosen = triangles[rng.choice(len(triangles), count, p=areas / areas.sum())]
    u, v = rng.random((2, count, 1))
    root = np.sqrt(u)
    return (1 - root) * chosen[:, 0] + root * (1 - v) * chosen[:, 1] + root * v * chosen[:, 2]
