"""What `python -m franbv.adapters` does with RealSense cameras: list them, take one burst."""

import argparse
import json
import os
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError
from scipy.spatial.transform import RigidTransform

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense.burst import DEPTH_STREAM
from franbv.adapters.realsense.camera import RealSenseCamera, Shot
from franbv.adapters.realsense.devices import connected_devices, device_info, temperatures
from franbv.adapters.realsense.settings import RealSenseSettings
from franbv.adapters.realsense.source import open_source
from franbv.parameters import Parameters

_COLUMNS = {
    "serial": "serial_number",
    "name": "name",
    "firmware": "firmware_version",
    "usb": "usb_type_descriptor",
}
"""Of the list of cameras, with librealsense's names."""


def add_commands(commands: Any) -> None:
    """Tell the parser (of `argparse`) the commands and their flags."""
    cameras = commands.add_parser("cameras", help="list the RealSense cameras that are plugged in")
    cameras.add_argument("--json", action="store_true", help="print one JSON object as the last line")
    cameras.set_defaults(run=list_cameras)
    shoot = commands.add_parser("shoot", help="take one burst and store it")
    shoot.add_argument("--out", type=Path, required=True, metavar="FILE.npz", help="write the burst here")
    n_frames = Parameters().n_frames
    shoot.add_argument("--frames", type=int, default=n_frames, metavar="N", help=f"of the burst, N_k; {n_frames}")
    for name, field in RealSenseSettings.model_fields.items():
        words = " ".join((field.description or "").split()).replace("%", "%%")
        shoot.add_argument(f"--{name.replace('_', '-')}", metavar="VALUE", help=f"{words} [{field.default}]")
    shoot.set_defaults(run=shoot_once)


def list_cameras(flags: argparse.Namespace) -> int:
    """Print a line for every camera; 1 if there is none."""
    rows = [_row(device) for device in connected_devices()]
    for row in rows:
        sys.stdout.write("  ".join(str(value or "?") for value in row.values()) + "\n")
    if not rows:
        sys.stderr.write("no RealSense camera is connected; plug one into a USB 3 port\n")
    if flags.json:
        sys.stdout.write(json.dumps({"cameras": rows}) + "\n")
    return 0 if rows else 1


def _row(device: Any) -> dict[str, str]:
    """What is said of a camera; one that no program streams from does not tell its temperatures."""
    found: dict[str, float] = {}
    for sensor in device.query_sensors():
        found |= temperatures(sensor)
    words = ", ".join(f"{name.removesuffix('_deg_c')} {value:.0f} deg C" for name, value in found.items())
    row = {name: device_info(device, key) for name, key in _COLUMNS.items()}
    return row | {"temperature": words or "not told while it does not stream"}


def shoot_once(flags: argparse.Namespace) -> int:
    """Take a burst and write it; 0 when that was done."""
    out: Path = flags.out
    if out.suffix != ".npz" or not out.parent.is_dir() or out.exists():
        raise CameraError(f"{out}: give the name of a new .npz file in a folder that exists")
    settings = _settings(flags)
    with RealSenseCamera(settings, open_source) as camera:
        shot = camera.shoot(RigidTransform.identity(), flags.frames)
        _write(out, shot, camera.record())
    depth = shot.burst.median_depth()
    valid = depth[depth > 0]
    middle = f"median depth {np.median(valid):.3f} m" if len(valid) else "no depth at all"
    sys.stdout.write(
        f"{out}: {flags.frames} frames of {depth.shape[1]}x{depth.shape[0]}, {middle}, "
        f"{len(valid) / depth.size:.0%} valid, {shot.taken.dropped} dropped\n"
    )
    return 0


def _settings(flags: argparse.Namespace) -> RealSenseSettings:
    """The settings that the flags say; CameraError that names the first flag that cannot be."""
    said = {name: value for name in RealSenseSettings.model_fields if (value := getattr(flags, name)) is not None}
    try:
        return RealSenseSettings.model_validate(said)
    except ValidationError as error:
        first = error.errors()[0]
        flag = f"--{str(first['loc'][0]).replace('_', '-')}" if first["loc"] else "shoot"
        raise CameraError(f"{flag}: {first['msg'].removeprefix('Value error, ')}; see shoot --help") from None


def _write(out: Path, shot: Shot, record: dict[str, Any]) -> None:
    """One archive of plain arrays, put in place when it is whole."""
    arrays: dict[str, Any] = {
        "depths_m": shot.burst.depths,
        "z16": shot.taken.images[DEPTH_STREAM],
        "frame_numbers": shot.taken.numbers,
        "timestamps_ms": shot.taken.timestamps_ms,
    }
    for side, images in (("left", shot.lefts), ("right", shot.rights)):
        if images is not None:
            arrays[f"{side}_infrared"] = images
    said = record | {
        "intrinsics": asdict(shot.burst.intrinsics),
        "clock": shot.taken.clock,
        "dropped": shot.taken.dropped,
        "discarded": shot.taken.discarded,
        "repeated": shot.taken.repeated,
        "unmatched": shot.taken.unmatched,
        "restarts": shot.restarts,
        "readings": shot.taken.readings,
    }
    arrays["record"] = np.array(json.dumps(said))
    unfinished = out.with_suffix(".part")
    try:
        with unfinished.open("wb") as file:
            np.savez_compressed(file, **arrays)
        os.replace(unfinished, out)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        raise CameraError(f"{out}: cannot be written ({error.strerror}); choose another place") from None
