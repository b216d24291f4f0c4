"""The planners that commands and studies offer, by name."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal, NamedTuple

from franbv.planners import Planner, fra, pb, random_views, ray_entropy
from franbv.robust.planner import fra_robust


class KnownPlanner(NamedTuple):
    """A planner that the commands and the studies offer."""

    build: Callable[[], Planner]
    words: str
    """What reports call it."""


PLANNERS: dict[str, KnownPlanner] = {
    "fra": KnownPlanner(fra, "FRA-NBV"),
    "pb": KnownPlanner(pb, "PB-NBV"),
    "re": KnownPlanner(ray_entropy, "ray-cast entropy"),
    "fra-robust": KnownPlanner(fra_robust, "fra-robust"),
    "random": KnownPlanner(random_views, "random views"),
}
"""Planners by their name in flags and configurations; a row here is all that makes one known."""

if TYPE_CHECKING:
    PlannerName = str
else:
    PlannerName = Literal[tuple(PLANNERS)]
