"""Where the camera stood when: poses by time, from a transform tree, from a topic of poses, or from a file of them.

A pose holds from its time on until the next one: what a robot says while it moves is never interpolated, since bursts
are taken at rest.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.recording.contents import RecordingError

AT_REST_M, AT_REST = 1e-4, 1e-3
"""Two poses are one place if they differ by less: 0.1 mm, and 1e-3 of a unit vector's length, 0.06 deg. Choice: an arm
at rest trembles less, and a view is chosen no finer."""


@dataclass
class TimedPoses:
    """Poses in the order of their times."""

    times_ns: list[int] = field(default_factory=list)
    """[ns]"""
    poses: list[RigidTransform] = field(default_factory=list)

    def add(self, time_ns: int, pose: RigidTransform) -> None:
        """Another pose; they may come in any order."""
        at = bisect_right(self.times_ns, time_ns)
        self.times_ns.insert(at, time_ns)
        self.poses.insert(at, pose)

    def at(self, time_ns: int) -> RigidTransform | None:
        """The last pose until then; None before the first."""
        k = bisect_right(self.times_ns, time_ns)
        return self.poses[k - 1] if k else None


@dataclass
class TransformTree:
    """Coordinate frames, each in its parent, as /tf and /tf_static have them."""

    parents: dict[str, str] = field(default_factory=dict)
    moving: dict[str, TimedPoses] = field(default_factory=dict)
    fixed: dict[str, RigidTransform] = field(default_factory=dict)

    def add(self, parent: str, child: str, time_ns: int, T_parent_child: RigidTransform, is_fixed: bool) -> None:
        """Another transform."""
        parent, child = parent.lstrip("/"), child.lstrip("/")
        self.parents[child] = parent
        if is_fixed:
            self.fixed[child] = T_parent_child
        else:
            self.moving.setdefault(child, TimedPoses()).add(time_ns, T_parent_child)

    def root_of(self, frame: str) -> str:
        """The frame that all others of its tree stand in; ValueError for a circle."""
        chain = [frame.lstrip("/")]
        while chain[-1] in self.parents:
            if self.parents[chain[-1]] in chain:
                raise ValueError(f"the transforms of {frame} go in a circle")
            chain.append(self.parents[chain[-1]])
        return chain[-1]

    def pose(self, world: str, frame: str, time_ns: int) -> RigidTransform | None:
        """T_world_frame at that time; None where it is not known yet; ValueError where no chain leads there."""
        T, at = RigidTransform.identity(), frame.lstrip("/")
        self.root_of(frame)  # no circle
        while at != world.lstrip("/"):
            if at not in self.parents:
                raise ValueError(f"no transform leads from {world} to {frame}")
            step = self.moving[at].at(time_ns) if at in self.moving else self.fixed[at]
            if step is None:
                return None
            T, at = step * T, self.parents[at]
        return T


def pose_from_numbers(numbers: Sequence[float]) -> RigidTransform:
    """x, y, z [m], then the quaternion x, y, z, w; ValueError where it is none."""
    values = np.array(numbers, float)
    if values.shape != (7,) or not np.isfinite(values).all() or abs(np.linalg.norm(values[3:]) - 1) > 0.01:
        raise ValueError("a pose is x y z and a quaternion of length 1")
    return RigidTransform.from_components(values[:3], Rotation.from_quat(values[3:]))


def read_poses(path: Path) -> TimedPoses:
    """The poses of a file in the layout of the TUM RGB-D benchmark: `time[s] x y z qx qy qz qw`, # begins a comment.

    RecordingError names the line that cannot be read.
    """
    poses = TimedPoses()
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path}: cannot be read ({error}); give a text file of poses") from error
    for number, line in enumerate(lines, 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        try:
            time_s, *numbers = map(float, words)
            poses.add(round(time_s * 1e9), pose_from_numbers(numbers))
        except (ValueError, OverflowError) as error:
            raise RecordingError(
                f"{path}: line {number} is no pose ({error}); write `time x y z qx qy qz qw`"
            ) from error
    if not poses.poses:
        raise RecordingError(f"{path}: holds no pose; write lines `time x y z qx qy qz qw`")
    return poses


def one_place(one: RigidTransform, other: RigidTransform) -> bool:
    """Whether the camera stands where it stood."""
    apart = np.abs(one.as_matrix() - other.as_matrix())
    return bool(apart[:3, 3].max() <= AT_REST_M and apart[:3, :3].max() <= AT_REST)
