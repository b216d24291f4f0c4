"""Names under which things stand in the viewer: paths of its tree, and its timeline."""

TIMELINE = "acquisition"
"""Its steps are the numbers of the acquisitions, from 0."""
APPLICATION = "franbv"
"""What the viewer groups runs by."""


class Entity:
    """Paths of the viewer's tree; what stands below `WORLD` is drawn in space."""

    WORLD = "world"
    CLOUD = "world/cloud"
    OCCUPIED = "world/voxels/occupied"
    FRONTIER = "world/voxels/frontier"
    OCCUPIED_ELLIPSOIDS = "world/ellipsoids/occupied"
    FRONTIER_ELLIPSOIDS = "world/ellipsoids/frontier"
    REGIONS = "world/reflective_regions"
    RECOVERY_POSES = "world/recovery_poses"
    WAY = "world/way"
    CAMERA = "world/camera"
    LENS = "world/camera/lens"
    DEPTH = "world/camera/lens/depth"
    INFRARED = "infrared"
    LOG = "log"
    CURVES = "curves"
