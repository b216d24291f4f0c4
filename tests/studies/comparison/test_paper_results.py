"""What of the paper is found again: its own numbers, the contrary, and what lies between, by hand."""

import pytest

from studies.comparison.paper import ACTIVATIONS, CONTRIBUTION, FINAL_COVERAGE, ITERATION_S, paper_ratio
from studies.comparison.paper_results import paper_findings
from studies.comparison.paper_verdicts import (
    DIRECTION,
    FOUND,
    NOT_FOUND,
    TOO_FEW,
    UNKNOWN,
    adjusted_p,
    lead_verdict,
    verdict_words,
    weakest,
)
from studies.comparison.preset import CORNER
from studies.comparison.report.tables import overhead_words
from studies.comparison.statistics import Comparison
from studies.comparison.summary import json_summary
from tests.studies.comparison.comparison_records import made_record

EXPOSURE_S = 0.5
"""15 frames at 30 Hz."""


def as_in_the_paper() -> Comparison:
    """Runs whose every median is the paper's: coverage, activations, contributions, times.

    FRA recovers from the first view on. PB's first view starts there too: on B it adds as much, on D half as much.
    """
    share_of_pb = {"A": 1.0, "B": 1.0, "C": 0.5, "D": 0.5}
    records = []
    for part, arms in FINAL_COVERAGE.items():
        before, brought = 0.15, CONTRIBUTION[part].median
        for arm, box in arms.items():
            median = ITERATION_S[part][arm][1]
            for run in range(15):
                end = box.median + 0.001 * (run - 7)
                if arm == "fra":
                    count = int(ACTIVATIONS[part].median)
                    record = made_record(part, arm, run, (before, before + brought, end), "frn", activations=count)
                    record.planning_s[:] = 0.5 * median - 1.0 - EXPOSURE_S
                else:
                    between = before + share_of_pb[part] * brought
                    record = made_record(part, arm, run, (before, between, end), "fnn")
                    record.planning_s[:] = median - 1.0 - EXPOSURE_S
                records.append(record)
    return Comparison(records)


def test_the_papers_own_numbers_are_found():
    """Every statement that the paper makes holds for runs that reach its numbers."""
    corner = [
        made_record(CORNER, arm, run, (0.3, end), "fn")
        for run in range(15)
        for arm, end in (("fra", 0.7), ("pb", 0.5), ("re", 0.4))
    ]
    comparison = Comparison([*as_in_the_paper().records, *corner])
    verdicts = {finding.words: finding.verdict for finding in paper_findings(comparison)}
    assert set(verdicts.values()) == {FOUND}, verdicts
    assert len(verdicts) == 14


def test_the_contrary_is_not_found():
    """Planners exchanged: PB leads where FRA should, and nothing recovers."""
    swap = {"fra": "pb", "pb": "fra", "re": "re"}
    records = [
        made_record(r.part, swap[r.arm], r.run, tuple(r.coverage), "fnn"[: len(r.coverage)])
        for r in as_in_the_paper().records
    ]
    by_words = {finding.words: finding.verdict for finding in paper_findings(Comparison(records))}
    assert by_words["On D FRA covers more than PB"] == NOT_FOUND
    assert by_words["On C FRA covers more than PB"] == NOT_FOUND
    assert by_words["Recovery views bring little of the coverage on A and B, more on C and D"] == NOT_FOUND
    assert by_words["On D a recovery view adds more than a PB view at the same coverage"] == UNKNOWN


def test_a_gap_below_the_papers_is_found_in_direction_only():
    """Ten points instead of 31, however sure; one run is never sure. All but one need other parts or RE."""
    records = [
        made_record(arm=arm, run=k, coverage=(0.3, end), kinds="fn")
        for k in range(6)
        for arm, end in (("fra", 0.9), ("pb", 0.8), ("re", 0.7))
    ]
    by_words = {finding.words: finding.verdict for finding in paper_findings(Comparison(records))}
    assert by_words["On D FRA covers more than PB"] == DIRECTION
    single = [made_record(arm=arm, coverage=(0.3, end), kinds="fn") for arm, end in (("fra", 0.9), ("pb", 0.5))]
    assert {f.words: f.verdict for f in paper_findings(Comparison(single))}["On D FRA covers more than PB"] == TOO_FEW
    words = verdict_words(f.verdict for f in paper_findings(Comparison(single)))
    assert words == "Of 13 statements of the paper: 1 too few runs, 12 cannot be said."


@pytest.mark.parametrize(
    ("lead", "runs", "more_than", "verdict"),
    [
        (0.32, 15, 0.31, FOUND),
        (0.30, 15, 0.31, DIRECTION),
        (-0.01, 15, 0.0, NOT_FOUND),
        (0.32, 5, 0.31, TOO_FEW),
    ],
)
def test_a_lead_must_be_large_and_sure(lead: float, runs: int, more_than: float, verdict: str):
    """Equal leads of n runs have p = 2 / 2^n: 6e-5 of 15; of five 0.06, above 0.05 even if it is the only test."""
    records = [
        made_record(arm=arm, run=k, coverage=(0.3, end), kinds="fn")
        for k in range(runs)
        for arm, end in (("fra", 0.5 + lead), ("pb", 0.5))
    ]
    comparison = Comparison(records)
    adjusted = adjusted_p(comparison)
    assert adjusted == {("D", "pb"): pytest.approx(2 / 2**runs)}
    found = comparison.difference("D", "fra", "pb")
    assert lead_verdict(found, adjusted["D", "pb"], len(adjusted), more_than) == verdict


def test_a_lead_that_scatters_is_no_finding():
    """Leads of +50 and -30 points in turn: 10 in the mean of 14 runs, a quarter of the scatter, t = 0.9, p near 0.4."""
    records = []
    for k in range(14):
        lead = 0.5 if k % 2 else -0.3
        records += [
            made_record(arm="fra", run=k, coverage=(0.3, 0.4 + lead), kinds="fn"),
            made_record(arm="pb", run=k, coverage=(0.3, 0.4), kinds="fn"),
        ]
    found = Comparison(records).difference("D", "fra", "pb")
    assert found is not None
    assert found.interval.mean == pytest.approx(0.1)
    assert lead_verdict(found, found.p, 1, 0.03) == DIRECTION


def test_a_statement_of_several_claims_is_as_good_as_the_weakest():
    """One that fails makes all of it fail; one that nobody knows leaves it open."""
    assert weakest([FOUND, FOUND]) == FOUND
    assert weakest([FOUND, DIRECTION, TOO_FEW]) == TOO_FEW
    assert weakest([FOUND, UNKNOWN, DIRECTION]) == UNKNOWN
    assert weakest([UNKNOWN, NOT_FOUND]) == NOT_FOUND


def test_ratios_of_the_papers_table():
    """Means of 23.09 / 20.45, 25.28 / 21.72, 31.87 / 21.62, 33.10 / 16.51; and of RE's, by hand."""
    assert paper_ratio("fra", "pb") == pytest.approx((1.1291 + 1.1639 + 1.4741 + 2.0048) / 4, abs=1e-4)
    assert paper_ratio("re", "pb") == pytest.approx((2.3218 + 2.3831 + 2.1628 + 2.8262) / 4, abs=1e-4)


def test_a_ratio_of_one_never_agrees_with_more():
    """The paper's FRA takes 1.44 times as long as PB; 1.11 times is a quarter of that excess, in direction only."""
    records = [
        made_record(part, arm, planning_s=planning)
        for part in "ABCD"
        for arm, planning in (("fra", 0.72), ("pb", 0.5), ("re", 0.5))
    ]
    by_words = {finding.words: finding for finding in paper_findings(Comparison(records))}
    fra, re = (by_words[f"Time of an {arm} iteration over that of a PB iteration"] for arm in ("FRA", "RE"))
    assert (fra.ours, fra.verdict) == ("1.11", DIRECTION)
    assert (re.ours, re.verdict) == ("1.00", NOT_FOUND)


def test_json_has_the_agreed_keys():
    """Names as the command promises them; a mean with its interval, null where there is no run."""
    summary = json_summary(as_in_the_paper(), ["A", "B", "C", "D"], ("fra", "pb", "re"), 2, 9.0)
    assert {"runs", "failed", "wall_s", "time_ratio_re_pb", "time_ratio_fra_pb", "parts"} <= summary.keys()
    assert (summary["runs"], summary["failed"], summary["wall_s"]) == (180, 2, 9.0)
    cell = summary["parts"]["D"]["fra"]
    assert {"coverage_5mm", "coverage_ci95", "accuracy_mm", "f_score", "filtered_coverage_5mm"} <= cell.keys()
    assert {"acquisitions", "activations", "recovery_contribution"} <= cell.keys()
    assert cell["coverage_map_5mm"] == pytest.approx(0.7685)
    assert cell["coverage_map_ci95"][0] < 0.7685 < cell["coverage_map_ci95"][1]
    assert cell["coverage_5mm"] == pytest.approx(0.7685)
    assert cell["coverage_ci95"][0] < 0.7685 < cell["coverage_ci95"][1]
    assert cell["activations"] == 7
    assert cell["recovery_contribution"] == pytest.approx(0.3456)
    empty = json_summary(Comparison([]), ["A"], ("fra",), 0, 1.0)
    assert empty["parts"]["A"]["fra"]["coverage_5mm"] is None
    assert empty["parts"]["A"]["fra"]["coverage_map_ci95"] is None
    assert empty["time_ratio_re_pb"] is None


def test_words_about_time_carry_the_papers_ratios():
    """With its own times our ratios with overhead are the paper's, because nothing is missing."""
    words = overhead_words(as_in_the_paper())
    assert f"paper: {paper_ratio('fra', 'pb'):.2f} and {paper_ratio('re', 'pb'):.2f}" in words
    assert f"RE {paper_ratio('re', 'pb'):.2f} times" in words
