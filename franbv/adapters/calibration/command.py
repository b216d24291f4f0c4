"""`python -m franbv.adapters calibrate hand-eye`: where the camera sits on the flange."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from franbv.adapters.calibration.hand_eye import hand_eye
from franbv.adapters.calibration.hand_eye_file import check_new, hand_eye_record, write_hand_eye
from franbv.adapters.calibration.poses_file import pose_pairs

HAND_EYE_HELP = "Calibrate where the camera sits on the flange, from flange poses and images of a board."


def add_calibration_commands(commands: Any) -> None:
    """Tell the parser (of `argparse`) the command and its flags."""
    kinds = commands.add_parser("calibrate", help="calibrate camera and arm").add_subparsers(
        required=True, metavar="WHAT"
    )
    flags = kinds.add_parser("hand-eye", help=HAND_EYE_HELP.rstrip(".").lower())
    flags.set_defaults(run=_run)
    flags.add_argument("poses", type=Path, metavar="POSES.json", help="flange poses with images or poses of the board")
    flags.add_argument(
        "--out", type=Path, required=True, metavar="HAND_EYE.json", help="write the result here; a new file"
    )
    flags.add_argument("--json", action="store_true", help="print one JSON object as the last line of stdout")


def _run(flags: argparse.Namespace) -> int:
    record = calibrate_hand_eye(flags.poses, flags.out)
    sys.stdout.write(f"{flags.out}: {hand_eye_sentence(record)}\n")
    if flags.json:
        sys.stdout.write(json.dumps(record) + "\n")
    return 0


def calibrate_hand_eye(poses: Path, out: Path) -> dict[str, Any]:
    """Calibrate and write the result; CalibrationError for bad input, and for a result that is there already."""
    check_new(out)
    file, flanges, boards = pose_pairs(poses)
    record = hand_eye_record(hand_eye(flanges, boards, file.points()), poses)
    write_hand_eye(out, record)
    return record


def hand_eye_sentence(record: dict[str, Any]) -> str:
    """What a person wants to know of a calibration."""
    fit, left_out = record["misfit_rms"], record["left_out_rms"]
    words = f"{record['poses']} poses fit within {fit['mm']:.2f} mm and {fit['deg']:.3f} deg"
    if left_out["mm"] is None:
        return f"{words}; too few to foretell one from the others, take 15."
    return f"{words}; each is foretold by the others within {left_out['mm']:.2f} mm and {left_out['deg']:.3f} deg."
