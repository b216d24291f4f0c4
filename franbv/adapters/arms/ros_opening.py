"""An arm behind MoveIt out of the settings of a file."""

from typing import Any

from pydantic import ValidationError

from franbv.adapters.arms.driver import ArmError
from franbv.adapters.arms.ros_arm import RosArm
from franbv.adapters.arms.ros_settings import RosArmSettings
from franbv.adapters.first_fault import first_fault


def open_ros_arm(**settings: Any) -> RosArm:
    """Connect; ArmError in one line for settings that are none, or an arm that does not answer."""
    try:
        checked = RosArmSettings.model_validate(settings)
    except ValidationError as error:
        raise ArmError(f"arm ros: {first_fault(error, 'settings')}; see docs/robot.md") from None
    return RosArm(checked)
