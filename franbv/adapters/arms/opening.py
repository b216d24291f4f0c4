"""Arms by the name that a command line gives: those of ours, or anybody's own."""

import importlib
from collections.abc import Callable, Mapping
from typing import Any

from franbv.adapters.arms.driver import ArmDriver, ArmError

OWN_ARMS: Mapping[str, str] = {"ros": "franbv.adapters.arms.ros_opening:open_ros_arm"}
"""Where each of ours is opened; loaded when it is asked for."""


def open_arm(kind: str, settings: Mapping[str, Any]) -> ArmDriver:
    """Connect to an arm. kind: a name in OWN_ARMS, or `package.module:function`, called with the settings as keywords.

    ArmError in one line where there is no such arm, or it does not answer.
    """
    module, _, function = OWN_ARMS.get(kind, kind).partition(":")
    if not function:
        raise ArmError(f"arm {kind}: unknown; choose one of {', '.join(OWN_ARMS)}, manual, or package.module:function")
    try:
        make: Callable[..., ArmDriver] = getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError) as error:
        raise ArmError(f"arm {kind}: cannot be loaded ({error}); name a function that can be imported") from None
    try:
        return make(**settings)
    except TypeError as error:
        raise ArmError(f"arm {kind}: {error}; mend the settings under `arm` in the cell's file") from None
