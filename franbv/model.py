"""All that is known after an acquisition: the map, the object in it, and the ellipsoids that stand in for the object.

One burst makes a model of the last one in three steps: it is integrated into the map, the object and its frontier are
cut out of the map, and both are approximated by ellipsoids (paper, sections III-A and III-B).
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from franbv.ellipsoids import Ellipsoids
from franbv.object_model import ObjectModel, object_model
from franbv.parameters import Parameters
from franbv.sensing import DepthBurst
from franbv.voxel_map import VoxelMap

Integrate = Callable[[VoxelMap, DepthBurst, Parameters], VoxelMap]
"""(map, burst, parameters) -> map with the burst in it."""
Approximate = Callable[[ObjectModel, Parameters, np.random.SeedSequence], Ellipsoids]
"""(object, parameters, seed) -> ellipsoids."""
Timed = Callable[[str], AbstractContextManager[None]]
"""Stage -> what times it: "map", "object" or "ellipsoids"."""


@dataclass(frozen=True, eq=False)
class Model:
    """All that is known after an acquisition: the map, the object O_t in it, and the ellipsoids that stand in for it.

    Paper, sections III-A and III-B. Nothing in it changes: an acquisition makes a new one of the last. It knows nothing
    of reflectance; the regions that a burst shows are a `franbv.reflective_regions.Detection`.
    """

    voxel_map: VoxelMap
    object: ObjectModel
    ellipsoids: Ellipsoids
    """E_o and E_f; empty where the planner uses none."""


@runtime_checkable
class Modeller(Protocol):
    """What of a planner makes models: how bursts enter the map, and what stands in for the object.

    Both are functions that return something new; a `franbv.planners.Planner` has them.
    """

    @property
    def integrate(self) -> Integrate: ...
    @property
    def approximate(self) -> Approximate: ...


def untimed(stage: str) -> AbstractContextManager[None]:
    """Times nothing."""
    return nullcontext()


def model_of(
    voxel_map: VoxelMap,
    modeller: Modeller,
    parameters: Parameters,
    seed: np.random.SeedSequence,
    timed: Timed = untimed,
) -> Model:
    """The model of a map as it is. seed: of the clusters that ellipsoids are wrapped around."""
    with timed("object"):
        estimate = object_model(voxel_map, parameters)
    with timed("ellipsoids"):
        ellipsoids = modeller.approximate(estimate, parameters, seed)
    return Model(voxel_map, estimate, ellipsoids)


def model_with(
    voxel_map: VoxelMap,
    burst: DepthBurst,
    modeller: Modeller,
    parameters: Parameters,
    seed: np.random.SeedSequence,
    timed: Timed = untimed,
) -> Model:
    """The model of a map once a burst is in it; seed as in `model_of`."""
    with timed("map"):
        voxel_map = modeller.integrate(voxel_map, burst, parameters)
    return model_of(voxel_map, modeller, parameters, seed, timed)
