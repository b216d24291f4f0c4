"""What pose and true depth say together: where every pixel's point lies, and which holes geometry alone explains."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import RigidTransform

from render.labels.causes import Cause
from render.labels.geometric import near
from render.world.rig import Rig
from scenes.scene import Body
from studies.dataset.check.images import DEPTH_TRUE_ROUNDING, Images, LayerFault
from studies.dataset.format.layers import decoded_layer

PLACE_ROUNDING = 2e-4
"""Of a point from stored true depth [m]: 0.05 mm along Z, up to 1.3 times that along the ray, and float32."""
EDGE_PX = 0.1
"""A point this near the right image's edge may fall on either side by the rounding of true depth [px]."""
TABLE_BODY = "table"
"""Name of the body whose points lie on the faces of a box."""


def place_faults(images: Images, bodies: tuple[Body, ...], pose: RigidTransform, rig: Rig) -> Iterator[LayerFault]:
    """Every pixel's point lies in the box around its body; the table's, on the box itself."""
    body, k = images["body"], rig.intrinsics
    if body.max() > len(bodies):
        return
    z = decoded_layer("depth_true", images["depth_true"])
    rays = k.pixel_directions().astype(np.float32)
    x, y = z * rays[..., 0], z * rays[..., 1]
    outside = np.full(body.shape, -np.inf, np.float32)
    turn, origin = pose.rotation.as_matrix().astype(np.float32), pose.translation.astype(np.float32)
    for axis in range(3):
        point = turn[axis, 0] * x + turn[axis, 1] * y + turn[axis, 2] * z + origin[axis]
        low, high = (
            np.array([wide, *(extreme(b.mesh.vertices[:, axis]) for b in bodies)], np.float32)
            for extreme, wide in ((np.min, -np.inf), (np.max, np.inf))
        )
        np.maximum(outside, np.maximum(low[body] - point, point - high[body]), out=outside)
    is_table = np.array([False, *(b.name == TABLE_BODY for b in bodies)])
    off = (outside > PLACE_ROUNDING) | (is_table[body] & (outside < -PLACE_ROUNDING))
    off &= z > 0
    if off.any():
        what = bodies[int(body[off][0]) - 1].name
        yield "depth_true", f"puts {np.count_nonzero(off)} points where, from this pose, {what} is not"


def cause_faults(images: Images, rig: Rig) -> Iterator[LayerFault]:
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
    """Nothing there, nearer than Min-Z, or beyond Max-Z."""
    nothing, margin = true == 0, DEPTH_TRUE_ROUNDING
    surely = (true < rig.min_z - margin) | (true > rig.max_z + margin)
    return nothing | surely, nothing | (true < rig.min_z + margin) | (true > rig.max_z - margin)


def _no_overlap(true: Float[np.ndarray, "h w"], rig: Rig) -> Maps:
    """Falls left of the right image, whose rows are the left one's."""
    shift = rig.focal_baseline / np.maximum(true, 1e-6)
    column = np.arange(true.shape[1]) - shift
    present = true > 0
    return present & (column < -0.5 - EDGE_PX), present & (column < -0.5 + EDGE_PX)
