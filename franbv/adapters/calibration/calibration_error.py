"""The one exception of the calibration: what a person with a board in the hand can mend."""


class CalibrationError(ValueError):
    """A board that is not seen well, or poses that no calibration can be made of. One line: the thing, the place, the
    mend."""
