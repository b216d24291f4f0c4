"""An arm behind MoveIt out of the settings of a file."""

from typing import Any

from pydantic import ValidationError

from franbv.adapters.arms.driver import ArmError
from franbv.adapters.arms.ros_arm import RosArm
from franbv.adapters.arms.ros_settings import RosArmSettings


def open_ros_arm(**settings: Any) -> RosArm:
    """Connect; ArmError in one line for settings that are none, or an arm that does not answer."""
    try:
        checked = RosArmSettings.model_validate(settings)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(map(str, first["loc"])) or "settings"
        raise ArmError(f"arm ros: {place}: {first['msg'].removeprefix('Value error, ')}; see docs/robot.md") from None
    return RosArm(checked)
