"""`franbv match`: the matcher alone, on a real infrared pair; scored when the camera's own depth is given."""

import math
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from jaxtyping import Float

from materials.input_error import InputError
from render.depth.coding import DepthFormat, metres_from_z16, z16_from_disparity
from render.matcher.by_name import MatcherName, matcher_by_name
from render.matcher.d400_preset import D400Preset, is_file_name, load_preset
from studies.base.console import say, say_json, warn
from studies.base.flags import parse
from studies.base.inputs import check_not_overwritten
from studies.scoring.match import HoleScore, MatchScore, fraction_shares, score
from studies.store.images import millimetres, write_png
from studies.store.stereo_files import read_pair, read_reference

_HELP = "Match a rectified infrared pair as a D400 camera does; score the depth against the camera's own."
MOST_OFFSET_PX = 3.0
"""Median difference of the disparities that is worth a word [px]; choice, real pairs are within one of their depth."""
LARGEST_UNIT_M = 1.0
"""Of a depth step [m] (librealsense: depth units up to 1 m)."""
LONGEST_BASELINE_M = 1.0
"""Above it the baseline was surely given in millimetres; choice, the D400 cameras have 18 to 95 mm."""


@dataclass(frozen=True)
class MatchCommand:
    """The flags of `franbv match`."""

    left: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="LEFT")]
    """Left infrared image (`infra1`): 8 bits, or 8 or 10 bits in 16."""
    right: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RIGHT")]
    """Right infrared image (`infra2`), of the same size and rectified with the left one."""
    fx: Annotated[float, tyro.conf.arg(metavar="PX")]
    """Focal length of the rectified stream [px]."""
    baseline: Annotated[float, tyro.conf.arg(metavar="M")]
    """Distance between the imagers [m]."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="DEPTH")] = None
    """Write the depth here: 16-bit PNG in millimetres, 0 = invalid."""
    reference: Annotated[Path | None, tyro.conf.arg(metavar="DEPTH")] = None
    """The camera's own depth: 16-bit PNG at full or half resolution, or a picture in jet colours whose black is a hole
    (then holes alone are scored)."""
    reference_unit: Annotated[float | None, tyro.conf.arg(metavar="M")] = None
    """Depth of one step of the reference [m]; the default is the preset's depth unit, 0.001 if it names none."""
    matcher: MatcherName = "d4"
    """`d4` fails like the camera's chip; `sgbm` is OpenCV's StereoSGBM."""
    preset: Annotated[str, tyro.conf.arg(metavar="NAME|FILE")] = "default"
    """Preset of the RealSense viewer: default, high_accuracy, high_density, medium_density, hand, or a JSON file."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Match the pair; 0 when that was done."""
    command = parse(MatchCommand, args, "franbv match", _HELP)
    focal_baseline = _focal_baseline(command.fx, command.baseline)
    preset = load_preset(command.preset)
    if preset.ignored:
        warn(f"franbv match: {command.preset}: no counterpart, ignored: {', '.join(preset.ignored)}")
    if command.out:
        file = Path(command.preset) if is_file_name(command.preset) else None
        check_not_overwritten((command.left, command.right, command.reference, file), (command.out,))
    left, right, how = read_pair(command.left, command.right)
    if how:
        warn(f"franbv match: {command.left}, {command.right}: {how}")
    unit = _unit(command.reference_unit, preset)
    reference = read_reference(command.reference, left.shape, unit) if command.reference else None

    matcher = matcher_by_name(command.matcher, preset)
    start = time.perf_counter()
    disparity = matcher.match(left, right, None, preset.shift)
    elapsed = time.perf_counter() - start
    if command.out:
        coding = DepthFormat(unit=preset.depth_unit)
        _write_depth(command.out, metres_from_z16(z16_from_disparity(disparity, focal_baseline, coding), coding))

    shares = fraction_shares(disparity)
    filled = float(np.mean(disparity > 0))
    say(
        f"{filled:.1%} of {left.shape[1]}x{left.shape[0]} pixels have depth; "
        f"matched in {elapsed:.2f} s, compilation included"
    )
    say("fractions of a pixel in eighths, 1 = flat: " + " ".join(f"{share:.2f}" for share in shares))
    result = score(disparity, reference, left, focal_baseline) if reference else None
    if result:
        say(score_table(result))
        if odd := _odd_offset(disparity, result, focal_baseline, unit):
            warn(f"franbv match: {command.reference}: {odd}")
    if command.json:
        say_json(
            {
                "matcher": command.matcher,
                "preset": preset.name,
                "ignored": list(preset.ignored),
                "filled": filled,
                "fraction_shares": shares.tolist(),
                "wall_s": elapsed,
                "out": str(command.out) if command.out else None,
                "score": result.summary() if result else None,
            }
        )
    return 0


def score_table(result: MatchScore) -> str:
    """The score as text."""
    head = f"{'holes':<10}{'reference':>10}{'found':>8}{'precision':>11}{'recall':>8}{'IoU':>7}"
    lines = [head, _row("all", result.holes), *(_row(name, holes) for name, holes in result.classes.items())]
    lines += ["", f"{'blobs of':<14}{'reference':>10}{'found':>8}{'precision':>11}{'recall':>8}"]
    lines += [
        f"{f'>= {blob.at_least_px} px':<14}{blob.reference:>10}{blob.found:>8}"
        f"{_number(blob.precision):>11}{_number(blob.recall):>8}"
        for blob in result.blobs
    ]
    if result.disparity:
        error = result.disparity
        lines += [
            "",
            f"disparity error: median {error.p50_px:.3f} px, 90 % below {error.p90_px:.3f} px, {error.below_half:.1%} "
            f"below half a pixel ({error.pixels} pixels, offset {error.offset_px:+.3f} px taken out)",
        ]
    return "\n".join(lines)


def _row(name: str, holes: HoleScore) -> str:
    shares = f"{_number(holes.precision):>11}{_number(holes.recall):>8}{_number(holes.iou):>7}"
    return f"{name:<10}{holes.reference:>10}{holes.found:>8}{shares}"


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2f}"


def _focal_baseline(fx: float, baseline: float) -> float:
    if not (math.isfinite(fx) and fx > 0):
        raise InputError(f"--fx {fx:g}: must be above 0; give the focal length in pixels")
    if not (math.isfinite(baseline) and 0 < baseline <= LONGEST_BASELINE_M):
        raise InputError(f"--baseline {baseline:g}: must lie in (0, {LONGEST_BASELINE_M:g}]; give it in metres")
    return fx * baseline


def _unit(given: float | None, preset: D400Preset) -> float:
    """Depth of one step of the reference [m]."""
    if given is not None and not (math.isfinite(given) and 0 < given <= LARGEST_UNIT_M):
        raise InputError(f"--reference-unit {given:g}: must lie in (0, {LARGEST_UNIT_M:g}]; give it in metres")
    return preset.depth_unit if given is None else given


def _odd_offset(disparity: Float[np.ndarray, "h w"], result: MatchScore, focal_baseline: float, unit: float) -> str:
    """What to say of a median offset that no calibration leaves; "" for one that it may."""
    if result.disparity is None or not abs(result.disparity.offset_px) > MOST_OFFSET_PX:
        return ""
    offset, typical = result.disparity.offset_px, float(np.median(disparity[disparity > 0]))
    here = f"{1e3 * focal_baseline / max(typical, 1e-6):.0f} mm"
    there = f"{1e3 * focal_baseline / max(typical - offset, 1e-6):.0f} mm" if typical > offset else "beyond all range"
    return (
        f"its disparities are {offset:+.1f} px off (the pair gives {here}, it says {there}); is a step of it "
        f"{1e3 * unit:g} mm? give --reference-unit in metres, or check --fx and --baseline"
    )


def _write_depth(path: Path, depth: Float[np.ndarray, "h w"]) -> None:
    try:
        write_png(path, millimetres(depth))
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); choose another --out") from None
