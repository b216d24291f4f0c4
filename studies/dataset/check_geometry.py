"""What pose and true depth say together: where every pixel's point lies, and which holes geometry alone explains."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import RigidTransform

from render.causes import Cause
from render.geometric_causes import near
from render.rig import Rig
from scenes.scene import Body
from studies.dataset.check_images import DEPTH_TRUE_ROUNDING, Fault, Images
from studies.dataset.layers import decoded_layer

PLACE_ROUNDING = 2e-4
"""Of a point from stored true depth [m]: 0.05 mm along Z, up to 1.3 times that along the ray, and float32."""
EDGE_PX = 0.1
"""A point this near the right image's edge may fall on either side by the rounding of true depth [px]."""
TABLE = "table"
"""Name of the body whose points lie on the faces of a box."""


def place_faults(images: Images, bodies: tuple[Body, ...], pose: RigidTransform, rig: Rig) -> Iterator[Fault]:
    """Every pixel's point lies in the box around its body; the table's, on the box itself."""
    body = images["body"]
    there = (body > 0) & (images["depth_true"] > 0)
    if body.max() > len(bodies) or not there.any():
        return
    true = decoded_layer("depth_true", images["depth_true"])[there]
    points = pose.apply(rig.intrinsics.pixel_directions()[there] * true[:, None])
    number = body[there] - 1
    low, high = (np.array([extreme(b.mesh.vertices, axis=0) for b in bodies]) for extreme in (np.min, np.max))
    outside = np.maximum(low[number] - points, points - high[number]).max(axis=1)
    off = outside > PLACE_ROUNDING
    for place in (place for place, b in enumerate(bodies) if b.name == TABLE):
        off |= (number == place) & (outside < -PLACE_ROUNDING)
    if off.any():
        what = bodies[int(number[off][0])].name
        yield "depth_true", f"puts {np.count_nonzero(off)} points where, from this pose, {what} is not"


def cause_faults(images: Images, rig: Rig) -> Iterator[Fault]:
    """Holes out of range or beyond the right image are called so, and others only near such points."""
    cause, true = images["cause"], decoded_layer("depth_true", images["depth_true"]).astype(float)
    beyond, maybe_beyond = _out_of_range(true, rig)
    alone, maybe_alone = _no_overlap(true, rig)
    for called, sure, possible in (
        (Cause.OUT_OF_RANGE, beyond, maybe_beyond),
        (Cause.NO_OVERLAP, alone & ~maybe_beyond, maybe_alone),  # what is out of range comes first
    ):
        if np.any((cause == called) & ~near(possible)):
            yield "cause", f"calls holes {called.name.lower()} where true depth says that they are not"
        if np.any((cause > 0) & sure & (cause != called)):
            yield "cause", f"calls holes otherwise that by true depth are {called.name.lower()}"


Maps = tuple[Bool[np.ndarray, "h w"], Bool[np.ndarray, "h w"]]
"""Where something surely holds, and where it may for all that rounding leaves."""


def _out_of_range(true: Float[np.ndarray, "h w"], rig: Rig) -> Maps:
    """Nothing there, or nearer than Min-Z; Max-Z is infinite."""
    nothing, margin = true == 0, DEPTH_TRUE_ROUNDING
    return nothing | (true < rig.min_z - margin), nothing | (true < rig.min_z + margin)


def _no_overlap(true: Float[np.ndarray, "h w"], rig: Rig) -> Maps:
    """Falls left of the right image, whose rows are the left one's."""
    shift = rig.focal_baseline / np.maximum(true, 1e-6)
    column = np.arange(true.shape[1]) - shift
    present = true > 0
    return present & (column < -0.5 - EDGE_PX), present & (column < -0.5 + EDGE_PX)
