"""A simulated robot arm that carries the camera: motion times, reach, and collisions of what moves with the camera.

The arm is joint-free: it knows its reach, the speeds of its tool and the outline of camera, bracket and wrist, but no
joint angles and no links. Its motion times are those of a straight move, so they bound a planned one from below.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at, rolled
from materials.input_error import InputError
from render.arm.camera_body import CAMERA_BODIES, WRIST_RADIUS, CameraBody
from render.arm.solid import Solid
from scenes.scene import Body, Mesh

SHOULDER_HEIGHT = 0.338
"""Of axis 2 above the base [m] (ROS-Industrial's model of ABB's CRB 15000-12/1.27)."""
CLEARANCE = 0.005
"""Least distance kept from everything [m] (choice: a few times a calibrated cell's error)."""


@dataclass(frozen=True)
class ArmLimits:
    """Speeds and reach of an ABB GoFa 12 (CRB 15000-12/1.27) that stands on the table.

    Speeds are those of the wrist's straight way and of its turn, with a trapezoidal profile each. Limits of single
    joints, jerk and load are left out.
    """

    speed: float = 1.25
    """Of the wrist [m/s]: axes 1 and 2 turn at 120 deg/s (ROS-Industrial, after ABB's manual 3HAC077389-001), which
    0.6 m from the axis is 1.26 m/s."""
    acceleration: float = 2.5
    """[m/s^2] Choice: full speed within half a second."""
    turning_speed: float = float(np.radians(200.0))
    """[rad/s] Axes 4 to 6 turn at 200 deg/s (same source)."""
    turning_acceleration: float = float(np.radians(400.0))
    """[rad/s^2] Choice: full speed within half a second."""
    reach: float = 1.27
    """From the shoulder to the wrist's centre [m] (the arm's designation)."""
    base: tuple[float, float, float] = (-0.6, 0.0, 0.0)
    """Where the arm stands, world [m] (choice: the far side of a part at the origin stays in reach)."""
    workspace: tuple[tuple[float, float, float], tuple[float, float, float]] = ((-0.9, -0.9, 0.0), (0.9, 0.9, 1.3))
    """Corners of the box that the depth origin may not leave, world [m] (choice: a cell of 1.8 m)."""
    table_height: float = 0.0
    """World z of the table top [m]."""


@dataclass
class SimulatedArm:
    """The `franbv.sensing.Arm` of the simulator. Poses are those of the left infrared imager.

    They carry the camera's roll, and the outline of what moves with it turns with them. A pose can be taken if that
    imager is in the workspace, the wrist within reach of the shoulder, and housing, bracket and wrist keep CLEARANCE
    from the table, the part and the fixtures around it and are not inside them. Of a part on a plinth the plinth's top
    counts as the table, and what is lower beside it as under the table. A move takes the longer of two trapezoidal
    times, way and turn: a lower bound of a planned one. Left out: joints and links, collisions on the way, lamps under
    a ceiling and walls.
    """

    part: Solid
    """What stands on the table."""
    limits: ArmLimits = field(default_factory=ArmLimits)
    T_world_cam: RigidTransform = field(default_factory=lambda: look_at(np.array([-0.2, 0.0, 0.6]), np.zeros(3)))
    """Where the camera is now; at first above the table, looking down on the origin (choice)."""
    body: CameraBody = CAMERA_BODIES["d435i"]
    """What it carries."""
    fixtures: Mapping[str, Solid] = field(default_factory=dict)
    """What else it may not touch, by name."""

    @classmethod
    def around(
        cls,
        part: Mesh,
        limits: ArmLimits | None = None,
        model: str = "d435i",
        roll_deg: float = 0.0,
        fixtures: Sequence[Body] = (),
    ) -> "SimulatedArm":
        """An arm beside this part (world frame) that carries a camera of this model, turned so in its mount.

        fixtures: what stands around the part, `Scene.fixtures`.
        """
        solids = {body.name: Solid.from_mesh(body.mesh) for body in fixtures}
        arm = cls(Solid.from_mesh(part), limits or ArmLimits(), body=CAMERA_BODIES[model], fixtures=solids)
        arm.T_world_cam = rolled(arm.T_world_cam, roll_deg)
        return arm

    def obstacle(self, T_world_cam: RigidTransform) -> str | None:
        """Why the camera cannot stand at this pose, None if it can.

        `outside workspace`, `under table`, `out of reach`, `inside part` or `touches part`, the first that applies; and
        the last two with the name of a fixture in place of `part`.
        """
        wrist = T_world_cam.apply(self.body.wrist_axis)
        lower, upper = self.limits.workspace
        if np.any(T_world_cam.translation < lower) or np.any(T_world_cam.translation > upper):
            return "outside workspace" if T_world_cam.translation[2] >= self.limits.table_height else "under table"
        lowest = min(T_world_cam.apply(self.body.corners)[:, 2].min(), wrist[:, 2].min() - WRIST_RADIUS)
        if lowest < self.limits.table_height + CLEARANCE:
            return "under table"
        shoulder = np.add(self.limits.base, (0.0, 0.0, SHOULDER_HEIGHT))
        if np.linalg.norm(wrist[1] - shoulder) > self.limits.reach:
            return "out of reach"
        contacts = (self._contact(T_world_cam, *one) for one in (("part", self.part), *self.fixtures.items()))
        return next((contact for contact in contacts if contact), None)

    def _contact(self, T_world_cam: RigidTransform, name: str, solid: Solid) -> str | None:
        """`touches` if the surface comes close to anything that moves, `inside` if it encloses it."""
        ball = T_world_cam.apply(self.body.ball_centre)
        near = T_world_cam.inv().apply(solid.samples_within(ball, self.body.ball_radius + CLEARANCE))
        if np.any(np.minimum(self.body.box_distance(near), self.body.wrist_distance(near)) < CLEARANCE):
            return f"touches {name}"
        return f"inside {name}" if solid.winding_number(T_world_cam.translation) > 0.5 else None

    def reachable(self, T_world_cam: RigidTransform) -> bool:
        """Whether the camera can stand at this pose without collision."""
        return self.obstacle(T_world_cam) is None

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """Move the camera there; returns the motion time [s]. InputError if it cannot stand there."""
        obstacle = self.obstacle(T_world_cam)
        if obstacle is not None:
            where = ", ".join(f"{x:.3f}" for x in T_world_cam.translation)
            raise InputError(f"camera pose at ({where}) m: {obstacle}; choose a free pose above the table")
        seconds = motion_time(self.T_world_cam, T_world_cam, self.limits, self.body)
        self.T_world_cam = T_world_cam
        return seconds


def motion_time(
    start: RigidTransform, end: RigidTransform, limits: ArmLimits, body: CameraBody = CAMERA_BODIES["d435i"]
) -> float:
    """Time of a straight move of the wrist with a turn on the way [s], from rest to rest: the longer of the two."""
    way = float(np.linalg.norm(end.apply(body.wrist_axis[1]) - start.apply(body.wrist_axis[1])))
    angle = float((start.rotation.inv() * end.rotation).magnitude())
    return max(
        trapezoidal_time(way, limits.speed, limits.acceleration),
        trapezoidal_time(angle, limits.turning_speed, limits.turning_acceleration),
    )


def trapezoidal_time(way: float, speed: float, acceleration: float) -> float:
    """Time to cover `way` from rest to rest with bounded speed and acceleration [s]; any one consistent unit."""
    if way >= speed**2 / acceleration:
        return way / speed + speed / acceleration
    return 2.0 * float(np.sqrt(way / acceleration))
