"""`franbv frame`: one frame of a part from one pose, with every layer of it and the truth behind it."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro
from jaxtyping import Bool, UInt16
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from render.d435i import Measurement, SensorSettings, SimulatedD435i
from render.depth.decimation import crop_centre
from render.labels.labels import label_frame
from render.world.scene_geometry import NO_BODY
from render.world.truth import Truth, looks_at_part
from studies.base.atomic_file import write_atomically
from studies.base.console import say, say_json, strict_json, warn
from studies.base.flags import parse_case_command
from studies.base.pose_text import camera_pose
from studies.base.single_case import made_once
from studies.run.scene_settings import Subject, SubjectSettings, build_subject, on_bench, resolved
from studies.store.cause_files import colour_map, decimated_map, legend, legend_picture
from studies.store.images import MM, millimetres, write_exr, write_png
from studies.work.maker import versions

META = "meta.json"
_HELP = "Take one frame of a part and write its infrared pair, its depth, and the truth and the cause of every hole."

FRAME_LAYERS = {
    "infra1.png": "left infrared image [DN]",
    "infra2.png": "right infrared image [DN]",
    "depth.png": "Z-depth of the left imager at full resolution [mm], 0 = invalid",
    "depth_{size}.png": "the same decimated and cropped, as the planner gets it [mm], 0 = invalid",
    "truth_depth.exr": "true Z-depth, channel Y [m], 0 = nothing there",
    "incidence.exr": "true angle between surface normal and view ray, channel Y [rad], NaN = nothing there",
    "part.png": "1 + number of the body in `bodies`, 0 = nothing there",
    "cause.png": "why each pixel has no depth or a false one, in the colours of legend.png [red, green, blue]",
    "cause_id.png": "the same by number, see legend.json",
    "cause_id_{size}.png": "the same by number after decimation and crop",
    "legend.png": "colour, name and meaning of every cause [red, green, blue]",
    "legend.json": "number, name, colour and meaning of every cause, and how many pixels have it",
}
"""Files of a frame beside META, and what they hold. `{size}` is 60x40 with the default sensor."""


class FrameSettings(SubjectSettings):
    """What decides a frame."""

    pose: Annotated[str | None, tyro.conf.arg(metavar="AZIMUTH,ELEVATION,DISTANCE|eye:X,Y,Z")] = None
    """Camera pose around the part [deg, deg, m], or its position [m]; the default is the planner's first view."""


def run(args: list[str]) -> int:
    """Take the frame, unless it is there already."""
    command = parse_case_command(FrameSettings, args, "franbv frame", _HELP)
    settings = on_bench(command.settings)
    subject = build_subject(settings)
    pose = camera_pose(settings.pose, subject.scene, settings.sensor.mount_roll_deg)
    for notice in subject.notices:
        warn(f"franbv frame: {notice}")
    config = resolved(settings)
    files = [*layer_files(settings.sensor), META]
    case, found = made_once(
        "frame", config, command.out, files, lambda folder: write_frame(folder, config, subject, pose)
    )
    summary = json.loads((case / META).read_text())["summary"]
    say(f"{subject.title}. {frame_sentence(summary)}\n{'Found' if found else 'Written'}: {case}")
    if command.json:
        say_json({"folder": str(case), **summary})
    return 0


def write_frame(folder: Path, config: FrameSettings, subject: Subject, pose: RigidTransform) -> None:
    """Measure one frame and write all its layers."""
    # The matcher works only where the crop needs it; here the whole image is wanted, and cropped afterwards.
    camera = SimulatedD435i(subject.scene, config.sensor.model_copy(update={"crop": None}), config.seed)
    measurement, truth = camera.measure(pose, 1), camera.truth(pose)
    depth = millimetres(measurement.depths[0])
    reduced, reduced_intrinsics = reduced_depth(measurement, config.sensor)
    labels = label_frame(camera, pose, measurement, truth=truth)
    small_causes = decimated_map(labels, measurement.burst.intrinsics, config.sensor.crop)
    causes = (colour_map(labels.picture), labels.picture, small_causes, legend_picture(), None)
    images = (measurement.lefts[0], measurement.rights[0], depth, reduced, None, None, truth_ids(truth), *causes)
    files = layer_files(config.sensor)
    for file, image in zip(files, images, strict=True):
        if image is not None:
            write_png(folder / file, image)
    write_exr(folder / "truth_depth.exr", truth.depth, "Y")
    write_exr(folder / "incidence.exr", truth.incidence, "Y")
    write_atomically(folder / "legend.json", strict_json(legend(labels), indent=1).encode())
    part = looks_at_part(truth, subject.scene)
    meta = {
        "command": "frame",
        "title": subject.title,
        "config": config.model_dump(mode="json"),
        "versions": versions(),
        "layers": dict(zip(files, FRAME_LAYERS.values(), strict=True)),
        "T_world_cam": pose.as_matrix().tolist(),
        "T_world_right_cam": camera.rig.right_imager(pose).as_matrix().tolist(),
        "baseline_m": camera.rig.baseline,
        "intrinsics": {"full": asdict(camera.rig.intrinsics), "reduced": asdict(reduced_intrinsics)},
        "exposure_us": measurement.imager.exposure_us,
        "gain": measurement.imager.gain,
        "bodies": [
            {"name": body.name, "material": body.material.name, "is_part": body.is_part}
            for body in subject.scene.bodies
        ],
        "summary": frame_summary(depth, truth, part),
    }
    write_atomically(folder / META, strict_json(meta, indent=1).encode())


def layer_files(sensor: SensorSettings) -> list[str]:
    """Names of the layers' files for this sensor."""
    size = f"{sensor.crop[0]}x{sensor.crop[1]}" if sensor.crop else "reduced"
    return [file.format(size=size) for file in FRAME_LAYERS]


def reduced_depth(measurement: Measurement, sensor: SensorSettings) -> tuple[UInt16[np.ndarray, "h w"], Intrinsics]:
    """Depth as the planner gets it [mm], and its intrinsics, of a measurement without crop."""
    depths = millimetres(measurement.burst.depths[0])[None]
    if sensor.crop is None:
        return depths[0], measurement.burst.intrinsics
    cropped, intrinsics = crop_centre(depths, measurement.burst.intrinsics, sensor.crop)
    return cropped[0], intrinsics


def truth_ids(truth: Truth) -> np.ndarray:
    """1 + body number of every pixel (h, w) uint8, 0 = nothing there."""
    return np.where(truth.body == NO_BODY, 0, truth.body + 1).astype(np.uint8)


def frame_summary(depth: UInt16[np.ndarray, "h w"], truth: Truth, part: Bool[np.ndarray, "h w"]) -> dict[str, Any]:
    """How much of the part has depth at full resolution, and how true that is."""
    measured = part & (depth > 0)
    error = np.abs(depth[measured] - MM * truth.depth[measured].astype(float))
    return {
        "part_pixels": int(part.sum()),
        "part_fill": float(measured.sum() / part.sum()) if part.any() else None,
        "part_error_mm_median": float(np.median(error)) if len(error) else None,
        "part_incidence_deg_median": float(np.degrees(np.median(truth.incidence[part]))) if part.any() else None,
    }


def frame_sentence(summary: dict[str, Any]) -> str:
    """The summary in words."""
    if not summary["part_pixels"]:
        return "The part is not in the picture."
    fill = f"{100 * summary['part_fill']:.1f} % of its {summary['part_pixels']} pixels have depth"
    if summary["part_error_mm_median"] is None:
        return f"{fill}."
    return f"{fill}, half of them within {summary['part_error_mm_median']:.1f} mm of the truth."
