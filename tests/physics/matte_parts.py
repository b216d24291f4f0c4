"""What the camera makes of matte parts on a matte table, where nothing but geometry may cost depth."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool

from franbv.frames import look_at
from materials.material import Matte
from render.d435i import SensorSettings, SimulatedD435i
from render.labels.causes import Cause
from render.labels.geometric import geometry, in_projector_field
from render.labels.outcome import is_false_depth
from render.labels.twin import twin_scene
from scenes.build import part_scene

HALO_PX = 4
"""Left out around what is hidden: a census window reaches 4 px over an edge."""
ELEVATION_DEG = 45.0
"""Of the camera over the table, as in the planner's first view."""
DISTANCES = (0.2, 0.3, 0.4, 0.6)
"""From the camera to the middle of the part [m]: a recovery pose to a far candidate."""

RANGE = (0.2, 0.6)
"""True Z-depths that count [m]: the camera sees the room behind the table too, where this is not about."""


@dataclass(frozen=True)
class MatteShares:
    """Of table and part within RANGE, away from what no matcher could measure; `*_part` on the part alone."""

    filled: float
    false: float
    """Depth more than 5 mm (or three sigma of the noise law) off, as share of the pixels that have any."""
    filled_part: float
    false_part: float


def matte_shares(part: str, distance: float, seed: int = 1) -> MatteShares:
    """Measure one frame of the part, all its bodies and the table diffuse, from `distance` [m]."""
    scene = twin_scene(part_scene(part, table_material=Matte("table", 0.5)))
    corners = np.concatenate([body.mesh.vertices for body in scene.bodies if body.is_part])
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    up = np.radians(ELEVATION_DEG)
    pose = look_at(middle + distance * np.array([np.cos(up), 0.0, np.sin(up)]), middle)
    camera = SimulatedD435i(scene, SensorSettings(crop=None), seed)
    depth, truth = camera.measure(pose, 1).depths[0], camera.truth(pose)
    reached = in_projector_field(camera.rig, truth.depth)
    # Range, overlap and occlusion by ray tests against the meshes; beyond the projector's field there are no dots.
    measurable = away_from((geometry(camera, truth).impossible != Cause.MEASURED) | ~reached)
    false = is_false_depth(depth, truth.depth, camera.rig.focal_baseline)
    parts = [i for i, body in enumerate(scene.bodies) if body.is_part]
    table = [i for i, body in enumerate(scene.bodies) if body.name == "table"]
    measurable &= (truth.depth >= RANGE[0]) & (truth.depth <= RANGE[1]) & np.isin(truth.body, parts + table)
    on_part, valid = measurable & np.isin(truth.body, parts), depth > 0
    return MatteShares(
        float(valid[measurable].mean()),
        float(false[measurable & valid].mean()),
        float(valid[on_part].mean()),
        float(false[on_part & valid].mean()),
    )


def away_from(mask: Bool[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Pixels farther than HALO_PX from the mask."""
    return cv2.dilate(mask.astype(np.uint8), np.ones((2 * HALO_PX + 1,) * 2, np.uint8)) == 0
