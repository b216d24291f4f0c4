"""What a cell tells an arm that plans around obstacles: object, plinth, and what is to be kept out of."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.adapters.arms.moveit_messages import CollisionBox
from franbv.adapters.live.cell import CornerBox, RobotCell

SLAB_M = 0.02
"""Thickness of what stands for the table under the workspace [m] (choice: thicker than a planner's step)."""


@runtime_checkable
class AvoidsBoxes(Protocol):
    """An arm that plans around boxes that it is told."""

    def set_obstacles(self, boxes: Sequence[CollisionBox]) -> None:
        """Plan around these, and no longer around earlier ones."""
        ...


def cell_obstacles(cell: RobotCell) -> list[CollisionBox]:
    """The boxes in the arm's base frame. The table is a slab under the workspace: the arm's foot is not in it."""
    (x, y, _), (x_end, y_end, _) = cell.workspace
    slab = ((x, y, cell.table_height - SLAB_M), (x_end, y_end, cell.table_height))
    named = {"table": slab, "object": cell.object_box, **cell.keep_out}
    return [_in_base(name, box, cell) for name, box in named.items()]


def _in_base(name: str, box: CornerBox, cell: RobotCell) -> CollisionBox:
    lower, upper = np.array(box)
    middle = RigidTransform.from_translation((lower + upper) / 2)
    x, y, z = (upper - lower).tolist()
    return CollisionBox(name, cell.world_base.inv() * middle, (x, y, z))
