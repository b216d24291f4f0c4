"""An arm that is a person, out of a cell's file: the board, where it lies, and what counts as there."""

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import Field, ValidationError

from franbv.adapters.arms.driver import ArmError
from franbv.adapters.arms.manual_arm import ManualArm, ManualArmSettings, TakesImage
from franbv.adapters.calibration.charuco import CharucoBoard
from franbv.adapters.first_fault import first_fault
from franbv.adapters.live.cell import MatrixRows, rigid

MANUAL = "manual"
"""Its name for the command line."""


class ManualCell(ManualArmSettings):
    """What stands under `arm` in the file of a cell whose camera a person moves."""

    board: CharucoBoard
    """As it is printed."""
    T_world_board: MatrixRows = Field(description="Where it lies, four rows [m].")


def manual_arm(
    settings: Mapping[str, Any], look: TakesImage | None, say: Callable[[str], None], ask: Callable[[], str]
) -> ManualArm:
    """The person; ArmError where the settings are none, or the camera takes no infrared images."""
    if look is None:
        raise ArmError("arm manual: this camera takes no infrared image in which a board could be found; use realsense")
    try:
        stated = ManualCell.model_validate(dict(settings))
        T_world_board = rigid("T_world_board", stated.T_world_board)
    except ValidationError as error:
        raise ArmError(f"arm manual: {first_fault(error, 'arm')}; see docs/robot.md") from None
    except ValueError as error:
        raise ArmError(f"arm manual: {error}; see docs/robot.md") from None
    rest = {name: getattr(stated, name) for name in ManualArmSettings.model_fields}
    return ManualArm(stated.board, T_world_board, look, say, ask, ManualArmSettings(**rest))
