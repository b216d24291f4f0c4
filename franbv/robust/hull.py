"""The hull of what was measured of the object, down to what it stands on, as rays meet it.

Beside `hypothesis`, which asks where to look next and takes whatever may be surface, this one asks where surface must
be: it is made of voxels that a whole hit speaks for and nobody contradicts. A false depth that stands alone would grow
it.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics, project
from franbv.geometry.polygons import NEAR, convex_hull, cross
from franbv.object_model import above_table, large_components
from franbv.parameters import Parameters
from franbv.robust.evidence import EvidenceMap
from franbv.robust.hypothesis import UNDERSIDE
from franbv.robust.settings import RobustSettings

ROUND = 6
"""Digits to which planes are compared: facets of one face have one plane (choice: a micrometre)."""
RAY_PLACES = 9
"""Places between entry and exit of a ray at which its depth below the hull is asked for (choice: it is concave along
the ray, so that few find its top within a tenth)."""


@dataclass(frozen=True, eq=False)
class ObjectHull:
    """A convex body that stands on the table."""

    vertices: Float[np.ndarray, "n 3"]
    """World [m]."""
    planes: Float[np.ndarray, "m 4"]
    """Outward unit normal n and offset b of each face: n x + b <= 0 inside."""
    measured: Float[np.ndarray, "k 3"]
    """Centres of the voxels that it was made of [m]."""

    def below(self, points: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n"]:
        """Depth of each point below the faces that can be looked at [m], negative outside; what it stands on does not
        count."""
        faces = self.planes[self.planes[:, 2] > UNDERSIDE]
        return -(points @ faces[:, :3].T + faces[:, 3]).max(axis=-1)

    def normals_at(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Outward unit normal of the face that each point lies on, or is nearest to from within."""
        return self.planes[np.argmax(points @ self.planes[:, :3].T + self.planes[:, 3], axis=1), :3]

    def crossed(
        self, origin: Float[np.ndarray, "3"], rays: Float[np.ndarray, "n 3"]
    ) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
        """Of each unit ray the lengths at which it enters and leaves [m], and how deep below the faces it comes [m];
        inf, -inf and -inf where it misses."""
        height = -(origin @ self.planes[:, :3].T + self.planes[:, 3])
        slope = rays @ self.planes[:, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            lengths = height / slope
        entry = np.where(slope < 0, lengths, -np.inf).max(axis=1, initial=-np.inf)
        leaves = np.where(slope > 0, lengths, np.inf).min(axis=1, initial=np.inf)
        outside = np.any((slope == 0) & (height < 0), axis=1)
        hit = (entry < leaves) & (entry > 0) & ~outside
        deepest = np.full(len(rays), -np.inf)
        steps = np.linspace(0.0, 1.0, RAY_PLACES)[:, None]
        along = entry[hit] + steps * (leaves - entry)[hit]  # (RAY_PLACES, n)
        deepest[hit] = self.below(origin + along[..., None] * rays[hit]).max(axis=0, initial=-np.inf)
        return np.where(hit, entry, np.inf), np.where(hit, leaves, -np.inf), deepest

    def covered(self, intrinsics: Intrinsics, T_world_cam: RigidTransform) -> Bool[np.ndarray, "h w"]:
        """Pixels that see nothing but the hull, to their corners; none for a camera within reach of it."""
        covered = np.zeros((intrinsics.height, intrinsics.width), bool)
        corners = T_world_cam.inv().apply(self.vertices)
        if corners[:, 2].min() <= NEAR:
            return covered
        outline = convex_hull(project(corners, intrinsics))
        u, v = np.meshgrid(np.arange(intrinsics.width + 1) - 0.5, np.arange(intrinsics.height + 1) - 0.5)
        corner = np.stack([u, v], axis=-1)[..., None, :]
        inside = np.all(cross(np.roll(outline, -1, axis=0) - outline, corner - outline) >= 0, axis=-1)
        return inside[:-1, :-1] & inside[1:, :-1] & inside[:-1, 1:] & inside[1:, 1:]


def object_hull(grid: EvidenceMap, parameters: Parameters, settings: RobustSettings) -> ObjectHull | None:
    """The hull of the object's surely occupied voxels and of their shadow on the table; None before there is any."""
    above = above_table(grid, parameters)
    for sure in (lambda: grid.log_odds > settings.sure_log_odds, lambda: grid.confirmed):
        solid = large_components(sure() & above, parameters.min_component_voxels, parameters.min_component_share)
        measured = grid.centres(solid)
        shadow = measured.copy()
        shadow[:, 2] = parameters.table_height
        corners = np.concatenate([measured, shadow])
        try:
            hull = ConvexHull(corners)
        except (QhullError, ValueError):  # too few, or all in a plane
            continue
        planes = np.unique(np.round(hull.equations, ROUND), axis=0)
        return ObjectHull(corners[hull.vertices], planes, measured)
    return None
