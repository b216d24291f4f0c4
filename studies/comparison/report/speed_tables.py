"""What the measurement of planning times says, in rows and words: the goals, PB and RE at every size."""

from collections.abc import Mapping
from typing import Any

from studies.comparison.planning_speed import PAPER, decision_s
from studies.comparison.report.speed_figure import speed_figure

AXES = {"voxels": "map", "candidates": "candidates", "pixels": "depth image"}
"""What is varied, in words."""


def speed_section(speed: Mapping[str, Any]) -> dict[str, Any]:
    """What the page shows of a measurement."""
    return {
        "goals": speed_goal_rows(speed),
        "words": speed_words(speed),
        "figure": speed_figure(speed["rows"]),
        "rows": speed_rows(speed),
        "machine": speed["machine"],
    }


def speed_goal_rows(speed: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Each goal with what was measured, and whether it holds."""
    pb = speed["goals"]["pb_decision_s"]
    return [
        {
            "words": "One decision of PB",
            "goal": f"≤ {pb['at_most']:.2f} s",
            "measured": f"{pb['measured']:.3f} s",
            "holds": pb["measured"] <= pb["at_most"],
        },
    ]


def speed_rows(speed: Mapping[str, Any]) -> list[dict[str, Any]]:
    """A row per setting: its sizes, decision and scoring of both planners [ms], RE over PB."""
    settings = _settings(speed)
    axes = ["", *(pb["axis"] for pb, _ in settings)]
    return [
        {
            "axis": AXES[pb["axis"]],
            "first": pb["axis"] != before,
            "voxels": _cube(pb),
            "poses": pb["poses"],
            "pixels": f"{pb['rays']:,}",
            **{f"{row['planner']}_decision": f"{1e3 * decision_s(row):.0f}" for row in (pb, re)},
            **{f"{row['planner']}_score": f"{1e3 * row['score']:.1f}" for row in (pb, re)},
            "decision_ratio": f"{decision_s(re) / decision_s(pb):.2g}",
            "score_ratio": f"{re['score'] / pb['score']:.2g}",
        }
        for (pb, re), before in zip(settings, axes, strict=False)
    ]


def speed_words(speed: Mapping[str, Any]) -> str:
    """Who plans faster at the paper's size and elsewhere."""
    settings = _settings(speed)
    pb, re = next((pb, re) for pb, re in settings if (pb["axis"], pb["size"]) == PAPER)
    ours, theirs = (1e3 * decision_s(row) for row in (pb, re))
    decides, scores = (sum(f(a) < f(b) for a, b in settings) for f in (decision_s, lambda row: row["score"]))
    return (
        f"At the paper's size (a map of {pb['map_voxels']:,} voxels, {pb['poses']} candidates, {pb['rays']:,} pixels) "
        f"a decision takes {ours:.0f} ms with PB and {theirs:.0f} ms with RE, of which scoring takes "
        f"{1e3 * pb['score']:.1f} and {1e3 * re['score']:.1f} ms: a fast RE is {'not ' * (theirs <= ours)}slower than "
        f"PB there. Of {len(settings)} settings PB scores faster in {scores}, but must fit its ellipsoids first; it "
        f"decides faster in {decides}."
    )


def _settings(speed: Mapping[str, Any]) -> list[tuple[Mapping[str, Any], Mapping[str, Any]]]:
    """The rows of PB and RE of each setting, in the order of the measurement."""
    by_size: dict[tuple[str, int], dict[str, Mapping[str, Any]]] = {}
    for row in speed["rows"]:
        by_size.setdefault((row["axis"], row["size"]), {})[row["planner"]] = row
    return [(both["pb"], both["re"]) for both in by_size.values()]


def _cube(row: Mapping[str, Any]) -> str:
    """`96³`, or the number of voxels where the map is not among those that are varied."""
    return f"{row['size']}³" if row["axis"] == "voxels" else f"{row['map_voxels']:,}"
