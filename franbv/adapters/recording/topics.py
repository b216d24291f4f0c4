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

PROFILE = "franbv"
"""Of the file, by which a reader knows it for one of ours."""


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

HEADER_TOPIC = Topic("/recording/header", "franbv.Header", HeaderMessage.model_json_schema())
CALIBRATION_TOPIC = Topic("/camera/depth/camera_info", "foxglove.CameraCalibration", _CALIBRATION)
DEPTH_TOPIC = Topic("/camera/depth/image", "foxglove.RawImage", _IMAGE)
INFRARED_TOPIC = Topic("/camera/infrared/image", "foxglove.RawImage", _IMAGE)
POSE_TOPIC = Topic("/camera/pose", "foxglove.PoseInFrame", _object(timestamp=_TIME, frame_id=_TEXT, pose=_POSE))
TRANSFORM_TOPIC = Topic(
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
BURST_TOPIC = Topic("/camera/burst", "franbv.Burst", BurstMessage.model_json_schema())
REACHABILITY_TOPIC = Topic("/arm/reachability", "franbv.Reachability", ReachabilityMessage.model_json_schema())
DECISION_TOPIC = Topic("/planner/decision", "franbv.Decision", DecisionMessage.model_json_schema())
TIMES_TOPIC = Topic("/planner/times", "franbv.Times", TimesMessage.model_json_schema())
STOP_TOPIC = Topic("/planner/stop", "franbv.Stop", StopMessage.model_json_schema())
TOPICS = (
    HEADER_TOPIC,
    CALIBRATION_TOPIC,
    DEPTH_TOPIC,
    INFRARED_TOPIC,
    POSE_TOPIC,
    TRANSFORM_TOPIC,
    BURST_TOPIC,
    REACHABILITY_TOPIC,
    DECISION_TOPIC,
    TIMES_TOPIC,
    STOP_TOPIC,
)
"""All, in the order in which the file states them."""
