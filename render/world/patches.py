"""A scene's surfaces as a few hundred patches, and how much of its view each fills for each other.

The light between them closes light paths (`render.world.radiosity`). A patch is the part of one body that faces one of
the six directions along the axes: walls, table top, the sides of furniture, about six of a small part. Form factors are
counted by rays (T. Malley, 1988). They depend on the meshes alone.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from render.world import backend
from render.world.lamps import LampLight
from scenes.scene import Mesh

PATCH_RAYS = 131_072
"""Rays in all (choice: with fifty patches a form factor of 0.1 is then right to 0.006)."""
POINTS_ON_PATCH = 256
"""On each patch (choice: its mean is then right to a few percent where half of it is hidden)."""
NARROW = 0.005
"""Gaps in which nothing is seen of the rest [m]: between a body and what it stands on (choice)."""
SIX_DIRECTIONS = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)


@dataclass(frozen=True, eq=False)
class Patches:
    """Of one scene; a face's patch is looked up by its place in `SceneGeometry.body_of_face`."""

    of_face: Int[np.ndarray, "f"]
    """Patch of every face, and 0 for nothing at the end."""
    body: Int[np.ndarray, "n"]
    """Body of every patch."""
    area: Float[np.ndarray, "n"]
    """[m^2]"""
    position: Float[np.ndarray, "n r 3"]
    """Random points on each patch, even over its area."""
    normal: Float[np.ndarray, "n r 3"]
    """Of the faces there, outward."""

    looked_at: Bool[np.ndarray, "n"]
    """Of the parts, about which a scene is; all where there is none."""

    @classmethod
    def of(cls, meshes: list[tuple[int, Mesh]], parts: Sequence[int]) -> "Patches":
        """meshes: with the numbers of their bodies, in the order of their faces. parts: numbers of the parts."""
        bodies, faces, corners = [], [], []
        for number, mesh in meshes:
            triangles = mesh.vertices[mesh.faces]
            corners.append(triangles)
            bodies.append(np.full(len(triangles), number))
            faces.append(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
        triangle, body, cross = (np.concatenate(x) for x in (corners, bodies, faces))
        twice_area = np.linalg.norm(cross, axis=1)
        normal = cross / np.maximum(twice_area, 1e-30)[:, None]
        key = body * len(SIX_DIRECTIONS) + np.argmax(normal @ SIX_DIRECTIONS.T, axis=1)
        keys, patch = np.unique(key, return_inverse=True)
        area = np.bincount(patch, twice_area / 2, len(keys))
        per_patch = POINTS_ON_PATCH
        rng = np.random.default_rng(0)
        order = np.argsort(patch, kind="stable")
        ends = np.cumsum(np.bincount(patch, minlength=len(keys)))
        chosen = np.zeros((len(keys), per_patch), int)
        for i, end in enumerate(ends):
            own = order[(ends[i - 1] if i else 0) : end]
            share = twice_area[own] / max(twice_area[own].sum(), 1e-30)
            chosen[i] = rng.choice(own, per_patch, p=share if share.sum() > 0.5 else None)
        u, v = rng.random((2, *chosen.shape, 1))
        root = np.sqrt(u)
        position = (
            (1 - root) * triangle[chosen, 0] + root * (1 - v) * triangle[chosen, 1] + root * v * triangle[chosen, 2]
        )
        is_part = np.isin(keys // len(SIX_DIRECTIONS), parts)
        looked_at = is_part if is_part.any() else np.ones(len(keys), bool)
        return cls(np.append(patch, 0), keys // len(SIX_DIRECTIONS), area, position, normal[chosen], looked_at)


@dataclass(frozen=True, eq=False)
class PatchViews:
    """What the patches of a geometry see: one another, the outside, and the lamps.

    By rays, cosine-weighted, from where light paths come to that began on the part and were reflected twice: what
    furniture hides of a floor does not count, and what lies far away counts little. `position` and `normal` tell where
    the rays end.
    """

    n: int
    """Number of patches."""
    from_patch: Int[np.ndarray, "r"]
    """Patch that each ray leaves."""
    to_patch: Int[np.ndarray, "r"]
    """Patch that it meets; n = none."""
    position: Any
    """Where (Dr.Jit Point3f, r values) [m]."""
    normal: Any
    """Unit normal there, on the side that is met."""
    by_lamps: Float[np.ndarray, "n n"]
    """`seen` of the irradiance over pi that comes straight from the lamps."""

    @cached_property
    def form_factors(self) -> Float[np.ndarray, "n n"]:
        """Share of the hemisphere over each patch that each other one fills."""
        return self.seen(np.ones(len(self.to_patch)))

    @property
    def outside(self) -> Float[np.ndarray, "n"]:
        """Share that is left; 0 for patches that nobody sees."""
        rays = np.bincount(self.from_patch, minlength=self.n)
        return np.bincount(self.from_patch, self.to_patch == self.n, self.n) / np.maximum(rays, 1)

    def seen(self, values: Float[np.ndarray, "r"]) -> Float[np.ndarray, "n n"]:
        """What each patch sees of each other one, from values where the rays end: means over all its rays."""
        sums = np.bincount(self.from_patch * (self.n + 1) + self.to_patch, values, self.n * (self.n + 1))
        rays = np.maximum(np.bincount(self.from_patch, minlength=self.n), 1)
        return sums.reshape(self.n, self.n + 1)[:, : self.n] / rays[:, None]


def patch_views(scene: Any, patch_at: Callable[[Any], Any], patches: Patches, lamps: Sequence[LampLight]) -> PatchViews:
    """Shoot rays from the parts and follow them over two surfaces to a third, and from there one to every lamp.

    scene: of Mitsuba's. patch_at: gives the patches of interactions.
    """
    mi = backend.mitsuba()
    import drjit as dr

    rng, n = np.random.default_rng(1), len(patches.area)

    def uniform():
        return mi.Float(rng.random(PATCH_RAYS).astype(np.float32))

    def shot(start: Any, normal: Any, active: Any) -> tuple[Any, Any, Any]:
        onwards = mi.Frame3f(normal).to_world(mi.warp.square_to_cosine_hemisphere(mi.Point2f(uniform(), uniform())))
        start.n = mi.Normal3f(normal)
        si = scene.ray_intersect(start.spawn_ray(onwards), active=active)
        towards = dr.mulsign(mi.Vector3f(si.n), -dr.dot(si.n, onwards))
        return si, towards, dr.select(si.is_valid(), patch_at(si), n)

    starts = np.flatnonzero(patches.looked_at)
    chosen = rng.choice(starts, PATCH_RAYS, p=patches.area[starts] / patches.area[starts].sum())
    place = rng.integers(POINTS_ON_PATCH, size=PATCH_RAYS)
    start = dr.zeros(mi.SurfaceInteraction3f, PATCH_RAYS)
    start.t = mi.Float(1)
    start.p, normal = (
        mi.Point3f(np.ascontiguousarray(a[chosen, place].T, np.float32)) for a in (patches.position, patches.normal)
    )
    # From either side, since meshes may be turned inside out; what meets its own body may be shut in there.
    normal = dr.select(uniform() < 0.5, 1, -1) * mi.Vector3f(normal)
    body = patches.body
    first, normal, patch = shot(start, normal, mi.Bool(True))
    met = dr.gather(mi.UInt32, mi.UInt32(body.astype(np.uint32)), patch, patch < n)
    free = (patch < n) & (first.t > NARROW)
    if len(np.unique(body)) > 1:
        free &= met != mi.UInt32(body[chosen].astype(np.uint32))
    second, normal, from_patch = shot(first, normal, free)
    si, normal, to_patch = shot(second, normal, from_patch < n)
    direct = dr.zeros(mi.Float, len(si.t))
    for lamp in lamps:
        place, direction, density = lamp.connection(si.p, uniform(), uniform())
        cosine = dr.dot(normal, direction)
        lit = si.is_valid() & (cosine > 0) & (density > 0)
        lit &= ~scene.ray_test(si.spawn_ray_to(place), active=lit)
        direct += dr.select(lit, dr.inv_pi * cosine * lamp.radiance / density, 0)
    left = np.flatnonzero(from_patch.numpy() < n)
    kept = mi.UInt32(left.astype(np.uint32))
    position, normal = (dr.gather(mi.Vector3f, a, kept) for a in (mi.Vector3f(si.p), normal))
    dr.eval(position, normal)
    patch = [a.numpy().astype(int)[left] for a in (from_patch, to_patch)]
    views = PatchViews(n, patch[0], patch[1], mi.Point3f(position), normal, np.zeros((n, n)))
    return replace(views, by_lamps=views.seen(direct.numpy()[left]))
