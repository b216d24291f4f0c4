"""The imagers' sensor chips: how large their pixels are, and how far the lens stands before them.

A stream shows the whole row of the chip and bins its pixels, or, where its own sides are less wide than the chip's, the
middle of the row and the whole height.
"""

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Chip:
    """The part of a chip that a stream shows, behind its lens."""

    pixel_pitch: float
    """Width of a native pixel [m]."""
    width: float
    """Native pixels along a row of what the stream shows."""
    height: float
    """Native pixels along a column of it."""
    focal_length: float
    """Of the lens [m]."""

    def shown(self, width: int, height: int) -> "Chip":
        """The largest part about the middle with the sides of a stream of this size [px]."""
        sides = min(self.width, self.height * width / height), min(self.height, self.width * height / width)
        return replace(self, width=sides[0], height=sides[1])

    def native_pixels(self, width: int) -> float:
        """Native pixels that one pixel of a stream of this width averages (OV9282: 1 at 1280, 4 at 640)."""
        return (self.width / width) ** 2

    def pitch(self, width: int) -> float:
        """Width on the chip of one pixel of a stream of this width [m]."""
        return self.pixel_pitch * self.width / width


OV9282 = Chip(pixel_pitch=3.0e-6, width=1280, height=800, focal_length=642.0 * 3.0e-6)
"""Of the D435i (OmniVision OV9282; D400 datasheet: 1.93 mm, which is 642 px at full resolution)."""
OV2740 = Chip(pixel_pitch=1.4e-6, width=1920, height=1080, focal_length=1.5 * 899.5 * 1.4e-6)
"""Of the D415 (OmniVision OV2740; D400 datasheet: 1.88 mm; 899.5 px of the 1280x720 stream, 1.5 native ones each)."""
