"""Links of the chain before the planner that a study can change one at a time: pixels, matcher, lamps, finish.

The ablations change the method. These change what it is given, for FRA and PB alike, so that it shows whether the
distance between the two hangs on that link. Values are other real settings, each away from the paper's in one thing.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from studies.run.reconstruct import ReconstructSettings

LINKED_PLANNERS = ("fra", "pb")
"""Compared under each change."""


class LinkChange(NamedTuple):
    """One link changed."""

    words: str
    sensor: Mapping[str, Any] | None = None
    """Settings of the camera that replace those of the study."""
    lamps: str | None = None
    """Lamp preset."""
    material: str | None = None
    """Of all bodies of the part."""

    def changed(self, settings: ReconstructSettings) -> ReconstructSettings:
        """The settings with this link changed."""
        update: dict[str, Any] = {"sensor": settings.sensor.model_copy(update=self.sensor or {})}
        if self.lamps:
            update["lamps"] = self.lamps
        if self.material:
            update["material"] = (self.material,)
        return settings.model_copy(update=update)


LINKS: dict[str, LinkChange] = {
    "pixels_120x80": LinkChange("depth of 120 x 80 pixels of the same field", {"decimation": 4, "crop": (120, 80)}),
    "profile_640x480": LinkChange("a stream of 640x480, whose Min-Z is 153 mm", {"profile": "640x480"}),
    "opencv_matcher": LinkChange("OpenCV's stereo matcher", {"matcher": "sgbm"}),
    "lamps_off": LinkChange("no lamps", lamps="off"),
    "halogen": LinkChange("halogen floods", lamps="halogen"),
    "mirror": LinkChange("all of it mirror-finished stainless steel", material="stainless_austenitic:mirror"),
    "blasted": LinkChange("all of it blasted stainless steel", material="stainless_austenitic:blasted"),
}
"""By the names that the comparison's flag takes."""


def arm_name(planner: str, link: str) -> str:
    """What the runs of a planner under a change are known by."""
    return f"{planner}, {link}"
