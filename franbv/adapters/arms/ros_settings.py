"""Everything about an arm behind MoveIt that a user can set."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from franbv.parameters import Count, Positive

SpeedScale = Annotated[float, Field(gt=0, le=1)]
Name = Annotated[str, Field(min_length=1)]


class RosArmSettings(BaseModel):
    """Settings of `franbv.adapters.arms.ros_arm.RosArm`; the defaults are slow and impatient.

    Frozen. Unknown keys and numbers out of range raise pydantic's ValidationError. Whether MoveIt knows the names is
    seen when it is asked: ArmError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    url: Annotated[str, Field(pattern=r"^wss?://[^\s/]+")] = "ws://127.0.0.1:9090"
    """Where rosbridge listens (rosbridge_server's default port)."""
    group: Name = "manipulator"
    """Planning group of MoveIt that ends at the flange (ROS-Industrial's name; `ur_manipulator`, `panda_arm`...)."""
    base_frame: Name = "base_link"
    """Frame of all poses, T_base_flange (REP 199's name for the foot of an arm)."""
    flange_link: Name = "tool0"
    """Link that the camera is bolted to (ROS-Industrial's name for the flange with z outwards)."""
    velocity_scale: SpeedScale = 0.1
    """Share of the joints' greatest velocity that is used [0, 1] (choice: slow enough to reach the stop button;
    MoveIt's own default for a first set-up)."""
    acceleration_scale: SpeedScale = 0.1
    """Share of the joints' greatest acceleration that is used [0, 1] (choice: as `velocity_scale`)."""
    pipeline: str = ""
    """Planning pipeline by name, such as `ompl`; empty: MoveIt's default."""
    planner: str = ""
    """Planner of the pipeline by name; empty: its default."""
    planning_time_s: Positive = 5.0
    """How long a planner may search [s] (MoveGroupInterface's default)."""
    planning_attempts: Count = 1
    """How often it searches; the shortest way is taken [-] (MoveGroupInterface's default)."""
    position_tolerance_m: Positive = 1e-4
    """Radius around the asked place in which a way may end [m] (MoveGroupInterface's default)."""
    angle_tolerance_deg: Positive = 0.06
    """How far it may end turned about each axis [deg] (MoveGroupInterface's default, 1e-3 rad)."""
    connect_timeout_s: Positive = 5.0
    """How long rosbridge may take to answer the door [s] (choice: a slow network is no network)."""
    call_timeout_s: Positive = 2.0
    """How long any call may take, a plan's search not counted [s] (choice: each takes milliseconds)."""
    state_timeout_s: Positive = 0.5
    """Age at which joint states are stale; an arm whose states stop coming while it moves is stopped [s] (choice: 25
    states of a driver at 50 Hz)."""
    joint_tolerance: Positive = 0.01
    """How far joints may stand from a way's first and last point [rad, m] (MoveIt's allowed_start_tolerance)."""
    duration_factor: Annotated[float, Field(ge=1)] = 1.5
    """A way may take this many times as long as planned [-] (choice: MoveIt itself gives up at 1.1 to 1.2)..."""
    duration_margin_s: Positive = 3.0
    """...and this much longer [s] (choice: MoveIt itself gives up at 0.5, and controllers need time to settle)."""
