"""What a run keeps of each acquisition, beside its row in the table: masks, ellipsoids, regions and images.

`views/000.npz` holds the arrays of `StoredView`; `captures/000_ir.png` the left infrared image of the first frame.
"""

import io
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial.transform import RigidTransform

from franbv.ellipsoids import Ellipsoids
from franbv.frames import Intrinsics
from franbv.geometry.oriented_box import OrientedBox
from studies.base.atomic_file import write_atomically

VIEWS = "views"
"""Sub-folder of a case."""


@dataclass(frozen=True, eq=False)
class StoredView:
    """The planner's sight of one acquisition, after the new cloud is in the map."""

    T_world_cam: Float[np.ndarray, "4 4"]
    """Pose of the left imager as a matrix [m]."""
    camera: Float[np.ndarray, "6"]
    """width, height, fx, fy, cx, cy of the masks and of `depth` [px]."""
    depth: Float[np.ndarray, "h w"]
    """Median of the burst's valid frames, 0 = frequently invalid [m]."""
    invalid: Bool[np.ndarray, "h w"]
    """I, frequently invalid pixels."""
    silhouette: Bool[np.ndarray, "h w"]
    """I_o, pixels of the projected ellipsoids."""
    candidates: Bool[np.ndarray, "h w"]
    """I_c, invalid pixels well inside the silhouette."""
    reflective: Bool[np.ndarray, "h w"]
    """Candidates whose ray first meets a frontier ellipsoid."""
    ellipsoid_centres: Float[np.ndarray, "k 3"]
    """World frame [m]."""
    ellipsoid_shapes: Float[np.ndarray, "k 3 3"]
    """S of (x - c)^T S^-1 (x - c) <= 1, world frame [m^2]."""
    ellipsoid_is_frontier: Bool[np.ndarray, "k"]
    """Frontier or occupied."""
    region_centres: Float[np.ndarray, "r 3"]
    """Boxes B_r of the reflective regions, largest volume first, world frame [m]."""
    region_axes: Float[np.ndarray, "r 3 3"]
    """Columns are the boxes' unit axes."""
    region_half_extents: Float[np.ndarray, "r 3"]
    """Half sides along them [m]."""

    @property
    def pose(self) -> RigidTransform:
        """Of the left imager."""
        return RigidTransform.from_matrix(self.T_world_cam)

    @property
    def intrinsics(self) -> Intrinsics:
        """Of the masks."""
        width, height, fx, fy, cx, cy = (float(value) for value in self.camera)
        return Intrinsics(int(width), int(height), fx, fy, cx, cy)

    @property
    def ellipsoids(self) -> Ellipsoids:
        """E_o and E_f."""
        return Ellipsoids(self.ellipsoid_centres, self.ellipsoid_shapes, self.ellipsoid_is_frontier)

    @property
    def regions(self) -> list[OrientedBox]:
        """B_r, largest volume first."""
        boxes = zip(self.region_centres, self.region_axes, self.region_half_extents, strict=True)
        return [OrientedBox(*box) for box in boxes]


def camera_vector(intrinsics: Intrinsics) -> Float[np.ndarray, "6"]:
    """The intrinsics as `StoredView.camera`."""
    i = intrinsics
    return np.array([i.width, i.height, i.fx, i.fy, i.cx, i.cy], float)


def view_path(case: Path, acquisition: int) -> Path:
    """File of one acquisition's arrays."""
    return case / VIEWS / f"{acquisition:03d}.npz"


def write_view(case: Path, acquisition: int, view: StoredView) -> None:
    """Write the arrays, compressed."""
    write_arrays(view_path(case, acquisition), {field.name: getattr(view, field.name) for field in fields(view)})


def read_view(case: Path, acquisition: int) -> StoredView:
    """The arrays as they were written."""
    return StoredView(**read_arrays(view_path(case, acquisition)))


def write_arrays(path: Path, arrays: dict[str, np.ndarray]) -> None:
    """Write arrays as `.npz`, whole or not at all."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **arrays)
    path.parent.mkdir(exist_ok=True)
    write_atomically(path, buffer.getvalue())


def read_arrays(path: Path) -> dict[str, np.ndarray]:
    """The arrays of an `.npz` file; nothing in it is executed."""
    with path.open("rb") as file, np.load(file, allow_pickle=False) as data:  # closed whatever is wrong with it
        return {name: data[name] for name in data.files}
