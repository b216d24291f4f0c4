"""The file of a hand-eye calibration: written once, read by whoever moves the camera."""

import json
import math
import os
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.adapters.calibration.calibration_error import CalibrationError
from franbv.adapters.calibration.hand_eye import HandEye, rms
from franbv.adapters.calibration.poses_file import as_transform, stated_json

_KEY = "T_flange_cam"


def hand_eye_record(found: HandEye, poses_path: Path) -> dict[str, Any]:
    """What the file holds."""
    mm, deg = rms(found.misfits)
    left_mm, left_deg = rms(found.left_out)
    apart = found.T_flange_cam_closed.inv() * found.T_flange_cam
    return {
        _KEY: found.T_flange_cam.as_matrix().tolist(),
        "T_base_board": found.T_base_board.as_matrix().tolist(),
        "frames": "metres; camera x right, y down, z forward; T_flange_cam maps camera points to flange points",
        "poses": len(found.misfits),
        "misfit_rms": {"mm": mm, "deg": deg},
        "left_out_rms": {"mm": _known(left_mm), "deg": _known(left_deg)},
        "closed_form_apart": {
            "mm": 1e3 * float(np.linalg.norm(apart.translation)),
            "deg": float(np.degrees(apart.rotation.magnitude())),
        },
        "of_each_pose": [
            {"mm": mm, "deg": deg, "left_out_mm": _known(left_mm), "left_out_deg": _known(left_deg)}
            for (mm, deg), (left_mm, left_deg) in zip(found.misfits.tolist(), found.left_out.tolist(), strict=True)
        ],
        "made_from": poses_path.name,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _known(number: float) -> float | None:
    return None if math.isnan(number) else number


def check_new(out: Path) -> None:
    """CalibrationError unless a file can be made there, and none is there yet."""
    if out.exists():
        raise CalibrationError(f"{out}: is there already; take another name, or remove it yourself")
    if not out.parent.is_dir():
        raise CalibrationError(f"{out}: no such folder; make it first")


def write_hand_eye(out: Path, record: dict[str, Any]) -> None:
    """Write the file whole or not at all; never over another."""
    check_new(out)
    unfinished = out.with_name(f".{out.name}.part")
    try:
        unfinished.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
        os.replace(unfinished, out)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        raise CalibrationError(f"{out}: cannot be written ({error.strerror}); choose another place") from error


def read_hand_eye(path: Path) -> RigidTransform:
    """T_flange_cam of such a file; CalibrationError where it holds none."""
    said = stated_json(path)
    matrix = said.get(_KEY) if isinstance(said, dict) else None
    try:
        rows = np.array(matrix, float)
    except (TypeError, ValueError):
        rows = np.zeros(0)
    if rows.shape != (4, 4):
        raise CalibrationError(f"{path}: has no {_KEY} of 4 x 4 numbers; make it with calibrate hand-eye")
    return as_transform(rows, f"{path}: {_KEY}")
