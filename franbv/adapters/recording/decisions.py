"""What a planner decided at an acquisition, as a recording keeps it, and where two runs first decide otherwise."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from franbv.acquisition import Acquisition
from franbv.adapters.recording.forms import matrix_rows
from franbv.geometry.oriented_box import OrientedBox
from franbv.recovery import RecoveryPoses
from franbv.reflective_regions import Detection

EQUAL_TO = 1e-9
"""Numbers that differ by less, of themselves or absolutely, are the same decision. Choice: far above the rounding by
which two processors differ, far below what moves a camera (1 nm)."""
POSE_FIELD = "T_world_cam"
"""Of a decision."""


@dataclass(frozen=True)
class DecisionDifference:
    """Where two runs first decide otherwise."""

    acquisition: int
    """Index of the acquisition."""
    what: str
    """The number or word of the decision, such as `detection.boxes.0.centre.2`; `stop`, `acquisitions`, `pose`."""
    recorded: Any
    """In the recording, None = nothing."""
    replayed: Any
    """Now, None = nothing."""

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def decision_of(a: Acquisition) -> dict[str, Any]:
    """The acquisition's decision in the form of `DecisionMessage`."""
    return {
        "index": a.index,
        "iteration": a.nbv_iteration,
        "kind": a.kind,
        "T_world_cam": matrix_rows(a.burst.T_world_cam),
        "utility": a.utility,
        "n_unreachable": a.n_unreachable,
        "detection": None if a.detection is None else _detection(a.detection),
        "recovery": None if a.recovery_poses is None else _recovery(a.recovery_poses),
        "gamma": a.gamma,
        "gamma_attainable": a.gamma_attainable,
        "occupied_voxels": len(a.model.object.occupied),
        "frontier_voxels": len(a.model.object.frontier),
        "ellipsoids": len(a.model.ellipsoids),
    }


def first_difference(
    recorded: Sequence[Mapping[str, Any]], replayed: Sequence[Mapping[str, Any]]
) -> DecisionDifference | None:
    """The first number or word in which the decisions differ by more than EQUAL_TO; None if they all agree."""
    for k, (one, other) in enumerate(zip(recorded, replayed, strict=False)):
        found = _difference(one, other, ())
        if found is not None:
            place, was, now = found
            if place[0] == POSE_FIELD:  # one number of a pose says little
                return DecisionDifference(k, "pose", one.get(POSE_FIELD), other.get(POSE_FIELD))
            return DecisionDifference(k, ".".join(place), was, now)
    if len(recorded) != len(replayed):
        return DecisionDifference(min(len(recorded), len(replayed)), "acquisitions", len(recorded), len(replayed))
    return None


def _difference(one: Any, other: Any, place: tuple[str, ...]) -> tuple[tuple[str, ...], Any, Any] | None:
    """Place and both values of the first difference."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        pairs = [(str(key), one.get(key), other.get(key)) for key in {**one, **other}]
    elif isinstance(one, list | tuple) and isinstance(other, list | tuple):
        if len(one) != len(other):
            return (*place, "length"), len(one), len(other)
        pairs = [(str(k), a, b) for k, (a, b) in enumerate(zip(one, other, strict=True))]
    else:
        return None if _same(one, other) else (place, one, other)
    found = (_difference(a, b, (*place, key)) for key, a, b in pairs)
    return next((difference for difference in found if difference is not None), None)


def _same(one: Any, other: Any) -> bool:
    numbers = [isinstance(value, int | float) and not isinstance(value, bool) for value in (one, other)]
    if all(numbers):
        return bool(np.isclose(one, other, rtol=EQUAL_TO, atol=EQUAL_TO))
    return type(one) is type(other) and one == other


def _detection(found: Detection) -> dict[str, Any]:
    return {
        "candidate_pixels": int(found.candidates.sum()),
        "retained_pixels": int(found.retained.sum()),
        "boxes": [_box(box) for box in found.boxes],
    }


def _box(box: OrientedBox) -> dict[str, Any]:
    return {"centre": box.centre.tolist(), "axes": box.axes.tolist(), "half_extents": box.half_extents.tolist()}


def _recovery(found: RecoveryPoses) -> dict[str, Any]:
    return {
        "poses": [matrix_rows(T) for T in found.poses],
        "target": found.target.tolist(),
        "normal": found.normal.tolist(),
        "turned": found.turned,
        "n_pushed_back": found.n_pushed_back,
        "n_too_near": found.n_too_near,
        "n_under_table": found.n_under_table,
        "n_unreachable": found.n_unreachable,
    }
