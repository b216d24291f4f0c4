"""The paper's box plots with ours beside them: coverage of each method, recoveries, and what recovery brought."""

import math
from collections.abc import Sequence

from markupsafe import Markup

from studies.comparison.method_names import method_name
from studies.comparison.paper import ACTIVATIONS, CONTRIBUTION, FINAL_COVERAGE
from studies.comparison.records import CONTRIBUTED
from studies.comparison.statistics import Comparison
from studies.drawing.box_figure import BoxGroup, BoxPanel, BoxSeries, box_figure
from studies.drawing.cells import POINTS
from studies.statistics.boxes import TukeyBox

PAPER_AND_HERE = (BoxSeries("paper", "paper"), BoxSeries("here", ""))
"""The boxes of every group."""


def coverage_boxes(comparison: Comparison, parts: Sequence[str], arms: Sequence[str], words: dict[str, str]) -> Markup:
    """A panel per part: paper and ours of each method."""
    panels = [
        BoxPanel(
            words[part],
            "map covers [%]",
            ".1f",
            0.0,
            100.0,
            [
                BoxGroup(
                    method_name(arm),
                    arm,
                    [_points(FINAL_COVERAGE.get(part, {}).get(arm)), _points(comparison.box(part, arm))],
                )
                for arm in arms
            ],
        )
        for part in parts
    ]
    return box_figure("Final coverage, the paper's and ours", panels, PAPER_AND_HERE)


def recovery_boxes(comparison: Comparison, parts: Sequence[str]) -> Markup:
    """FRA's recoveries a run and the points that they brought, part by part."""
    counts = [
        _group(part, ACTIVATIONS.get(part), comparison.box(part, "fra", "recovery_activations")) for part in parts
    ]
    brought = [
        _group(part, _points(CONTRIBUTION.get(part)), _points(comparison.box(part, "fra", CONTRIBUTED)))
        for part in parts
    ]
    panels = [
        _panel("Recoveries a run", "count", "g", counts, 5.0),
        _panel("Brought by recovery", "points", "z.1f", brought, 20.0),
    ]
    return box_figure("Recoveries and what they brought, the paper's and ours", panels, PAPER_AND_HERE)


def _group(part: str, theirs: TukeyBox | None, ours: TukeyBox | None) -> BoxGroup:
    return BoxGroup(part, "fra", [theirs, ours])


def _panel(title: str, axis: str, form: str, groups: Sequence[BoxGroup], step: float) -> BoxPanel:
    """Over an axis from zero, or below it, in whole steps."""
    ends = [end for group in groups for box in group.boxes if box for end in box.ends] or [0.0]
    low, high = (step * math.floor(min(0.0, *ends) / step), step * max(1, math.ceil(max(ends) / step)))
    return BoxPanel(title, axis, form, low, high, groups)


def _points(box: TukeyBox | None) -> TukeyBox | None:
    return box.scaled(POINTS) if box else None
