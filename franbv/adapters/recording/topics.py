"""Topics of a recording, and the JSON schema that the file states for each: Foxglove's names where it has one.

The forms are those of Foxglove's published schemas (docs.foxglove.dev/docs/visualization/message-schemas), in words of
our own; its viewer goes by the names.
"""

from typing import Any, NamedTuple

from franbv.adapters.recording.messages import (
    BurstMessage,
    DecisionMessage,
    HeaderMessage,
    ReachabilityMessage,
    StopMessage,
    TimesMessage,
)


class Topic(NamedTuple):
    """A channel of the file."""

    name: str
    schema: str
    form: dict[str, Any]
    """JSON schema."""


def _object(**properties: Any) -> dict[str, Any]:
    return {"type": "object", "properties": properties}


def _numbers(*names: str) -> dict[str, Any]:
    return _object(**{name: {"type": "number"} for name in names})


_TEXT, _WHOLE = {"type": "string"}, {"type": "integer"}
_TIME = _object(sec=_WHOLE, nsec=_WHOLE) | {"title": "time"}
_POSE = _object(position=_numbers("x", "y", "z"), orientation=_numbers("x", "y", "z", "w"))
_IMAGE = _object(
    timestamp=_TIME, frame_id=_TEXT, width=_WHOLE, height=_WHOLE, encoding=_TEXT, step=_WHOLE,
    data={"type": "string", "contentEncoding": "base64"},
)  # fmt: skip
_CALIBRATION = _object(
    timestamp=_TIME, frame_id=_TEXT, width=_WHOLE, height=_WHOLE, distortion_model=_TEXT,
    **{name: {"type": "array", "items": {"type": "number"}} for name in "DKRP"},
)  # fmt: skip

HEADER = Topic("/recording/header", "franbv.Header", HeaderMessage.model_json_schema())
CALIBRATION = Topic("/camera/depth/camera_info", "foxglove.CameraCalibration", _CALIBRATION)
DEPTH = Topic("/camera/depth/image", "foxglove.RawImage", _IMAGE)
INFRARED = Topic("/camera/infrared/image", "foxglove.RawImage", _IMAGE)
POSE = Topic("/camera/pose", "foxglove.PoseInFrame", _object(timestamp=_TIME, frame_id=_TEXT, pose=_POSE))
TRANSFORM = Topic(
    "/tf",
    "foxglove.FrameTransform",
    _object(
        timestamp=_TIME,
        parent_frame_id=_TEXT,
        child_frame_id=_TEXT,
        translation=_numbers("x", "y", "z"),
        rotation=_numbers("x", "y", "z", "w"),
    ),
)
BURST = Topic("/camera/burst", "franbv.Burst", BurstMessage.model_json_schema())
REACHABILITY = Topic("/arm/reachability", "franbv.Reachability", ReachabilityMessage.model_json_schema())
DECISION = Topic("/planner/decision", "franbv.Decision", DecisionMessage.model_json_schema())
TIMES = Topic("/planner/times", "franbv.Times", TimesMessage.model_json_schema())
STOP = Topic("/planner/stop", "franbv.Stop", StopMessage.model_json_schema())
TOPICS = (HEADER, CALIBRATION, DEPTH, INFRARED, POSE, TRANSFORM, BURST, REACHABILITY, DECISION, TIMES, STOP)
"""All, in the order in which the file states them."""
