"""`franbv calibrate hand-eye`: where the camera sits on the flange; `python -m franbv.adapters` does the same alone."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from franbv.adapters.calibration.calibration_error import CalibrationError
from franbv.adapters.calibration.command import HAND_EYE_HELP, calibrate_hand_eye, hand_eye_sentence
from materials.input_error import InputError
from studies.base.console import say, say_json
from studies.base.flags import parse


@dataclass(frozen=True)
class HandEyeCommand:
    """The flags of `franbv calibrate hand-eye`."""

    poses: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="POSES.json")]
    """Flange poses, each with an image of the board or the board's pose."""
    out: Annotated[Path, tyro.conf.arg(metavar="HAND_EYE.json")]
    """Write the result here; a new file."""
    json: bool = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Calibrate, write the result, say how well it fits."""
    command = parse(HandEyeCommand, args, "franbv calibrate hand-eye", HAND_EYE_HELP)
    try:
        record = calibrate_hand_eye(command.poses, command.out)
    except CalibrationError as error:
        raise InputError(str(error)) from error
    say(f"{command.out}: {hand_eye_sentence(record)}")
    if command.json:
        say_json(record)
    return 0
