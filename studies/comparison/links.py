"""Links of the chain before the planner that a study can change one at a time: mount, stream, preset, light, finish.

The ablations change the method. These change what it is given, for FRA and PB alike, so that it shows whether the
distance between the two hangs on that link. Values are other real settings, each away from the study's in one thing; a
link at which the study stands already is not run.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from studies.run.reconstruct import ReconstructSettings

LINKED_PLANNERS = ("fra", "pb")
"""Compared under each change."""


@dataclass(frozen=True)
class LinkChange:
    """One link changed: what is named replaces the study's settings."""

    words: str
    """For people, short enough for a row of a chart."""
    subject: Mapping[str, Any] = field(default_factory=dict)
    """Settings of what stands before the camera."""
    sensor: Mapping[str, Any] = field(default_factory=dict)
    """Settings of the camera."""
    imager: Mapping[str, Any] = field(default_factory=dict)
    """Settings of its imagers and its projector."""
    parameters: Mapping[str, Any] = field(default_factory=dict)
    """Of the method, as far as they say what it is given."""

    def changed(self, settings: ReconstructSettings) -> ReconstructSettings:
        """The settings, not yet resolved, with this link changed."""
        imager = settings.sensor.imager.model_copy(update=dict(self.imager))
        sensor = settings.sensor.model_copy(update={"imager": imager, **self.sensor})
        parameters = settings.parameters.model_copy(update=dict(self.parameters))
        return settings.model_copy(update={"sensor": sensor, "parameters": parameters, **self.subject})


def _of_all_bodies(material: str) -> dict[str, Any]:
    return {"material": (material,)}


LINKS: dict[str, LinkChange] = {
    "roll_0": LinkChange("camera level", sensor={"roll_deg": 0.0}),
    "roll_90": LinkChange("camera on end", sensor={"roll_deg": 90.0}),
    "profile_640x360": LinkChange("stream of 640 x 360", sensor={"profile": "640x360"}),
    "profile_640x480": LinkChange("stream of 640 x 480", sensor={"profile": "640x480"}),
    "high_accuracy": LinkChange("preset high accuracy", sensor={"preset": "high_accuracy"}),
    "high_density": LinkChange("preset high density", sensor={"preset": "high_density"}),
    "laser_off": LinkChange("laser off", imager={"laser_power_mw": 0.0}),
    "laser_most": LinkChange("laser at 360 mW", imager={"laser_power_mw": 360.0}),
    "lamps_off": LinkChange("no lamps", {"lamps": "off"}),
    "lamps_hall": LinkChange("ceiling light alone", {"lamps": "hall"}),
    "plinth_white": LinkChange("white plinth", {"plinth": "white"}),
    "bright": LinkChange("all of it bright nickel", _of_all_bodies("nickel:bright")),
    "polished": LinkChange("all of it polished nickel", _of_all_bodies("nickel:polished")),
    "mirror": LinkChange("all of it mirror-finished nickel", _of_all_bodies("nickel:mirror")),
    "blasted": LinkChange("all of it blasted nickel", _of_all_bodies("nickel:blasted")),
    "pixels_120x80": LinkChange("120 x 80 pixels, same field", sensor={"decimation": 4, "crop": (120, 80)}),
    "opencv_matcher": LinkChange("OpenCV's stereo matcher", sensor={"matcher": "sgbm"}),
    "frames_1": LinkChange("one frame a pose", parameters={"n_frames": 1}),
    "frames_5": LinkChange("five frames a pose", parameters={"n_frames": 5}),
}
"""By the names that the comparison's flag takes."""


def arm_name(planner: str, link: str) -> str:
    """What the runs of a planner under a change are known by."""
    return f"{planner}, {link}"
