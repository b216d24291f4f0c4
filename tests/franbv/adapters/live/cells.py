"""A cell with a box on a table, and an arm that does what a script says."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.arms.driver import ArmError, FlangePath
from franbv.adapters.arms.flange_poses import pose_distance
from franbv.adapters.arms.straight import straight_poses
from franbv.adapters.live.cell import RobotCell
from franbv.adapters.live.guard import Guard
from franbv.adapters.live.guarded_arm import GuardedArm
from franbv.adapters.live.keeper import NoKeeper
from franbv.adapters.live.switch import StopSwitch
from franbv.frames import look_at

MIN_Z = 0.128
T_WORLD_BASE = RigidTransform.from_components((-0.6, 0.1, -0.05), Rotation.from_euler("z", 30, degrees=True))
T_FLANGE_CAM = RigidTransform.from_components(
    (0.02, -0.03, 0.09), Rotation.from_euler("xyz", (5, -3, 90), degrees=True)
)


def rows(T: RigidTransform) -> list[list[float]]:
    """As a cell's file has it."""
    return T.as_matrix().tolist()


CELL = RobotCell.model_validate(
    {
        "workspace": ((-0.6, -0.6, 0.0), (0.6, 0.6, 0.9)),
        "object_box": ((-0.06, -0.05, 0.0), (0.06, 0.05, 0.08)),
        "keep_out": {"lamp": ((0.35, 0.35, 0.0), (0.5, 0.5, 0.6))},
        "T_world_base": rows(T_WORLD_BASE),
        "T_flange_cam": rows(T_FLANGE_CAM),
    }
)
HOME = look_at(np.array([-0.4, 0.0, 0.5]), np.array([0.0, 0.0, 0.05]))


def straight_way(T_start: RigidTransform, T_goal: RigidTransform, speed: float) -> FlangePath:
    """As an arm of this speed [m/s] would go that turns by 45 deg/s."""
    way, turn = pose_distance(T_start, T_goal)
    return FlangePath(straight_poses(T_start, T_goal), max(way / speed, turn / 45.0))


@dataclass
class ScriptedArm:
    """An `ArmDriver` that goes at once, along straight ways, and keeps all that it was sent."""

    flange: RigidTransform = field(default_factory=lambda: CELL.flange_at(HOME))
    bend: Callable[[FlangePath], FlangePath | None] = lambda path: path
    """What becomes of a way before it is stated."""
    on_step: Callable[["ScriptedArm", int], None] = lambda arm, step: None
    """Called at each step of a motion."""
    sent: list[FlangePath] = field(default_factory=list)
    stops: int = 0
    moving: bool = False
    name: str = "scripted arm"

    def flange_pose(self) -> RigidTransform:
        return self.flange

    def can_reach(self, T_base_flange: RigidTransform) -> bool:
        return True

    def plan(self, T_base_flange: RigidTransform) -> FlangePath | None:
        return self.bend(straight_way(self.flange, T_base_flange, 0.2))

    def execute(self, path: FlangePath, may_go_on: Callable[[], bool]) -> None:
        self.sent.append(path)
        self.moving = True
        for step, pose in enumerate(path.poses):
            self.on_step(self, step)
            if not self.moving or not may_go_on():
                raise ArmError("scripted arm: stopped half-way; look at it")
            self.flange = pose
        self.moving = False

    def stop(self) -> None:
        self.stops += 1
        self.moving = False

    def close(self) -> None:
        self.stop()


def guarded(driver: ScriptedArm, cell: RobotCell = CELL, **settings) -> GuardedArm:
    """The planner's arm on it, which asks nobody."""
    made = {"switch": StopSwitch(), "keeper": NoKeeper(), "may_move": lambda motion: True} | settings
    return GuardedArm(driver, cell, Guard(cell, MIN_Z), **made)


def open_scripted(speed: float = 0.2) -> ScriptedArm:
    """For the commands: `--arm tests.franbv.adapters.live.cells:open_scripted`."""
    return ScriptedArm(name=f"scripted arm at {speed:g} m/s")
