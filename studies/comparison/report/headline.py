"""The main numbers of a comparison in two sentences, what was run, and the words for its parts, arm and software."""

from collections.abc import Iterable, Sequence

import numpy as np

from render.arm.arm import ArmLimits
from scenes.parts import ALL_PARTS, part_description
from studies.base.numbers_as_text import counted, number
from studies.comparison.cases import run_settings
from studies.comparison.method_names import method_name
from studies.comparison.paper import FINAL_COVERAGE, PAPER_PARTS, paper_lead
from studies.comparison.preset import CORNER, ComparisonPreset
from studies.comparison.statistics import Comparison
from studies.run.ablation import Ablation
from studies.run.reconstruct import ReconstructSettings
from studies.statistics.medians import MedianEstimate, first_less_second

ARM = ArmLimits()
"""Whose motion times the runs have."""


def main_numbers(comparison: Comparison, arms: Sequence[str]) -> str:
    """Median coverage of each planner on A to D, and FRA's lead on D beside the paper's."""
    parts = [part for part in PAPER_PARTS if comparison.runs(part, "fra")]
    reached = []
    for arm in arms:
        found = [comparison.median(part, arm) for part in parts]
        shares = ", ".join(number(100 * e.value if e else None, ".1f") for e in found)
        theirs = [FINAL_COVERAGE[part].get(arm) for part in parts]
        paper = ", ".join(f"{100 * box.median:.1f}" for box in theirs if box)
        reached.append(f"{method_name(arm)} {shares} %" + (f" (paper: {paper})" if paper else ""))
    covered = f"On {', '.join(parts)} the final maps of the methods cover, in the median, {'; '.join(reached)}. "
    ends = {baseline: comparison.of_medians("D", ("fra", baseline), first_less_second) for baseline in ("pb", "re")}
    leads = [
        f"{baseline.upper()} {_lead_words(end)} (paper: {100 * paper_lead('D', baseline):+.1f})"
        for baseline, end in ends.items()
        if end
    ]
    return (covered if parts else "") + (f"On D FRA less {', FRA less '.join(leads)}." if leads else "")


def _lead_words(lead: MedianEstimate) -> str:
    interval = f"{100 * lead.low:+z.1f} to {100 * lead.high:+z.1f}" if lead.count > 1 else "one run"
    return f"{100 * lead.value:+z.1f} points ({interval})".replace("-", "\u2212")


def bench_words(parts: Sequence[str], preset: ComparisonPreset) -> list[tuple[str, str]]:
    """What was run and on which bench, term by term."""
    if not parts:
        return []
    run = run_settings(preset, parts[0], preset.planners[0], 0, Ablation())
    sensor, parameters = run.sensor, run.parameters
    crop = f", the middle {sensor.crop[0]} x {sensor.crop[1]} pixels of it" if sensor.crop else ""
    mount = f"turned by {sensor.roll_deg:g}\u00b0 about its axis" if sensor.roll_deg else "level"
    planned = counted(preset.runs, "start")
    return [
        ("Objects", "; ".join(part_words(part, preset) for part in parts)),
        ("Methods", f"{', '.join(map(method_name, preset.planners))}, each from {planned} around each object"),
        ("Surroundings", ", ".join(f"{name} \u201c{value}\u201d" for name, value in _surroundings(run).items())),
        (
            "Camera",
            f"simulated {sensor.model.upper()}, stream {sensor.profile}, preset {_preset_words(sensor.preset)}, laser "
            f"{sensor.imager.laser_power_mw:g} mW, depth decimated by {sensor.decimation}{crop}; {mount}",
        ),
        (
            "Method",
            f"voxels of {1000 * parameters.voxel_size:g} mm, {parameters.n_frames} frames a pose, up to "
            f"{parameters.max_iterations} NBV iterations, recoveries of up to {parameters.n_recovery_poses} views",
        ),
    ]


def _surroundings(run: ReconstructSettings) -> dict[str, str]:
    """What stands around the object, by the names of the settings; what the run has none of is left out."""
    named = {"bench": run.bench, "plinth": run.plinth, "lamps": run.lamps}
    return {name: value for name, value in named.items() if value}


def _preset_words(preset: str) -> str:
    return "of a file" if preset.lstrip().startswith("{") else preset.replace("_", " ")


def part_words(part: str, preset: ComparisonPreset) -> str:
    """`A, matte steel cuboid`; the inside corner with its material."""
    if part == CORNER and preset.corner:
        name, _, finish = preset.corner.partition(":")
        material = f"{name.replace('_', ' ')}{', ' * bool(finish)}{finish}"
        return f"{short_words(part)}, two plates at a right angle ({material})"
    return f"{part}, {part_description(part)}" if part in ALL_PARTS else short_words(part)


def short_words(part: str) -> str:
    """`A`, `Inside corner`."""
    return part if part in ALL_PARTS else part.replace("_", " ").capitalize()


def arm_words() -> str:
    """The limits of the arm that the motion times rest on."""
    turning = [f"{np.degrees(value):.0f}\u00b0/s" for value in (ARM.turning_speed, ARM.turning_acceleration)]
    return (
        f"straight moves of the wrist with at most {ARM.speed:g} m/s and {ARM.acceleration:g} m/s\u00b2, turns with at "
        f"most {turning[0]} and {turning[1]}\u00b2"
    )


def version_words(comparison: Comparison) -> str:
    """`drjit 1.5.0, numpy 2.4.6`, of all runs; what differs between them has several numbers."""
    found: dict[str, set[str]] = {}
    for record in comparison.records:
        for name, version in record.versions.items():
            found.setdefault(name, set()).add(version)
    return ", ".join(f"{name} {_listed(versions)}" for name, versions in sorted(found.items()))


def _listed(versions: Iterable[str]) -> str:
    return " and ".join(sorted(versions))
