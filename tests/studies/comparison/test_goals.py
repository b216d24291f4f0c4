"""Goals of the comparison, wherever one may compare: bounds and moments counted by hand."""

import pytest

from studies.comparison.goals import GOALS, activations_rise, goals_json, judge
from studies.comparison.statistics import Comparison
from studies.comparison.summary import json_summary
from tests.studies.comparison.comparison_records import made_record


def recovering(part: str, run: int = 0) -> list:
    """FRA recovers once after the first view, PB does not; where both have two iterations or four views differs."""
    return [
        made_record(part, "fra", run, (0.3, 0.6, 0.7, 0.9), "frnn", filtered=(0.2, 0.3, 0.4, 0.5), activations=1),
        made_record(part, "pb", run, (0.3, 0.4, 0.5, 0.6, 0.85), "fnnnn", filtered=(0.3, 0.4, 0.5, 0.6, 0.6)),
    ]


def test_a_goal_may_hold_at_one_moment_and_fail_at_another():
    """31 points on D: +5 at the ends, +40 after two iterations, +30 after four views; filtered -10, 0, -10."""
    goal = next(goal for goal in GOALS if goal.name == "fra_less_pb_on_d")
    found = {(j.at, j.cloud): (j.interval.mean, j.holds) for j in judge(Comparison(recovering("D")), goal)}
    assert found == {
        ("end", "raw"): (pytest.approx(0.05), False),
        ("end", "filtered"): (pytest.approx(-0.1), False),
        ("iterations", "raw"): (pytest.approx(0.4), True),
        ("iterations", "filtered"): (pytest.approx(0.0), False),
        ("acquisitions", "raw"): (pytest.approx(0.3), False),
        ("acquisitions", "filtered"): (pytest.approx(-0.1), False),
    }
    assert judge(Comparison(recovering("A")), goal) == []


@pytest.mark.parametrize(("lead", "holds"), [(0.029, True), (-0.029, True), (0.031, False), (-0.031, False)])
def test_alike_means_neither_above_nor_below(lead: float, holds: bool):
    """Three points to either side."""
    goal = next(goal for goal in GOALS if goal.name == "fra_less_pb_on_b")
    assert goal.holds(lead) == holds


@pytest.mark.parametrize(
    ("activations", "holds"),
    [((1, 1, 2, 3), True), ((2, 1, 3, 4), False), ((1, 2, 2, 3), False), ((0, 1, 3, 3), False), ((0, 0, 0, 0), False)],
)
def test_activations_rise_from_part_to_part(activations: tuple[int, ...], holds: bool):
    """A <= B < C < D, of the means over runs."""
    records = [made_record(part, activations=n) for part, n in zip("ABCD", activations, strict=True)]
    assert activations_rise(Comparison(records)) == (list(activations), holds)
    assert activations_rise(Comparison(records[:3])) == ([*activations[:3], None], None)


def test_json_tells_the_goals():
    """Mean, interval and verdict by moment and cloud; nothing where a part has no runs."""
    goals = json_summary(Comparison(recovering("D")), ["D"], ("fra", "pb"), 0, 1.0)["goals"]
    cell = goals["fra_less_pb_on_d"]["iterations"]["raw"]
    assert cell == {"mean": pytest.approx(0.4), "ci95": pytest.approx([0.4, 0.4]), "holds": True}
    assert goals["fra_less_pb_on_a"] == {"end": {}, "iterations": {}, "acquisitions": {}}
    assert goals["activations_rise"] == {"mean": [None, None, None, 1.0], "holds": None}
    assert set(goals_json(Comparison([]))) == {goal.name for goal in GOALS} | {"activations_rise"}
