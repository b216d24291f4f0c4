"""The main numbers of a comparison in two sentences, and the words for its parts, arm and software."""

from collections.abc import Iterable, Sequence

import numpy as np

from render.arm.arm import ArmLimits
from scenes.parts import PART_NAMES, part_description
from studies.base.numbers_as_text import number
from studies.comparison.paper_results import points
from studies.comparison.preset import CORNER, ComparisonPreset
from studies.comparison.statistics import Comparison

ARM = ArmLimits()
"""Whose motion times the runs have."""


def main_numbers(comparison: Comparison, arms: Sequence[str]) -> str:
    """Coverage of each planner on A to D, and FRA's lead on D."""
    parts = [part for part in PART_NAMES if comparison.runs(part, "fra")]
    reached = []
    for arm in arms:
        found = [comparison.figure(part, arm, "coverage_5mm") for part in parts]
        shares = ", ".join(number(100 * i.mean if i else None, ".1f") for i in found)
        reached.append(f"{arm.upper()} {shares} %")
    covered = f"On {', '.join(parts)} the methods cover on average {'; '.join(reached)} of the surface. "
    ends = {baseline: comparison.difference("D", "fra", baseline) for baseline in ("pb", "re")}
    leads = [f"{baseline.upper()} {points(end)}" for baseline, end in ends.items() if end]
    return (covered if parts else "") + (f"On D FRA less {', FRA less '.join(leads)}." if leads else "")


def part_words(part: str, preset: ComparisonPreset) -> str:
    """`A, matte steel cuboid`; the inside corner with its material."""
    if part == CORNER and preset.corner:
        name, _, finish = preset.corner.partition(":")
        material = f"{name.replace('_', ' ')}{', ' * bool(finish)}{finish}"
        return f"{short_words(part)}, two plates at a right angle ({material})"
    return f"{part}, {part_description(part)}" if part in PART_NAMES else short_words(part)


def short_words(part: str) -> str:
    """`A`, `Inside corner`."""
    return part if part in PART_NAMES else part.replace("_", " ").capitalize()


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
