"""Where a robot's joints are, as it keeps saying on `/joint_states`."""

import math
import threading
import time
from collections.abc import Mapping
from typing import Any

from franbv.adapters.arms.driver import ArmError


class JointStates:
    """The latest of every joint, by name: several drivers may share the topic, each with joints of its own."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._positions: dict[str, tuple[float, float]] = {}  # position, when it was heard

    def hear(self, message: Mapping[str, Any]) -> None:
        """A sensor_msgs/JointState came; positions that are not finite (null in JSON) are as if not said."""
        now = time.monotonic()
        said = zip(message["name"], message["position"], strict=False)
        with self._changed:
            for name, position in said:
                if position is not None and math.isfinite(position):
                    self._positions[name] = float(position), now
            self._changed.notify_all()

    def age_s(self) -> float:
        """Since the last was heard [s]; infinite before the first."""
        with self._changed:
            newest = max((heard for _, heard in self._positions.values()), default=-math.inf)
        return time.monotonic() - newest

    def latest(self, oldest_s: float, timeout_s: float) -> dict[str, float]:
        """Position of every joint that was heard within that age [rad, m]; waits for the first. ArmError if none
        comes."""
        deadline = time.monotonic() + timeout_s
        with self._changed:
            while True:
                now = time.monotonic()
                fresh = {
                    name: position for name, (position, heard) in self._positions.items() if now - heard <= oldest_s
                }
                if fresh:
                    return fresh
                if now >= deadline:
                    raise ArmError(
                        f"/joint_states: nothing heard for {timeout_s:g} s; start the robot's driver and its "
                        "joint_state_broadcaster"
                    )
                self._changed.wait(deadline - now)


def farthest(now: Mapping[str, float], wanted: Mapping[str, float]) -> float:
    """Largest distance of a joint from where it should be [rad, m]; ArmError where one of them is not told."""
    if missing := set(wanted) - set(now):
        raise ArmError(f"/joint_states: says nothing of {', '.join(sorted(missing))}; check the robot's driver")
    return max(abs(now[name] - position) for name, position in wanted.items())
