"""The planner's arm: a motion is planned by the driver, held against the guard, shown, and watched while it is made."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.adapters.arms.driver import ArmDriver, ArmError, FlangePath
from franbv.adapters.live.cell import RobotCell
from franbv.adapters.live.guard import ARRIVED, ARRIVED_DEG, Guard
from franbv.adapters.live.switch import StopSwitch
from franbv.adapters.live.ways import ways

LATE_S, LATE_SHARE = 5.0, 1.5
"""A motion is given up after its own time LATE_SHARE times, and LATE_S more [s] (choice)."""
UNKNOWN_S = 60.0
"""The same where a driver does not tell how long it takes [s] (choice: 15 m at reduced speed)."""
LOOK_EVERY_S = 0.1
"""For where the arm is, while it moves [s] (choice: 2.5 cm at reduced speed)."""


_Planned = tuple[FlangePath, list[RigidTransform]]
"""A driver's way, and the camera's poses on it."""


class RefusedError(Exception):
    """A motion that was not begun; the message is one line. The arm stands where it stood."""

    def __init__(self, T_world_cam: RigidTransform, why: str) -> None:
        where = ", ".join(f"{x:.3f}" for x in T_world_cam.translation)
        super().__init__(f"camera pose at ({where}) m: {why}")
        self.T_world_cam, self.why = T_world_cam, why


@dataclass(frozen=True, eq=False)
class ShownMotion:
    """One motion as it is shown to a person before it is made."""

    T_start: RigidTransform
    T_goal: RigidTransform
    """T_world_cam."""
    length: float
    """Of the depth origin's way [m]."""
    duration_s: float
    """[s], 0 where nobody knows."""
    nearest: float
    """That the depth origin comes to the object box on the way [m]."""

    def sentence(self) -> str:
        """In words."""
        place = ", ".join(f"{x:+.3f}" for x in self.T_goal.translation)
        axis = ", ".join(f"{x:+.2f}" for x in self.T_goal.rotation.as_matrix()[:, 2])
        takes = f" in {self.duration_s:.1f} s" if self.duration_s else ""
        return (
            f"camera to ({place}) m, looking along ({axis}): {self.length:.2f} m of way{takes}, "
            f"{1e3 * self.nearest:.0f} mm from the object at its nearest"
        )


@runtime_checkable
class Beating(Protocol):
    """What must be told that all is well while the arm moves: a `Keeper`, or nobody."""

    def moving(self) -> AbstractContextManager[None]:
        """The arm moves as long as this context lasts."""
        ...

    def beat(self) -> None:
        """All is well."""
        ...

    def close(self) -> None:
        """Let go."""
        ...


@dataclass
class GuardedArm:
    """Implements `franbv.sensing.Arm` on a driver. Poses are the camera's.

    Nothing is sent to the driver that the guard has not seen whole, from where the arm really is to the goal.
    """

    driver: ArmDriver
    cell: RobotCell
    guard: Guard
    switch: StopSwitch
    keeper: Beating
    may_move: Callable[[ShownMotion], bool]
    """Asked before every motion, with what it will be; RefusedError if it says no."""
    camera_lives: Callable[[], bool] = lambda: True
    """Asked while the arm moves; it is stopped if the camera does not."""
    roll_deg: float = 0.0
    """Of the camera in its mount, between poses [deg]."""
    by_hand: bool = False
    """Whether a person moves the camera: then the goal alone is held against the guard, whatever way they take, and the
    camera is where they took it."""
    clock: Callable[[], float] = time.monotonic
    """[s]"""
    refused: list[RigidTransform] = field(default_factory=list)
    """Poses to which no way was found: they count as out of reach from then on."""

    def camera_pose(self) -> RigidTransform:
        """Where the camera is now, by the arm's own word."""
        return self.cell.camera_at(self.driver.flange_pose())

    def reachable(self, T_world_cam: RigidTransform) -> bool:
        """Whether the camera may stand there, some way leads there, and the arm says that it can."""
        if self.guard.violation(T_world_cam) is not None or any(_same(T, T_world_cam) for T in self.refused):
            return False
        is_way = next(self._ways(self.camera_pose(), T_world_cam), None) is not None
        return is_way and self.driver.can_reach(self.cell.flange_at(T_world_cam))

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """Bring the camera there; the time that it took [s].

        RefusedError before anything moved, or between two pieces of the way; ArmError, StoppedError when it had to be
        stopped.
        """
        begun = self.clock()
        try:
            way, planned = self._way_with_plan(T_world_cam)
            self._leg(way[0], planned)
            for goal in way[1:]:
                self._leg(goal, self._planned(goal))
        except RefusedError:
            self.refused.append(T_world_cam)
            raise
        return self.clock() - begun

    def preview(self, T_world_cam: RigidTransform) -> ShownMotion:
        """The first motion that would be made; RefusedError if none would. Nothing moves."""
        _, planned = self._way_with_plan(T_world_cam)
        return self._motion(*planned)

    def _way_with_plan(self, T_goal: RigidTransform) -> tuple[tuple[RigidTransform, ...], _Planned]:
        """The first way that the guard lets pass, and whose first piece the driver plans as the guard allows."""
        why = self.guard.violation(T_goal)
        if why is not None:
            raise RefusedError(T_goal, why)
        refusal = RefusedError(T_goal, "no way around the object leads there")
        for way in self._ways(self.camera_pose(), T_goal):
            try:
                return way, self._planned(way[0])
            except RefusedError as refused:
                refusal = RefusedError(T_goal, refused.why)
        raise refusal

    def _ways(self, T_start: RigidTransform, T_goal: RigidTransform) -> Iterator[tuple[RigidTransform, ...]]:
        """Those whose straight pieces the guard lets pass."""
        if self.by_hand:
            yield (T_goal,)
            return
        for way in ways(T_start, T_goal, self.cell, self.guard.min_z, self.roll_deg):
            if self.guard.way_violation((T_start, *way)) is None:
                yield way

    def _leg(self, T_goal: RigidTransform, planned: _Planned) -> None:
        """Show it, go, and look whether the camera is there."""
        path, poses = planned
        self.switch.check()
        is_allowed = self.may_move(self._motion(path, poses))
        self.switch.check()
        if not is_allowed:
            raise RefusedError(T_goal, "was not confirmed")
        if not self.by_hand and not _near(self.camera_pose(), poses[0]):
            raise RefusedError(T_goal, "the arm was moved while the motion was shown; start again")
        self._go(path, poses)
        if not self.by_hand and not _near(self.camera_pose(), T_goal):
            raise ArmError(f"{self.driver.name}: says that it arrived and is elsewhere; check hand-eye and arm")

    def _planned(self, T_goal: RigidTransform) -> _Planned:
        """The driver's way from here, and the camera's poses on it; RefusedError if it is not allowed."""
        T_start = self.camera_pose()
        path = self.driver.plan(self.cell.flange_at(T_goal))
        if path is None:
            raise RefusedError(T_goal, "the arm finds no way there")
        poses = [self.cell.camera_at(T) for T in path.poses]
        why = None if self.by_hand else self.guard.path_violation(poses, path.duration_s, T_start, T_goal)
        if why is not None:
            raise RefusedError(T_goal, f"the arm's way is not allowed: {why}")
        return path, poses

    def _motion(self, path: FlangePath, poses: Sequence[RigidTransform]) -> ShownMotion:
        places = np.array([T.translation for T in poses])
        length = float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())
        return ShownMotion(poses[0], poses[-1], length, path.duration_s, self.guard.nearest(poses))

    def _go(self, path: FlangePath, poses: Sequence[RigidTransform]) -> None:
        """Make the motion; whatever is raised, the arm has been told to stop."""
        watch = _Watch(self, path, np.array([T.translation for T in poses]))
        try:
            keys = nullcontext() if self.by_hand else self.switch.at_keys()  # a person answers with keys
            with self.switch.on_press(self.driver.stop), keys, self.keeper.moving():
                self.driver.execute(path, watch.may_go_on)
        except BaseException:
            self.driver.stop()
            self.switch.check()  # who pressed it says more than what the driver then ran into
            raise
        self.switch.check()


@dataclass
class _Watch:
    """Asked by the driver again and again while the arm moves."""

    arm: GuardedArm
    path: FlangePath
    places: np.ndarray
    """Of the depth origin along the way (n, 3) [m]."""

    def __post_init__(self) -> None:
        now = self.arm.clock()
        takes = self.path.duration_s
        self.until = now + (LATE_SHARE * takes + LATE_S if takes else UNKNOWN_S)
        self.looked = now

    def may_go_on(self) -> bool:
        """Whether all is well; ArmError says what is not."""
        arm, now = self.arm, self.arm.clock()
        arm.switch.check()
        arm.keeper.beat()
        name = arm.driver.name
        if arm.by_hand:
            return True
        if now > self.until:
            raise ArmError(f"{name}: did not arrive in time; check the arm")
        if not arm.camera_lives():
            raise ArmError(f"{name}: stopped, the camera no longer answers; check its cable")
        if now - self.looked >= LOOK_EVERY_S:
            self.looked = now
            off = self._off_way(arm.camera_pose().translation)
            if not off <= arm.cell.off_way:
                raise ArmError(f"{name}: {1e3 * off:.0f} mm off its way; check the arm, or widen off_way in the cell")
        return True

    def _off_way(self, place: np.ndarray) -> float:
        """Distance from the way [m]."""
        starts, ends = self.places[:-1], self.places[1:]
        along = ends - starts
        squares = np.maximum(np.einsum("ni,ni->n", along, along), 1e-12)
        shares = np.clip(np.einsum("ni,ni->n", place - starts, along) / squares, 0.0, 1.0)
        return float(np.linalg.norm(starts + shares[:, None] * along - place, axis=1).min())


def _near(one: RigidTransform, other: RigidTransform) -> bool:
    turn = np.degrees((one.rotation.inv() * other.rotation).magnitude())
    return bool(np.linalg.norm(one.translation - other.translation) <= ARRIVED and turn <= ARRIVED_DEG)


def _same(one: RigidTransform, other: RigidTransform) -> bool:
    return bool(np.abs(one.as_matrix() - other.as_matrix()).max() <= 1e-9)
