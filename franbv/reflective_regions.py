"""Where the object reflects so that its depth is missing: four filters, clusters and boxes (paper, section V-A).

Three filters judge pixels in the image, each by itself; the fourth gives the remaining ones a place on the ellipsoids,
or refuses. Each is a plain function of what was seen, so that it can be scored by itself, left out or replaced.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_erosion
from sklearn.cluster import DBSCAN

from franbv.ellipsoids import Ellipsoids
from franbv.geometry.oriented_box import OrientedBox, oriented_box
from franbv.geometry.ray_hits import first_hit_depths
from franbv.parameters import Parameters
from franbv.projection import in_camera_frame, silhouette
from franbv.sensing import DepthBurst


@dataclass(frozen=True, eq=False)
class View:
    """A burst before the object as it is believed to be: all that a filter may look at.

    The ellipsoids are those with this burst in them. There is no infrared image and no truth in it: the paper's
    detector sees depth alone (section V-A).
    """

    burst: DepthBurst
    ellipsoids: Ellipsoids
    parameters: Parameters

    @cached_property
    def silhouette(self) -> Bool[np.ndarray, "h w"]:
        """I_o, the pixels of the projected ellipsoids; see `Parameters.silhouette_of`."""
        projected = self.ellipsoids if self.parameters.silhouette_of == "all" else self.ellipsoids.of_occupied()
        return silhouette(projected, self.burst.intrinsics, self.burst.T_world_cam)


Filter = Callable[[View], Bool[np.ndarray, "h w"]]
"""Which pixels may be reflective."""
BoxOf = Callable[[Float[np.ndarray, "n 3"], float], OrientedBox]
"""(points [m], shortest side [m]) -> box around them."""
Locate = Callable[[View, Bool[np.ndarray, "h w"]], Float[np.ndarray, "n 3"]]
"""World points [m] of the given pixels, row by row; NaN for those that are refused."""


@dataclass(frozen=True, eq=False)
class Detection:
    """What one burst says about reflective regions, filter by filter (paper, section V-A, eqs. (6) to (10)).

    Only missing depth is looked at: false depth, which metal gives too, passes unseen. The confidence map and the
    silhouette are kept whichever filters were asked for. Points lie on ellipsoids and not on the surface, of which
    nothing was measured there. No side of a box is shorter than a voxel.
    """

    masks: dict[str, Bool[np.ndarray, "h w"]]
    """Pixels kept by each image filter by itself, by the filter's name."""
    confidence_map: Bool[np.ndarray, "h w"]
    """I, frequently invalid pixels; eq. (7)."""
    silhouette: Bool[np.ndarray, "h w"]
    """I_o, pixels of the projected ellipsoids."""
    candidates: Bool[np.ndarray, "h w"]
    """I_c, pixels that pass all image filters; eq. (8)."""
    retained: Bool[np.ndarray, "h w"]
    """Candidates that were given a place."""
    pixels: Int[np.ndarray, "n 2"]
    """(u, v) of the retained pixels, row by row."""
    points: Float[np.ndarray, "n 3"]
    """Their places, world frame [m]."""
    labels: Int[np.ndarray, "n"]
    """Index of the box that each point belongs to; -1 for noise."""
    boxes: tuple[OrientedBox, ...]
    """B_r, the regions, largest volume first."""


def invalid_share(depths: Float[np.ndarray, "n h w"]) -> Float[np.ndarray, "h w"]:
    """Share of the burst in which each pixel has no depth, eta(u, v); eq. (6).

    depths: Z-depth of n frames from one pose [m], 0 = invalid.
    """
    return np.mean(depths == 0, axis=0)


def persistent_invalid(view: View) -> Bool[np.ndarray, "h w"]:
    """First filter, the confidence map I: pixels that are invalid in half of the frames or more; eq. (7)."""
    return invalid_share(view.burst.depths) >= view.parameters.invalid_share


def inside_silhouette(view: View) -> Bool[np.ndarray, "h w"]:
    """Second filter, I_o: pixels within the object's silhouette."""
    return view.silhouette


def inside_eroded_silhouette(view: View) -> Bool[np.ndarray, "h w"]:
    """Third filter: pixels whose four neighbours are all in I_o; eq. (8). Outside the image counts as outside I_o."""
    return binary_erosion(view.silhouette, border_value=0)


FILTERS: Mapping[str, Filter] = {
    "persistent_invalid": persistent_invalid,
    "inside_silhouette": inside_silhouette,
    "inside_eroded_silhouette": inside_eroded_silhouette,
}
"""The paper's image filters in its order, by the name under which their masks are kept and scored."""


def located(view: View, pixels: Bool[np.ndarray, "h w"]) -> Float[np.ndarray, "n 3"]:
    """Fourth filter in the reading that `Parameters.located_on` names."""
    return LOCATES[view.parameters.located_on](view, pixels)


def first_hit_is_frontier(view: View, pixels: Bool[np.ndarray, "h w"]) -> Float[np.ndarray, "n 3"]:
    """Fourth filter: where a pixel's ray first meets an ellipsoid, if that one stands for frontier voxels."""
    points, first = first_hits(view, pixels)
    is_frontier = np.append(view.ellipsoids.is_frontier, False)  # the last one stands for no ellipsoid
    points[~is_frontier[first]] = np.nan
    return points


def first_hit_of_any(view: View, pixels: Bool[np.ndarray, "h w"]) -> Float[np.ndarray, "n 3"]:
    """The fourth filter without its frontier test: where a pixel's ray first meets any ellipsoid. For ablations."""
    return first_hits(view, pixels)[0]


def nearest_frontier_hit(view: View, pixels: Bool[np.ndarray, "h w"]) -> Float[np.ndarray, "n 3"]:
    """The fourth filter with the frontier's ellipsoids alone: occupied ones before them refuse nothing."""
    return first_hits(replace(view, ellipsoids=view.ellipsoids.of_frontier()), pixels)[0]


LOCATES: Mapping[str, Locate] = {
    "first_frontier": first_hit_is_frontier,
    "nearest_frontier": nearest_frontier_hit,
    "any": first_hit_of_any,
}
"""Readings of the fourth filter by the name that `Parameters.located_on` has for them."""


def first_hits(view: View, pixels: Bool[np.ndarray, "h w"]) -> tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "n"]]:
    """World points [m] where pixels' rays first meet an ellipsoid (NaN: nowhere) and its index (-1: none); eq. (9)."""
    rays = view.burst.intrinsics.pixel_directions()[pixels]
    if len(rays) == 0 or len(view.ellipsoids) == 0:
        return np.full((len(rays), 3), np.nan), np.full(len(rays), -1)
    depths = first_hit_depths(rays, *in_camera_frame(view.ellipsoids, view.burst.T_world_cam))
    depth = depths.min(axis=0)
    depth[np.isinf(depth)] = np.nan
    return view.burst.T_world_cam.apply(rays * depth[:, None]), np.argmin(depths, axis=0)


def detect_reflective_regions(
    burst: DepthBurst,
    ellipsoids: Ellipsoids,
    parameters: Parameters,
    filters: Mapping[str, Filter] = FILTERS,
    locate: Locate = located,
) -> Detection:
    """Regions of missing depth that are persistent, on the object, coherent and not reconstructed yet.

    ellipsoids: E_o and E_f, refitted with this burst in the map.
    filters: tests that a pixel must pass, by name; leave one out for an ablation.
    locate: gives the remaining pixels a place in the world or refuses them.
    """
    view = View(burst, ellipsoids, parameters)
    masks = {name: keeps(view) for name, keeps in filters.items()}
    candidates = np.ones(burst.depths.shape[1:], bool)
    for mask in masks.values():
        candidates &= mask
    points = locate(view, candidates)
    placed = np.isfinite(points).all(axis=1)
    retained = candidates.copy()
    retained[candidates] = placed
    labels, boxes = group_into_boxes(points[placed], parameters)
    return Detection(
        masks=masks,
        confidence_map=persistent_invalid(view),
        silhouette=view.silhouette,
        candidates=candidates,
        retained=retained,
        pixels=np.argwhere(retained)[:, ::-1],
        points=points[placed],
        labels=labels,
        boxes=boxes,
    )


def group_into_boxes(
    points: Float[np.ndarray, "n 3"], parameters: Parameters, box_of: BoxOf = oriented_box
) -> tuple[Int[np.ndarray, "n"], tuple[OrientedBox, ...]]:
    """Box index of each point (-1 = noise) and the boxes around the DBSCAN clusters, largest volume first.

    No side of a box is shorter than a voxel, so that a flat region has a volume. box_of: makes the boxes.
    """
    if len(points) < parameters.cluster_min_samples:
        return np.full(len(points), -1), ()
    radius = parameters.cluster_radius_voxels * parameters.voxel_size
    clusters = DBSCAN(eps=radius, min_samples=parameters.cluster_min_samples).fit_predict(points)
    boxes = [box_of(points[clusters == k], parameters.voxel_size) for k in range(clusters.max() + 1)]
    order = sorted(range(len(boxes)), key=lambda k: -boxes[k].volume)
    rank = np.full(len(boxes) + 1, -1)  # its last entry stands for label -1
    rank[order] = np.arange(len(boxes))
    return rank[clusters], tuple(boxes[k] for k in order)
