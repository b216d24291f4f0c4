"""What an arm must be able to do before anything of ours moves it; `franbv.adapters.live` makes a planner's arm of it.

A driver knows its base and its flange alone. Camera, world, plinth and object are the cell's affair, and whether a way
is allowed is the guard's.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from scipy.spatial.transform import RigidTransform

POLL_S = 0.02
"""How often a driver looks up while it waits [s] (choice: well under the 50 ms of `ArmDriver.execute`)."""


class ArmError(Exception):
    """An arm that does not do what it was asked; the message is one line with the thing and the mend.

    Whoever raises it has told the arm to stop.
    """


@dataclass(frozen=True, eq=False)
class FlangePath:
    """A way that an arm intends to go."""

    poses: tuple[RigidTransform, ...]
    """T_base_flange along it [m]: where it stands now first, the goal last, with no more than a few centimetres and
    degrees between neighbours."""
    duration_s: float
    """How long it will take [s]; 0 where nobody knows."""
    trajectory: object = None
    """The driver's own form of it."""


@runtime_checkable
class ArmDriver(Protocol):
    """An arm, by its flange. All calls return within the driver's time-out or raise ArmError."""

    @property
    def name(self) -> str:
        """For people: what it is and where, such as `MoveIt at ws://10.0.0.2:9090`."""
        ...

    def flange_pose(self) -> RigidTransform:
        """Where the flange is now, T_base_flange."""
        ...

    def can_reach(self, T_base_flange: RigidTransform) -> bool:
        """Whether the arm has joint angles for it, free of collisions that it knows of. Nothing moves."""
        ...

    def plan(self, T_base_flange: RigidTransform) -> FlangePath | None:
        """A way there from where the flange is now; None if it finds none. Nothing moves."""
        ...

    def execute(self, path: FlangePath, may_go_on: Callable[[], bool]) -> None:
        """Go that way and no other; returns when the flange stands at its end.

        may_go_on: asked at least every 50 ms; as soon as it says no, or raises, the arm is stopped, and ArmError is
        raised. ArmError as well where the arm refuses the way, does not arrive, or no longer answers.
        """
        ...

    def stop(self) -> None:
        """Stop at once; may be called at any time, from any thread, again and again, and never raises."""
        ...

    def close(self) -> None:
        """Stop, and let go of the arm."""
        ...
