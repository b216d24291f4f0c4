"""Where depth is missing or false by reflection, told from depth and the map alone.

A pixel looks at the object where its ray comes below the hull of what was measured (`hull`). There

- missing depth is a reflective hole, unless geometry explains it: the surface is too steep for a matcher's window, or
  nearer than the camera measures, or the pixel stands beside others without depth past the rim, along the baseline,
  where what lies behind the object is hidden from the right imager;
- depth is false where it ends behind surface that several views confirmed, or where it passes the hull whole or ends
  deep within it, and that unsteadily: mirror images flicker from frame to frame, as what they show lies far off.

Neither is reflection's where surface like it is measured from aslant (`dull_surface`).

What depth alone cannot tell apart: a highlight that drowns a matte surface of which little is known yet is a hole as
well, and false depth that is wrong by less than a voxel and a half passes unseen. A part that is hollow under its hull
looks as a mirror would until views have confirmed what is in it.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import maximum_filter
from scipy.spatial import KDTree

from franbv.model import Model
from franbv.parameters import Parameters
from franbv.reflective_regions import Detection, group_into_boxes, invalid_share
from franbv.robust.dull_surface import measured_aslant, of_dull_surface, regions_of
from franbv.robust.evidence import with_scans
from franbv.robust.hull import ObjectHull, object_hull
from franbv.robust.hypothesis import SEEN_AT
from franbv.robust.object_pixels import ObjectPixels, object_pixels
from franbv.robust.settings import RobustSettings
from franbv.sensing import DepthBurst


@dataclass(frozen=True, eq=False)
class RobustDetection(Detection):
    """Regions of missing and of false depth, and where their surface probably is.

    `silhouette` are the pixels that look at the object, `candidates` those without depth or with a false one, and
    `retained` those of them whose surface the map does not hold yet: of these are the boxes.
    """

    holes: Bool[np.ndarray, "h w"]
    """Have no depth by reflection."""
    false_depth: Bool[np.ndarray, "h w"]
    """Have a depth that is wrong by reflection."""
    places: Float[np.ndarray, "h w 3"]
    """Where the surface of each candidate probably is, world frame [m]; NaN elsewhere."""
    uncertainty: Float[np.ndarray, "h w"]
    """Standard deviation of these places along the ray [m]; NaN elsewhere."""


def detect_robustly(
    burst: DepthBurst, model: Model, parameters: Parameters, min_z: float, settings: RobustSettings
) -> RobustDetection:
    """What a burst shows of reflection. model: with that burst in it; min_z: the least Z-depth that the camera measures
    [m]."""
    shape = burst.depths.shape[1:]
    hull = object_hull(with_scans(model.voxel_map), parameters, settings)
    if hull is None:
        nothing = np.zeros(shape, bool)
        return _detection(
            burst, nothing, nothing, nothing, _nowhere(shape), np.full(shape, np.nan), nothing, parameters
        )
    seen = object_pixels(burst, model, hull, parameters, settings)
    size = model.voxel_map.voxel_size
    inside = min(settings.least_inside_voxels * size, settings.least_inside_share * float(seen.deepest.max()))
    objects = seen.covered & (seen.deepest > inside) & ~too_near(burst, seen, min_z, settings, size)
    holes = objects & holes_of_reflection(seen, settings)
    deep = objects & (seen.deepest > settings.false_inside_voxels * size)
    false = deep & depth_that_contradicts(burst, seen, parameters, settings, size)
    places, uncertainty = probable_surface(burst, seen, hull, holes | false, settings, size)
    dull = dull_pixels(burst, model, hull, holes | false, places, settings)
    holes, false = holes & ~dull, false & ~dull
    places[dull], uncertainty[dull] = np.nan, np.nan
    missing = np.zeros(shape, bool)
    missing[holes | false] = not_in_map(places[holes | false], model)
    return _detection(burst, objects, holes, false, places, uncertainty, missing, parameters)


def too_near(
    burst: DepthBurst, seen: ObjectPixels, min_z: float, settings: RobustSettings, size: float
) -> Bool[np.ndarray, "h w"]:
    """Pixels whose surface lies nearer than the camera measures, by its Z-depth, where a matcher finds nothing or
    anything, whatever the surface is: by the map, or because missing depth borders on depth that is hardly more."""
    axis = burst.T_world_cam.rotation.as_matrix()[:, 2]
    by_map = seen.covered & (probable_lengths(seen, settings, size) * (seen.rays @ axis) < min_z)
    missing = seen.lengths == 0
    hardly_more = ~missing & (seen.lengths * (seen.rays @ axis) < settings.near_margin * min_z)
    regions = regions_of(missing & seen.covered)
    bordering = np.bincount(maximum_filter(regions, size=3)[hardly_more], minlength=int(regions.max()) + 1)
    bordering[0] = 0  # other pixels are in no region
    return by_map | (bordering >= settings.bordering)[regions]


def dull_pixels(
    burst: DepthBurst,
    model: Model,
    hull: ObjectHull,
    pixels: Bool[np.ndarray, "h w"],
    places: Float[np.ndarray, "h w 3"],
    settings: RobustSettings,
) -> Bool[np.ndarray, "h w"]:
    """Those of the pixels whose region lies on surface that is measured from aslant (`dull_surface`)."""
    grid, points = with_scans(model.voxel_map), places[pixels]
    normals = grid.normals_at(points)
    normals = np.where(np.any(normals, axis=1)[:, None], normals, hull.normals_at(points))
    faces_away = np.einsum("nk,nk->n", normals, burst.T_world_cam.translation - points) < 0
    normals[faces_away] *= -1.0
    return of_dull_surface(pixels, measured_aslant(model, points, normals, settings), settings)


def holes_of_reflection(seen: ObjectPixels, settings: RobustSettings) -> Bool[np.ndarray, "h w"]:
    """Pixels without depth that neither steepness nor the object's own stereo shadow explains."""
    past_rim = np.pad(~seen.covered & (seen.lengths == 0), ((0, 0), (1, 1)))
    beside = past_rim[:, :-2] | past_rim[:, 2:]  # along the baseline, however the camera is turned
    return seen.covered & (seen.lengths == 0) & ~beside & (seen.disparity_slope <= settings.steepest)


def depth_that_contradicts(
    burst: DepthBurst, seen: ObjectPixels, parameters: Parameters, settings: RobustSettings, size: float
) -> Bool[np.ndarray, "h w"]:
    """Depth behind confirmed surface, or where the hull says that it cannot be and unsteady. size: of a voxel [m]."""
    behind = settings.false_behind_voxels * size
    measured = seen.covered & (seen.lengths > 0)
    contradicts = measured & (seen.lengths > seen.farthest_surface + behind)
    passes = measured & (seen.lengths > seen.leaves + behind)
    agrees = np.abs(seen.lengths - seen.surface) < behind
    hollow = measured & ~passes & ~agrees & (seen.lengths > seen.entry + settings.hollow_voxels * size)
    on_table = seen.end_height < parameters.table_height + size
    least = np.where(on_table, settings.noisy_on_table, settings.noisy)
    noise = unsteadiness(burst, measured, settings)
    return contradicts | (passes & (noise > settings.noisy_beyond)) | (hollow & (noise > least))


def unsteadiness(
    burst: DepthBurst, pixels: Bool[np.ndarray, "h w"], settings: RobustSettings
) -> Float[np.ndarray, "h w"]:
    """Spread of each pixel's depth over the frames, over that of noise [-]: the median of those around it that count,
    since mirror images come in patches; 0 where none does."""
    valid = burst.depths > 0
    count = np.maximum(valid.sum(axis=0), 1)
    mean = burst.depths.sum(axis=0) / count
    spread = np.sqrt((np.where(valid, burst.depths - mean, 0.0) ** 2).sum(axis=0) / count)
    noise = np.maximum(settings.depth_noise * mean**2, np.finfo(float).tiny)
    padded = np.pad(np.where(pixels, spread / noise, np.nan), 1, constant_values=np.nan)
    height, width = pixels.shape
    around = np.stack([padded[r : r + height, c : c + width] for r, c in np.ndindex(3, 3)])
    found = np.zeros(pixels.shape)
    found[pixels] = np.nanmedian(around[:, pixels], axis=0)
    return found


def probable_surface(
    burst: DepthBurst,
    seen: ObjectPixels,
    hull: ObjectHull,
    pixels: Bool[np.ndarray, "h w"],
    settings: RobustSettings,
    size: float,
) -> tuple[Float[np.ndarray, "h w 3"], Float[np.ndarray, "h w"]]:
    """Places of the pixels' surface [m], and their standard deviation [m]; NaN elsewhere."""
    places, uncertainty = _nowhere(pixels.shape), np.full(pixels.shape, np.nan)
    lengths = probable_lengths(seen, settings, size)[pixels]
    points = burst.T_world_cam.translation + lengths[:, None] * seen.rays[pixels]
    places[pixels] = points
    gap = KDTree(hull.measured).query(points)[0] if len(points) else np.zeros(0)
    uncertainty[pixels] = size / 2 + settings.sag * gap
    return places, uncertainty


def probable_lengths(seen: ObjectPixels, settings: RobustSettings, size: float) -> Float[np.ndarray, "h w"]:
    """Length of each ray to its surface [m]: the confirmed one that it meets, if that was measured from this side or
    lies near the hull; else the hull."""
    front = seen.faces_camera | (seen.surface < seen.entry + settings.at_hull_voxels * size)
    return np.where(front, seen.surface, seen.entry)


def not_in_map(points: Float[np.ndarray, "n 3"], model: Model) -> Bool[np.ndarray, "n"]:
    """Places at which the map holds no surface of the object yet."""
    if not len(model.object.occupied) or not len(points):
        return np.ones(len(points), bool)
    return KDTree(model.object.occupied).query(points)[0] > SEEN_AT * model.voxel_map.voxel_size


def _detection(
    burst: DepthBurst,
    objects: Bool[np.ndarray, "h w"],
    holes: Bool[np.ndarray, "h w"],
    false: Bool[np.ndarray, "h w"],
    places: Float[np.ndarray, "h w 3"],
    uncertainty: Float[np.ndarray, "h w"],
    missing: Bool[np.ndarray, "h w"],
    parameters: Parameters,
) -> RobustDetection:
    found = holes | false
    retained = found & missing
    labels, boxes = group_into_boxes(places[retained], parameters)
    return RobustDetection(
        masks={"looks_at_object": objects, "missing_or_false": found},
        confidence_map=invalid_share(burst.depths) >= parameters.invalid_share,
        silhouette=objects,
        candidates=found,
        retained=retained,
        pixels=np.argwhere(retained)[:, ::-1],
        points=places[retained],
        labels=labels,
        boxes=boxes,
        holes=holes,
        false_depth=false,
        places=places,
        uncertainty=uncertainty,
    )


def _nowhere(shape: tuple[int, ...]) -> Float[np.ndarray, "h w 3"]:
    return np.full((*shape, 3), np.nan)
