"""A robot cell as its owner states it: where the camera may be, where the object is, how the arm carries it.

World frame: z up, x and y as the owner likes, the object near the origin; the planner's parameters are in it. All of it
is read from one YAML file; what is not known there is refused.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import yaml
from jaxtyping import Float
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from scipy.spatial.transform import RigidTransform

from franbv.adapters.first_fault import first_fault

Number = Annotated[float, Field(allow_inf_nan=False)]
Corner = tuple[Number, Number, Number]
CornerBox = tuple[Corner, Corner]
"""Lower and upper corner [m]."""
MatrixRows = tuple[tuple[Number, Number, Number, Number], ...]
"""Four rows of a rigid transform."""

D435I_HOUSING: CornerBox = ((-0.0275, -0.0125, -0.0207), (0.0625, 0.0125, 0.0043))
"""90 x 25 x 25 mm around the left imager, camera frame [m] (D400 datasheet; realsense-ros, D435 model)."""
WRIST: CornerBox = ((-0.035, -0.0525, -0.1707), (0.07, 0.0525, -0.0207))
"""Bracket and wrist behind the housing, camera frame [m]. Choice: a wrist of 105 mm (ABB's CAD model of the GoFa's link
6), 15 cm long, with the camera looking along the flange's axis."""
RIGID_WITHIN = 1e-4
"""By which a stated matrix may miss a rotation [-] (choice: four digits were typed)."""


class CellError(ValueError):
    """A cell file that cannot be used; the message is one line with the file, the place and the mend."""


class RobotCell(BaseModel):
    """What the guard holds every pose and every way against. Frozen; lengths [m], world frame unless said otherwise."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    workspace: CornerBox = Field(description="Box that the camera's depth origin may not leave, world [m].")
    object_box: CornerBox = Field(
        description="Box around the object, with what it may be moved by, world [m]. Nothing that moves comes into "
        "it, and the depth origin keeps Min-Z from it."
    )
    table_height: Number = Field(
        default=0.0, description="Height of the plinth's top, or of the table's where there is none, world [m]."
    )
    keep_out: Mapping[str, CornerBox] = Field(
        default_factory=dict, description="What else nothing may touch, by name: lamp, wall, fixture; world [m]."
    )
    moving: tuple[CornerBox, ...] = Field(
        default=(D435I_HOUSING, WRIST),
        min_length=1,
        description="Boxes around all that moves with the camera, camera frame [m]. Default: a D435i before a slender "
        "wrist; state your own bracket and tool.",
    )
    clearance: Annotated[float, Field(gt=0, le=0.2)] = Field(
        default=0.01,
        description="Least distance of what moves from everything [m]. Choice: twice a calibrated cell's error.",
    )
    min_z_margin: Annotated[float, Field(ge=0, le=0.5)] = Field(
        default=0.0, description="Distance that the depth origin keeps from the object box beyond Min-Z [m]."
    )
    most_speed: Annotated[float, Field(gt=0, le=1.0)] = Field(
        default=0.25,
        description="Mean speed of the camera above which a way is refused [m/s]. ISO 10218-1: 250 mm/s.",
    )
    off_way: Annotated[float, Field(gt=0, le=0.1)] = Field(
        default=0.02, description="How far from its way the camera may be found before the arm is stopped [m] (choice)."
    )
    T_world_base: MatrixRows = Field(description="Of the arm's base, four rows [m].")
    T_flange_cam: MatrixRows = Field(description="Of the depth frame on the flange (hand-eye), four rows [m].")
    arm: Mapping[str, Any] = Field(default_factory=dict, description="Settings of the arm's driver, by its own names.")

    @model_validator(mode="after")
    def _sound(self) -> "RobotCell":
        boxes = {"workspace": self.workspace, "object_box": self.object_box, **self.keep_out}
        boxes |= {f"moving {k + 1}": box for k, box in enumerate(self.moving)}
        for name, (lower, upper) in boxes.items():
            if not all(a < b for a, b in zip(lower, upper, strict=True)):
                raise ValueError(f"{name}: lower corner {lower} is not below the upper one {upper}")
        for name in ("T_world_base", "T_flange_cam"):
            rigid(name, getattr(self, name))
        if self.object_box[1][2] <= self.table_height:
            raise ValueError(f"object_box: ends at {self.object_box[1][2]} m, under the table, {self.table_height} m")
        return self

    @property
    def world_base(self) -> RigidTransform:
        """T_world_base."""
        return rigid("T_world_base", self.T_world_base)

    @property
    def flange_cam(self) -> RigidTransform:
        """T_flange_cam."""
        return rigid("T_flange_cam", self.T_flange_cam)

    def flange_at(self, T_world_cam: RigidTransform) -> RigidTransform:
        """T_base_flange that brings the camera to this pose."""
        return self.world_base.inv() * T_world_cam * self.flange_cam.inv()

    def camera_at(self, T_base_flange: RigidTransform) -> RigidTransform:
        """T_world_cam of a camera on this flange."""
        return self.world_base * T_base_flange * self.flange_cam


def rigid(name: str, rows: MatrixRows) -> RigidTransform:
    """The transform of stated rows; ValueError, with the name, where they are none."""
    matrix: Float[np.ndarray, "4 4"] = np.array(rows, float)
    if matrix.shape != (4, 4) or not np.array_equal(matrix[3], (0, 0, 0, 1)):
        raise ValueError(f"{name}: give four rows of four numbers, the last one 0 0 0 1")
    turn = matrix[:3, :3]
    if np.abs(turn @ turn.T - np.eye(3)).max() > RIGID_WITHIN or np.linalg.det(turn) < 0:
        raise ValueError(f"{name}: its upper left 3 x 3 is no rotation; give an orthonormal, right-handed one")
    return RigidTransform.from_matrix(matrix)


def stated_in(path: Path | None) -> dict[str, Any]:
    """What a YAML file says, nothing where there is none; CellError in one line where it cannot be read."""
    if path is None:
        return {}
    try:
        stated = yaml.safe_load(path.read_text())
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "no text"
        raise CellError(f"{path}: cannot be read ({reason}); name a YAML file") from None
    except yaml.YAMLError as error:
        raise CellError(f"{path}: no YAML ({' '.join(str(error).split())}); see docs/robot.md") from None
    if not isinstance(stated, dict):
        raise CellError(f"{path}: has no settings; give names and values")
    return stated


def read_cell(path: Path) -> RobotCell:
    """The cell of a YAML file; CellError in one line where it cannot be read or is not sound."""
    try:
        return RobotCell.model_validate(stated_in(path))
    except ValidationError as error:
        raise CellError(f"{path}: {first_fault(error, 'cell')}; see docs/robot.md") from None


def distance_to_box(points: Float[np.ndarray, "n 3"], box: CornerBox) -> Float[np.ndarray, "n"]:
    """From points to a box [m], 0 inside."""
    lower, upper = np.array(box)
    return np.linalg.norm(np.maximum(np.maximum(lower - points, points - upper), 0.0), axis=1)


def half_diagonal(box: CornerBox) -> float:
    """[m]"""
    return math.dist(*box) / 2
