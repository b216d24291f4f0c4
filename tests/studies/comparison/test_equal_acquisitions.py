"""Planners after equally many acquisitions: figures worked out by hand, what is shown of which study, the JSON."""

import json
import re

import pytest

from studies.comparison.equal_acquisitions import (
    compared_arms,
    coverage_after,
    is_compared_so,
    lead_after,
    mean_after,
    mean_seconds_each,
    needed,
    reached_levels,
    seconds_ratio,
)
from studies.comparison.goals import judge
from studies.comparison.preset import ComparisonPreset
from studies.comparison.report.equal_tables import equal_words, needed_words
from studies.comparison.report.page import comparison_html
from studies.comparison.statistics import Comparison
from studies.comparison.summary import json_summary, paragraph
from tests.studies.comparison.comparison_records import made_record

PLANNERS = ("fra", "pb", "fra-robust")


def rising(arm: str, run: int, end: float, acquisitions: int, part: str = "C", recoveries: int = 0):
    """A run that rises evenly to its end within ten acquisitions and stays there; recoveries follow the first view."""
    coverage = tuple(end * min(k, 10) / 10 for k in range(1, acquisitions + 1))
    kinds = "f" + recoveries * "r" + (acquisitions - 1 - recoveries) * "n"
    return made_record(part, arm, run, coverage, kinds, activations=bool(recoveries))


def three_planners(parts: str = "C") -> Comparison:
    """Two starts: FRA ends at 50 and 60 % after 34 acquisitions; after 30 PB at 50 and 50, fra-robust at 90 and 80."""
    ends = {"fra": (0.5, 0.6), "pb": (0.5, 0.5), "fra-robust": (0.9, 0.8)}
    return Comparison(
        rising(arm, run, end, 34 if arm == "fra" else 30, part, 4 if arm == "fra" else 0)
        for part in parts
        for arm, found in ends.items()
        for run, end in enumerate(found)
    )


def test_a_run_that_has_ended_keeps_its_last_value():
    """Six acquisitions, one of them a recovery that counts: the fifth covers 0.5, and from the sixth on it is 0.55."""
    record = made_record(coverage=(0.1, 0.2, 0.3, 0.4, 0.5, 0.55), kinds="frnnnn")
    assert [coverage_after(record, n) for n in (1, 5, 6, 7, 30)] == [0.1, 0.5, 0.55, 0.55, 0.55]


def test_means_and_differences_are_of_equal_acquisitions_and_starts():
    """After five acquisitions half of the end: fra-robust 45 and 40 %, FRA 25 and 30 %; so +20 and +10 points.

    The interval of two runs is from one to the other. A third run of FRA alone counts in its mean and in no difference.
    """
    comparison = Comparison([*three_planners().records, rising("fra", 2, 1.0, 34)])
    mean, lead = mean_after(comparison, "C", "fra", 5), lead_after(comparison, "C", "fra-robust", "fra", 5)
    assert mean is not None
    assert lead is not None
    assert (mean.mean, mean.count) == (pytest.approx((0.25 + 0.3 + 0.5) / 3), 3)
    i = lead.interval
    assert (i.mean, i.low, i.high, i.count) == (pytest.approx(0.15), pytest.approx(0.1), pytest.approx(0.2), 2)
    assert lead.p == 0.5  # of two differences of one sign: 2 of the 4 choices of signs
    late = lead_after(comparison, "C", "fra-robust", "pb", 30)
    assert late is not None
    assert late.interval.mean == pytest.approx((0.4 + 0.3) / 2)
    assert mean_after(comparison, "D", "fra", 5) is None
    assert lead_after(comparison, "C", "re", "fra", 5) is None


def test_equal_differences_have_no_width():
    """Four starts with 10 points between the two, whatever their level: the paired interval is a point."""
    records = [rising(arm, k, 0.4 + 0.1 * k + (arm == "pb") * 0.1, 30) for k in range(4) for arm in ("fra", "pb")]
    lead = lead_after(Comparison(records), "C", "pb", "fra", 10)
    assert lead is not None
    assert (lead.interval.low, lead.interval.mean, lead.interval.high) == pytest.approx((0.1, 0.1, 0.1))


def test_acquisitions_until_a_coverage_are_medians_over_all_starts():
    """Reached first after 2, 3 and 4 acquisitions, and never: the middle is 3.5. Of 2 and never it is none."""
    curves = ((0.2, 0.8, 0.5, 0.5), (0.2, 0.5, 0.7, 0.7), (0.2, 0.3, 0.4, 0.9), (0.2, 0.3, 0.4, 0.5))
    comparison = Comparison(made_record("C", "pb", k, curve, "fnnn") for k, curve in enumerate(curves))
    found = needed(comparison, "C", "pb", 0.7)
    assert found is not None
    assert (found.median, found.reached, found.starts) == (3.5, 3, 4)
    assert needed_words(found) == "3.5 (3 of 4)"
    half = needed(comparison.of_starts({0, 3}), "C", "pb", 0.7)
    assert half is not None
    assert (half.median, half.reached, half.starts) == (None, 1, 2)
    assert needed_words(half) == "\u2013 (1 of 2)"
    assert needed(comparison, "C", "pb", None) is None
    assert needed(comparison, "C", "fra", 0.7) is None


def test_times_are_those_of_an_acquisition_and_their_ratios_geometric():
    """Planning 0.2 and 0.8 s beside 0.1 and 0.1 s: twice and eight times, four times in the geometric mean.

    Every run took 50 s of the processor, over 3 and over 5 acquisitions.
    """
    long = {"coverage": (0.1, 0.2, 0.3, 0.4, 0.5), "kinds": "fnnnn"}
    records = [made_record(arm="fra", run=k, planning_s=0.1) for k in (0, 1)]
    records += [made_record(arm="fra-robust", run=k, planning_s=s, **long) for k, s in ((0, 0.2), (1, 0.8))]
    comparison = Comparison(records)
    planning = seconds_ratio(comparison, "D", "fra-robust", "fra", "planning")
    assert planning is not None
    assert (planning.low, planning.mean, planning.high) == pytest.approx((2.0, 4.0, 8.0))
    each = mean_seconds_each(comparison, "D", "fra-robust", "processor")
    assert each is not None
    assert each.mean == pytest.approx(10.0)
    whole = seconds_ratio(comparison, "D", "fra-robust", "fra", "processor")
    assert whole is not None
    assert whole.mean == pytest.approx(3 / 5)
    assert seconds_ratio(comparison, "D", "pb", "fra", "planning") is None


def test_every_planner_is_held_to_fra_and_to_pb_once():
    """No difference stands there the other way round again."""
    assert compared_arms(("fra", "pb")) == [("pb", "fra")]
    assert compared_arms(PLANNERS) == [("pb", "fra"), ("fra-robust", "fra"), ("fra-robust", "pb")]


def test_a_study_is_compared_so_where_that_says_something():
    """Not the paper's three with sixteen views; but any two of 30, and another planner as far as all have got."""
    ordinary = Comparison(rising(arm, 0, 0.9, 16) for arm in ("fra", "pb", "re"))
    assert not is_compared_so(ordinary, ["C"], ("fra", "pb", "re"))
    assert not is_compared_so(Comparison([]), ["C"], PLANNERS)
    assert is_compared_so(three_planners(), ["C"], ("fra", "pb"))
    one_ended = [rising("pb", k, 0.5, 12 if k == 0 else 30) for k in range(3)]
    assert is_compared_so(Comparison([*one_ended, rising("fra", 0, 0.5, 31)]), ["C"], ("fra", "pb"))
    short = Comparison([rising("fra", 0, 0.5, 26), rising("fra-robust", 0, 0.5, 20)])
    assert is_compared_so(short, ["C"], ("fra", "fra-robust"))
    assert reached_levels(short, ["C"], ("fra", "fra-robust")) == (5, 10, 15, 20)


def test_json_has_the_figures_at_equal_acquisitions():
    """Means, paired differences, acquisitions until the paper's 84.7 % on C, ratios; null for an ordinary study."""
    summary = json_summary(three_planners(), ["C"], PLANNERS, 0, 1.0)
    json.dumps(summary, allow_nan=False)
    found = summary["equal_acquisitions"]
    assert found["after"] == [5, 10, 15, 20, 30]
    robust, fra = (found["parts"]["C"][arm] for arm in ("fra-robust", "fra"))
    assert [cell["after"] for cell in robust["coverage"]] == [5, 10, 15, 20, 30]
    assert robust["coverage"][0]["mean"] == pytest.approx((0.45 + 0.4) / 2)
    assert robust["coverage"][0]["ci95"] == pytest.approx([0.4, 0.45])
    assert robust["less_fra"]["coverage"][-1]["mean"] == pytest.approx((0.4 + 0.2) / 2)
    assert robust["less_fra"]["coverage"][-1]["ci95"] == pytest.approx([0.2, 0.4])
    assert robust["less_pb"]["wrongly_free_share"]["mean"] == pytest.approx(0.0)
    assert {"f_score", "accuracy_mm", "planning_ratio", "processor_ratio"} <= robust["less_pb"].keys()
    assert robust["until_paper_fra"] == {"share": pytest.approx(0.8474), "median": None, "reached": 1, "starts": 2}
    assert robust["until_fra_end"]["share"] == pytest.approx(0.55)  # median of 50 and 60 %
    assert robust["until_fra_end"]["median"] == 7  # 63 and 56 % after seven, 54 and 48 % after six
    assert (fra["until_paper_fra"]["reached"], fra["acquisitions"]) == (0, 34)
    assert "less_fra" not in fra
    ordinary = json_summary(Comparison([made_record()]), ["D"], ("fra", "pb", "re"), 0, 1.0)
    assert (ordinary["equal_acquisitions"], ordinary["robust_ablation"]) == (None, None)


def test_runs_that_had_ended_are_counted():
    """Of two runs of PB one ends after twelve acquisitions."""
    records = [rising("pb", 0, 0.5, 12), rising("pb", 1, 0.5, 30), rising("fra-robust", 0, 0.9, 30)]
    found = json_summary(Comparison(records), ["C"], ("pb", "fra-robust"), 0, 1.0)["equal_acquisitions"]
    assert [cell["ended"] for cell in found["parts"]["C"]["pb"]["coverage"]] == [0, 0, 1, 1, 1]


def test_words_say_what_the_numbers_say():
    """Means after thirty, differences with their range, and who reaches the paper's coverage."""
    (words,) = equal_words(three_planners(), ["C", "D"], PLANNERS)
    assert words.startswith("C, after 30 acquisitions: FRA 55.0 %, PB 50.0 %, fra-robust 85.0 %.")
    assert "fra-robust less FRA +30.0 points (+20.0 to +40.0)" in words
    assert "fra-robust less PB +35.0 points (+30.0 to +40.0)" in words
    assert "84.74 %, is first reached by FRA from none of 2 starts" in words
    assert "by fra-robust from 1 of 2 starts" in words
    assert equal_words(Comparison([made_record()]), ["D"], ("fra", "pb", "re")) == []


@pytest.mark.parametrize(
    ("planners", "pairs"),
    [
        (("fra", "pb"), 1),
        (PLANNERS, 3),
        (("fra", "pb", "re"), 3),
        (("pb", "fra-robust"), 1),
        (("fra-robust",), 0),
        (("random", "fra"), 1),
    ],
)
def test_the_page_renders_for_any_planners(planners: tuple[str, ...], pairs: int):
    """Each list from two starts of thirty views: the section is there, has a row for each, and every name is known."""
    preset = ComparisonPreset(title="Equal", runs=2, planners=planners, speed=False)
    records = [rising(arm, run, 0.8, 30, part) for part in "ABCD" for arm in planners for run in range(2)]
    comparison = Comparison(records)
    html = comparison_html(preset, comparison, len(records), [], None)
    section = html[html.index('id="equal"') : html.index('id="figures"')]
    assert section.count("<td>fra-robust</td>") == (8 if "fra-robust" in planners else 0)  # two tables, four parts
    assert len(re.findall(r"(?:less|beside) (?:FRA|PB)</td>", section)) == 8 * pairs  # two tables, four parts
    assert section.count('class="arm ') == 4 * len(planners)
    json.dumps(json_summary(comparison, list("ABCD"), planners, 0, 1.0), allow_nan=False)
    assert "n/a" not in paragraph(comparison, len(records), 0, planners)


def test_an_ordinary_page_has_no_such_section():
    """The paper's three planners, sixteen views each."""
    preset = ComparisonPreset.named("quick")
    records = [rising(arm, run, 0.8, 16, part) for part in "ABCD" for arm in preset.planners for run in range(2)]
    html = comparison_html(preset, Comparison(records), len(records), [], None)
    assert "equal acquisitions" in html  # FRA less the others has them all the same
    assert 'id="equal"' not in html
    assert 'id="robust"' not in html


def test_goals_are_about_the_planners_that_there_are():
    """Without RE neither the order of the three nor its own level is a goal; without FRA only PB's level is left."""
    names = {judged.goal.name for judged in judge(Comparison([]), ("fra", "pb"))}
    assert names == {
        *(f"fra_less_pb_{part}" for part in "abcd"),
        *(f"activations_{part}" for part in "abcd"),
        "pb_d",
        "activations_rise",
    }
    assert [judged.goal.name for judged in judge(Comparison([]), ("pb", "fra-robust"))] == ["pb_d"]
    assert "goal" not in paragraph(three_planners(), 6, 0, ("fra-robust",))
