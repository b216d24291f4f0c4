"""The one exception of the cameras: what a person at the robot can mend."""


class CameraError(RuntimeError):
    """A camera that is not there, does not do what it is asked, or fell silent. One line: the thing, the place, the
    mend."""
