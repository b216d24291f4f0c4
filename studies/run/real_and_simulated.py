"""Recorded depth beside depth that is rendered from the same poses: holes, false depth and bias, by angle of incidence.

The scene file tells part, materials and lamps; the sensor is the recorded one unless the file says otherwise. The scene
is taken for the truth: where the real part stands elsewhere, real depth is called false or biased, and that is the
fault of its place. Pixels count that look at the part, each in each view.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32

from franbv.acquisition import Acquisition
from franbv.adapters.recording.contents import Recording
from franbv.frames import Intrinsics
from materials.input_error import InputError
from render.d435i import SimulatedD435i
from render.labels.outcome import INVALID_SHARE, blocks, is_false_depth
from render.world.truth import looks_at_part
from studies.base.atomic_file import file_digest
from studies.base.config import read_yaml, validated
from studies.run.recorded_sensor import check_recorded_sensor, sensor_fields
from studies.run.scene_settings import SubjectSettings, build_subject, resolved

INCIDENCE_EDGES_DEG = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)
"""Edges of the classes of incidence [deg]. Choice: lobes of shiny metals are about as wide."""
PART_SHARE = 0.5
"""Share of a block's pixels that look at the part from which on the block does [-] (choice: most of them)."""
FOCAL_TOLERANCE = 0.03
"""By how much the focal lengths of the two cameras may differ, of the recorded one [-]. Choice: calibrations of cameras
of one model differ by 1 % (`render.world.rig.FOCAL_LENGTHS_PX`), other models and other streams by more, and at the
border of a 60 x 40 image 3 % are a pixel."""
MM_PER_METRE = 1000.0


@dataclass(frozen=True, eq=False)
class TwinPixels:
    """Pixels of the part, real and simulated, of any number of views."""

    real: Float32[np.ndarray, "n"]
    """Median Z-depth of the recorded burst [m], 0 = hole."""
    simulated: Float32[np.ndarray, "n"]
    """The same of the rendered one [m]."""
    true: Float32[np.ndarray, "n"]
    """Z-depth of the scene [m]."""
    incidence_deg: Float32[np.ndarray, "n"]
    """Between view ray and normal [deg]."""

    def of(self, which: Bool[np.ndarray, "n"]) -> "TwinPixels":
        """Some of them."""
        return TwinPixels(self.real[which], self.simulated[which], self.true[which], self.incidence_deg[which])

    @classmethod
    def joined(cls, views: Iterable["TwinPixels"]) -> "TwinPixels":
        """Those of several views."""
        parts = [(v.real, v.simulated, v.true, v.incidence_deg) for v in views]
        return cls(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


@dataclass(frozen=True, eq=False)
class Twin:
    """The scene file before the recorded camera."""

    settings: SubjectSettings
    camera: SimulatedD435i

    @classmethod
    def of(cls, file: Path, recording: Recording, decimation: int, crop: tuple[int, int] | None) -> "Twin":
        """InputError for what is wrong with the file or with the sensor that the recording states, and where the two
        cameras' images cannot be compared."""
        own = dict(recording.run.sensor) or {"decimation": decimation, "crop": crop, **sensor_fields(recording)}
        said = scene_keys(file)
        try:
            settings = validated(SubjectSettings, {**said, "sensor": {**own, **said.get("sensor", {})}}, str(file))
            scene = build_subject(settings).scene
        except InputError:
            check_recorded_sensor(recording)  # it may be the recording's fault
            raise
        settings = resolved(settings)
        camera = SimulatedD435i(scene, settings.sensor, settings.seed)
        check_comparable(file, camera.intrinsics, recording.camera.intrinsics)
        return cls(settings, camera)

    def figures(self, acquisitions: Iterable[Acquisition]) -> list[dict[str, float | str]]:
        """Render every pose; `twin_figures` of all of them."""
        pixels = TwinPixels.joined(twin_pixels(self.camera, acquisition) for acquisition in acquisitions)
        return twin_figures(pixels, self.camera.rig.focal_baseline)


def check_comparable(file: Path, simulated: Intrinsics, recorded: Intrinsics) -> None:
    """InputError where a pixel of one camera is none of the other; file: that which says what is simulated."""
    ours, theirs = simulated, recorded
    if (ours.width, ours.height) != (theirs.width, theirs.height):
        raise InputError(
            f"{file}: the simulated camera has {ours.width} x {ours.height} pixels and the recorded one "
            f"{theirs.width} x {theirs.height}; set sensor.profile, sensor.decimation and sensor.crop there"
        )
    if max(abs(ours.fx / theirs.fx - 1), abs(ours.fy / theirs.fy - 1)) > FOCAL_TOLERANCE:
        raise InputError(
            f"{file}: the simulated camera has focal lengths of {ours.fx:.1f} and {ours.fy:.1f} px and the recorded "
            f"one {theirs.fx:.1f} and {theirs.fy:.1f}, more than {FOCAL_TOLERANCE:.0%} apart; set sensor.model, "
            "sensor.profile and sensor.decimation there"
        )


def scene_keys(file: Path) -> dict[str, Any]:
    """What the scene file says."""
    said = read_yaml(file)
    if not isinstance(said.get("sensor", {}), dict):
        raise InputError(f"{file}: `sensor` holds no keys; write `sensor: {{profile: 640x360}}`, or leave it out")
    return said


def scene_digests(file: Path) -> dict[str, str]:
    """Hashes of the scene file and of the files that it names."""
    keys = {key: value for key, value in scene_keys(file).items() if key != "sensor"}
    named = resolved(validated(SubjectSettings, keys, str(file))).digests
    return {"scene": file_digest(file), **{f"scene/{name}": digest for name, digest in named.items()}}


def twin_pixels(camera: SimulatedD435i, acquisition: Acquisition) -> TwinPixels:
    """Render the acquisition's pose, and put both bursts side by side."""
    pose, n_frames = acquisition.burst.T_world_cam, len(acquisition.burst.depths)
    truth = camera.truth(pose)
    part = blocks(looks_at_part(truth, camera.scene), camera)
    there = part.mean(axis=-1) >= PART_SHARE
    only_part = np.where(part, 1.0, np.nan)[there]
    burst = camera.capture(pose, n_frames)
    arrays = (
        acquisition.burst.median_depth(INVALID_SHARE)[there],
        burst.median_depth(INVALID_SHARE)[there],
        np.nanmedian(blocks(truth.depth, camera)[there] * only_part, axis=-1),
        np.degrees(np.nanmedian(blocks(truth.incidence, camera)[there] * only_part, axis=-1)),
    )
    return TwinPixels(*(array.astype(np.float32) for array in arrays))


def twin_figures(pixels: TwinPixels, focal_baseline: float) -> list[dict[str, float | str]]:
    """A row for all angles, then one for each class that has pixels; shares as fractions, lengths in millimetres.

    Hole precision, recall and intersection over union say how the simulated holes find the real ones; false depth is
    that of `render.labels.outcome`; a bias is the median error of the pixels that have right depth.
    """
    rows = [{"incidence": "all", **_figures(pixels, focal_baseline)}]
    for low, high in pairwise(INCIDENCE_EDGES_DEG):
        chosen = pixels.of((pixels.incidence_deg >= low) & (pixels.incidence_deg < high))
        if len(chosen.true):
            rows.append({"incidence": f"{low:g} to {high:g} deg", **_figures(chosen, focal_baseline)})
    return rows


def _figures(pixels: TwinPixels, focal_baseline: float) -> dict[str, float]:
    simulated, real = pixels.simulated == 0, pixels.real == 0
    figures = {
        "pixels": len(pixels.true),
        "hole_precision": _share(simulated & real, simulated),
        "hole_recall": _share(simulated & real, real),
        "hole_iou": _share(simulated & real, simulated | real),
    }
    for name, depth in (("real", pixels.real), ("simulated", pixels.simulated)):
        wrong = is_false_depth(depth[None], pixels.true[None], focal_baseline)[0]
        right = (depth > 0) & ~wrong
        error = depth[right] - pixels.true[right]
        figures |= {
            f"{name}_hole_share": float(np.mean(depth == 0)),
            f"{name}_false_share": float(np.mean(wrong)),
            f"{name}_bias_mm": MM_PER_METRE * float(np.median(error)) if len(error) else float("nan"),
        }
    return figures


def _share(part: Bool[np.ndarray, "n"], whole: Bool[np.ndarray, "n"]) -> float:
    """NaN of nothing."""
    return float(part.sum() / whole.sum()) if whole.any() else float("nan")
