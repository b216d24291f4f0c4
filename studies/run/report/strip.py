"""One acquisition as a row of four small pictures: infrared, depth, invalid pixels, detected regions over ellipses."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, UInt8
from markupsafe import Markup

from franbv.frames import project
from franbv.geometry.projected_box import convex_hull
from franbv.projection import NEAR, dual_conics, ellipses, in_camera_frame
from studies.drawing import svg
from studies.store.images import coloured_depth, data_uri, photo_uri
from studies.store.views import StoredView

GREY_INVALID, GREY_VALID = 60, 232
"""Grey values of pixels without and with depth. Choice: dark holes on a light ground."""


@dataclass(frozen=True)
class Strip:
    """The pictures of one acquisition."""

    infrared: str
    """Data URI; empty when the sensor gave none."""
    depth: str
    """Data URI."""
    depth_near: float
    """Brightest colour [m]."""
    depth_far: float
    """Darkest colour [m]."""
    invalid: str
    """Data URI."""
    regions: Markup
    """SVG."""


def strip(view: StoredView, infrared: UInt8[np.ndarray, "h w"] | None) -> Strip:
    """The four pictures of one acquisition."""
    near, far = depth_range(view)
    return Strip(
        infrared="" if infrared is None else photo_uri(infrared),
        depth=data_uri(coloured_depth(view.depth, near, far)),
        depth_near=near,
        depth_far=far,
        invalid=data_uri(invalid_picture(view)),
        regions=regions_picture(view),
    )


def depth_range(view: StoredView) -> tuple[float, float]:
    """Nearest and farthest depth of the object's ellipsoids [m]; without any from half to twice the median depth of the
    silhouette, and of all pixels while there is none.

    The pixels themselves would not do: false depth and the room behind the object would use up the colours.
    """
    centres, shapes = in_camera_frame(view.ellipsoids, view.pose)
    if len(centres):
        reach = np.sqrt(shapes[:, 2, 2])
        return float(max((centres[:, 2] - reach).min(), 0.0)), float((centres[:, 2] + reach).max())
    inside = view.depth[(view.depth > 0) & view.silhouette]
    if len(inside):
        middle = float(np.median(inside))
        return middle / 2, 2 * middle
    valid = view.depth[view.depth > 0]
    return (float(valid.min()), float(valid.max())) if len(valid) else (0.0, 1.0)


def invalid_picture(view: StoredView) -> UInt8[np.ndarray, "h w 3"]:
    """Valid pixels light, invalid ones dark, inside the silhouette red, kept as reflective orange."""
    picture = np.full((*view.invalid.shape, 3), GREY_VALID, np.uint8)
    picture[view.invalid] = GREY_INVALID
    picture[view.invalid & view.silhouette] = (150, 88, 92)
    picture[view.candidates] = (196, 54, 58)
    picture[view.reflective] = (240, 150, 30)
    return picture


def regions_picture(view: StoredView) -> Markup:
    """The projected ellipsoids in outline, invalid pixels grey, reflective pixels filled, boxes of the regions."""
    camera = view.intrinsics
    box = f"-0.5 -0.5 {camera.width} {camera.height}"
    outlines = [ellipse(*shape) for shape in projected_ellipses(view)]
    hulls = [box_outline(box.corners(), view) for box in view.regions]
    regions = [
        svg.element("polygon", points=" ".join(f"{u:.2f},{v:.2f}" for u, v in hull), klass="region")
        for hull in hulls
        if len(hull) > 2
    ]
    pixels = svg.join(_pixels(view.invalid & ~view.reflective, "hole"), _pixels(view.reflective, "reflective"))
    return svg.element("svg", svg.join(pixels, *outlines, *regions), viewBox=box, klass="overlay", role="img")


def projected_ellipses(view: StoredView) -> list[tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2 2"], str]]:
    """Centre [px], shape [px^2] and kind of each ellipsoid's ellipse; those around or behind the camera have none."""
    centres, shapes = in_camera_frame(view.ellipsoids, view.pose)
    in_front = centres[:, 2] - np.sqrt(shapes[:, 2, 2]) > NEAR
    means, covariances = ellipses(dual_conics(centres[in_front], shapes[in_front], view.intrinsics))
    kinds = np.where(view.ellipsoid_is_frontier[in_front], "frontier", "occupied")
    return list(zip(means, covariances, kinds.tolist(), strict=True))


def ellipse(mean: Float[np.ndarray, "2"], shape: Float[np.ndarray, "2 2"], klass: str) -> Markup:
    """The ellipse (x - mean)^T shape^-1 (x - mean) = 1."""
    squares, axes = np.linalg.eigh(shape)
    rx, ry = np.sqrt(np.maximum(squares, 0))
    turn = np.degrees(np.arctan2(axes[1, 0], axes[0, 0]))
    where = f"translate({mean[0]:.2f} {mean[1]:.2f}) rotate({turn:.1f})"
    return svg.element("ellipse", rx=float(rx), ry=float(ry), transform=where, klass=klass)


def box_outline(corners: Float[np.ndarray, "8 3"], view: StoredView) -> Float[np.ndarray, "n 2"]:
    """Outline of a box in the image [px]; empty when it reaches behind the camera."""
    pixels = project(view.pose.inv().apply(corners), view.intrinsics)
    return np.zeros((0, 2)) if np.isnan(pixels).any() else convex_hull(pixels)


def _pixels(mask: Bool[np.ndarray, "h w"], klass: str) -> Markup:
    """Unit squares as one path: a run of neighbours in a row is one rectangle."""
    steps = []
    for v, row in enumerate(mask):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], row.astype(np.int8), [0]])))
        steps += [f"M{u0 - 0.5:g} {v - 0.5:g}h{u1 - u0}v1h{u0 - u1}z" for u0, u1 in edges.reshape(-1, 2)]
    return svg.element("path", d="".join(steps), klass=klass) if steps else Markup("")
