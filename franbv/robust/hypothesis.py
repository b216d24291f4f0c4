"""What is left to be measured: surface that has too few points, and surface that nobody has found yet.

Where the object's voxels touch unknown ones that touch free ones, surface goes on: the frontier of Yamauchi (1997), as
the paper has it.

A voxel of the object with few points in it is covered in part: if n points fell on its area a by chance, the share
exp(-n pi r^2 / a) of it would be farther than r from all of them (Chiu, Stoyan, Kendall and Mecke, Stochastic Geometry
and its Applications, 2013, section 3.1: the void probability of a Poisson process).

A mirror that was looked at from the wrong side leaves no hole: it shows what it reflects, and the map calls its place
free. What is confirmed stands on something, though, and is closed. The hull of the object's voxels and of their shadow
on the table is the simplest surface that closes it; where no measured voxel lies at the hull, something is left to be
seen, along its normal above all. Of a concave part the hull spans air: a ray that passes it and ends on confirmed
surface of the object says so.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import uniform_filter
from scipy.spatial import ConvexHull, KDTree, QhullError
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.model import Model
from franbv.parameters import Parameters
from franbv.robust.evidence import INCIDENCE_DEG, N_TURNS, EvidenceMap, incidence_range, with_scans
from franbv.robust.rays import cells_of, first_surfaces
from franbv.robust.settings import RobustSettings
from franbv.voxel_map import extent

MOST_ELEMENTS = 1500
"""Elements of the surface (choice: a centimetre apart on a part of 20 cm)."""
UNDERSIDE = -0.5
"""Elements whose normal's height is below this look at what the part stands on and are left out [-] (choice)."""
MOST_AT_RIM = 6
"""Occupied neighbours of a voxel where measured surface ends (choice: on a straight rim it has 3, in a corner up to 6;
in a gap of a layer 8, behind one 9)."""
LEAST_LEFT = 0.02
"""Of a measured element that must be left for it to count [-] (choice: what three points in a voxel leave)."""
SEEN_AT = 1.5
"""An element is measured if an occupied voxel of the object lies nearer than this [s_v] (choice: a voxel and a half,
the hull runs through the voxels' centres)."""


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """Elements of surface that are still to be measured, or to be measured more densely."""

    places: Float[np.ndarray, "n 3"]
    """World [m]."""
    normals: Float[np.ndarray, "n 3"]
    """Outward."""
    areas: Float[np.ndarray, "n"]
    """[m^2]"""
    unfound: Bool[np.ndarray, "n"]
    """Elements of hull and frontier, where nothing was measured; the others are measured and have too few points."""
    left: Float[np.ndarray, "n"]
    """Share of each that no point covers yet, or the chance that there is surface where none was found [0, 1]."""
    looks: Float[np.ndarray, "n 2 b"]
    """Views that have looked at each in vain, by turn of the camera and range of incidence."""
    chances: Float[np.ndarray, "2 b"]
    """That a view measures surface, by turn of the camera and range of incidence [0, 1]."""
    surface_area: float
    """Of all that is measured or supposed, measured densely or not [m^2]."""


def hypothesis(model: Model, parameters: Parameters, settings: RobustSettings) -> Hypothesis:
    """What is still to be measured of a model."""
    grid = with_scans(model.voxel_map)
    places, normals, areas = _supposed_elements(model, grid, parameters)
    looks, pixels, refuted = _looks(grid, places, normals, parameters, settings)
    places, normals, areas, looks = places[~refuted], normals[~refuted], areas[~refuted], looks[~refuted]
    chances = success_chances(grid, np.tensordot(areas, pixels[~refuted], 1), settings)
    there = still_supposed(looks, chances, settings)
    known, towards, left, measured = _measured_elements(model, grid, settings)
    return Hypothesis(
        np.concatenate([places, known]),
        np.concatenate([normals, towards]),
        np.concatenate([areas, np.full(len(known), grid.voxel_size**2)]),
        np.arange(len(places) + len(known)) < len(places),
        np.concatenate([there, left]),
        np.concatenate([looks, np.zeros((len(known), *looks.shape[1:]))]),
        chances,
        float(areas @ there) + measured,
    )


def _supposed_elements(
    model: Model, grid: EvidenceMap, parameters: Parameters
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"], Float[np.ndarray, "n"]]:
    """Places, outward normals and areas [m^2] of surface that nobody has measured: the object's frontier, and the hull
    where neither an occupied voxel nor the frontier is near."""
    frontier = model.object.frontier
    places, normals, area = _hull_elements(model, parameters)
    keep = normals[:, 2] > UNDERSIDE
    known = np.concatenate([model.object.occupied, frontier])
    if len(known):
        keep &= KDTree(known).query(places)[0] > SEEN_AT * grid.voxel_size
    towards_free = _frontier_normals(grid, frontier)
    turned = np.any(towards_free, axis=1) & (towards_free[:, 2] > UNDERSIDE)
    return (
        np.concatenate([places[keep], frontier[turned]]),
        np.concatenate([normals[keep], towards_free[turned]]),
        np.concatenate([np.full(int(keep.sum()), area), np.full(int(turned.sum()), grid.voxel_size**2)]),
    )


def _frontier_normals(grid: EvidenceMap, frontier: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Unit vectors from each voxel towards the free ones among its 26 neighbours; 0 where they lie all around, and in
    gaps between measured voxels or behind them, which more points on those will close."""
    steps = np.stack(np.meshgrid(*[(-1.0, 0.0, 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    near = frontier[:, None] + grid.voxel_size * steps
    free, occupied = (
        grid.lookup(mask, near.reshape(-1, 3)).reshape(len(frontier), len(steps)) for mask in (grid.free, grid.occupied)
    )
    sums = (free & (occupied.sum(axis=1, keepdims=True) <= MOST_AT_RIM)) @ steps
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.divide(sums, length, out=np.zeros_like(sums), where=length > 0)


def missing_share(model: Model, left: Hypothesis, settings: RobustSettings) -> float:
    """Share of the surface that is expected to lie farther than the resolution from every point [0, 1].

    Points of neighbouring voxels cover as well, so that of measured voxels the mean of the 27 around each counts.
    """
    if left.surface_area == 0:
        return 1.0
    grid = with_scans(model.voxel_map)
    index, _ = grid.indices(model.object.occupied)
    near = extent(grid.occupied, margin=1)
    at = tuple((index - [part.start for part in near]).T)
    occupied = grid.occupied[near].astype(float)
    points = np.where(grid.occupied, grid.points, 0.0)[near]
    density = uniform_filter(points, 3, mode="constant")[at] / uniform_filter(occupied, 3, mode="constant")[at]
    area = grid.voxel_size**2
    sparse = area * np.exp(-density * np.pi * settings.resolution**2 / area).sum()
    return float((left.areas[left.unfound] @ left.left[left.unfound] + sparse) / left.surface_area)


def success_chances(
    grid: EvidenceMap, in_vain: Float[np.ndarray, "2 b"], settings: RobustSettings
) -> Float[np.ndarray, "2 b"]:
    """Mean of the beta distribution of each turn and range, which begins as Beta(1, 1).

    Where surface was never measured, nobody knows that views of it failed: pixels that looked in vain at what the hull
    supposes count as failures by the chance that there is surface.
    """
    failed = grid.failures + settings.supposed * in_vain
    successes, failures = grid.successes / settings.pixels_per_trial, failed / settings.pixels_per_trial
    return (1.0 + successes) / (2.0 + successes + failures)


def still_supposed(
    looks: Float[np.ndarray, "n 2 b"], chances: Float[np.ndarray, "2 b"], settings: RobustSettings
) -> Float[np.ndarray, "n"]:
    """Chance that there is surface after looks in vain, by Bayes: views that would have measured it speak against it.

    A mirror, which `RobustSettings.mirrors` of all places are, would not have been measured but face on, where it is as
    any other surface; so it is in each turn of the camera by itself.
    """
    missed = looks * np.log1p(-chances)
    as_mirror, as_other = np.exp(missed[..., 0]), np.exp(missed.sum(axis=-1))
    likelihood = settings.supposed * np.prod(
        settings.mirrors * as_mirror + (1.0 - settings.mirrors) * as_other, axis=-1
    )
    return likelihood / (likelihood + 1.0 - settings.supposed)


def _measured_elements(
    model: Model, grid: EvidenceMap, settings: RobustSettings
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"], Float[np.ndarray, "n"], float]:
    """Places and normals of the object's voxels that more points would cover better, the share that is left of each,
    and the area of all the object's voxels [m^2]; none of a map without scans, which does not know its points."""
    places = model.object.occupied if grid.scans else np.zeros((0, 3))
    at = tuple(grid.indices(places)[0].T)
    area = grid.voxel_size**2
    left = np.exp(-grid.points[at].astype(float) * np.pi * settings.resolution**2 / area)
    sparse = (left > LEAST_LEFT) & (grid.normals[at][:, 2] > UNDERSIDE)
    return places[sparse], grid.normals[at][sparse].astype(float), left[sparse], len(places) * area


def _hull_elements(
    model: Model, parameters: Parameters
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"], float]:
    """Points spread evenly over the hull, outward normals, area of each [m^2]."""
    corners = model.object.occupied
    if len(corners) >= 4:
        shadow = corners.copy()
        shadow[:, 2] = parameters.table_height
        corners = np.concatenate([corners, shadow])
    else:
        corners = model.object.box.corners()
    try:
        hull = ConvexHull(corners)
    except QhullError:  # all in a plane, before anything stands up
        corners = model.object.box.corners()
        hull = ConvexHull(corners)
    triangles = corners[hull.simplices]
    sizes = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1) / 2
    rng = np.random.default_rng(0)
    n = int(np.clip(sizes.sum() / model.voxel_map.voxel_size**2, 1, MOST_ELEMENTS))
    chosen = rng.choice(len(sizes), n, p=sizes / sizes.sum())
    root, along = np.sqrt(rng.random((n, 1))), rng.random((n, 1))
    one, two, three = (triangles[chosen, i] for i in range(3))
    places = (1 - root) * one + root * (1 - along) * two + root * along * three
    return places, hull.equations[chosen, :3], float(sizes.sum() / n)


def _looks(
    grid: EvidenceMap,
    places: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    parameters: Parameters,
    settings: RobustSettings,
) -> tuple[Float[np.ndarray, "n 2 b"], Float[np.ndarray, "n 2 b"], Bool[np.ndarray, "n"]]:
    """How often scans looked at each element, with how many pixels on a square metre, and whether one looked through it
    onto confirmed surface."""
    looks, pixels = np.zeros((2, len(places), N_TURNS, len(INCIDENCE_DEG) - 1))
    refuted = np.zeros(len(places), bool)
    if not grid.scans:
        return looks, pixels, refuted
    views, intrinsics = RigidTransform.concatenate([scan.T_world_cam for scan in grid.scans]), grid.scans[0].intrinsics
    seen, cosine, distance, pixel = visible(grid, views, intrinsics, places, normals, settings)
    ranges, density = incidence_range(cosine), pixel_density(intrinsics, cosine, distance)
    for number, scan in enumerate(grid.scans):
        which = np.flatnonzero(seen[number])
        looks[which, scan.turn, ranges[number, which]] += 1.0
        pixels[which, scan.turn, ranges[number, which]] += density[number, which]
        lengths = scan.lengths[pixel[number, which]]
        ends = scan.T_world_cam.translation + lengths[:, None] * scan.rays[pixel[number, which]]
        beyond = lengths > distance[number, which] + settings.contradiction_voxels * grid.voxel_size
        above = ends[:, 2] > parameters.table_height + parameters.table_clearance
        refuted[which] |= beyond & above & grid.lookup(grid.confirmed, ends)
    return looks, pixels, refuted


def pixel_density(
    intrinsics: Intrinsics, cosine: Float[np.ndarray, "*n"], distance: Float[np.ndarray, "*n"]
) -> Float[np.ndarray, "*n"]:
    """Pixels on a square metre of surface, about the middle of the image."""
    return intrinsics.fx * intrinsics.fy * np.maximum(cosine, 0.0) / distance**2


def visible(
    grid: EvidenceMap,
    poses: RigidTransform,
    intrinsics: Intrinsics,
    places: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    settings: RobustSettings,
) -> tuple[Bool[np.ndarray, "p n"], Float[np.ndarray, "p n"], Float[np.ndarray, "p n"], Int[np.ndarray, "p n"]]:
    """Elements within each of several views that face it and that no confirmed surface hides; cosine of the incidence,
    distance [m], and the pixel of each, which is 0 outside the view."""
    eyes = poses.translation
    towards = eyes[:, None] - places
    distance = np.linalg.norm(towards, axis=-1)
    cosine = np.sum(towards * normals, axis=-1) / distance
    camera = -towards @ poses.rotation.as_matrix()
    z = np.where(camera[..., 2] > 0, camera[..., 2], np.inf)
    u = np.rint(intrinsics.fx * camera[..., 0] / z + intrinsics.cx)
    v = np.rint(intrinsics.fy * camera[..., 1] / z + intrinsics.cy)
    seen = (camera[..., 2] > 0) & (cosine > settings.least_cosine)
    seen &= (u >= 0) & (u < intrinsics.width) & (v >= 0) & (v < intrinsics.height)
    pixel = np.where(seen, v * intrinsics.width + u, 0).astype(np.int64)
    rays = -towards[seen] / distance[seen][:, None] / grid.voxel_size
    origins = cells_of(eyes, grid.first, grid.voxel_size)[np.nonzero(seen)[0]]
    reach = distance[seen] - SEEN_AT * grid.voxel_size
    hidden = first_surfaces(grid.surface, origins, rays, settings.least_cosine, reach)[0]
    seen[seen] = ~np.isfinite(hidden)
    return seen, cosine, distance, pixel
