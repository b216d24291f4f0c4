"""Arms by the name that a command line gives: those of ours, or anybody's own."""

from collections.abc import Mapping
from typing import Any

from franbv.adapters.arms.driver import ArmDriver, ArmError
from franbv.adapters.named_function import named_function

OWN_ARMS: Mapping[str, str] = {"ros": "franbv.adapters.arms.ros_opening:open_ros_arm"}
"""Where each of ours is opened; loaded when it is asked for."""


def open_arm(kind: str, settings: Mapping[str, Any]) -> ArmDriver:
    """Connect to an arm. kind: a name in OWN_ARMS, or `package.module:function`, called with the settings as keywords.

    ArmError in one line where there is no such arm, or it does not answer.
    """
    make = named_function("arm", kind, OWN_ARMS, f"{', '.join(OWN_ARMS)}, manual", ArmError)
    try:
        return make(**settings)
    except TypeError as error:
        raise ArmError(f"arm {kind}: {error}; mend the settings under `arm` in the cell's file") from None
