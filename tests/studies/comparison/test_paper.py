"""The paper's figures as data: in themselves in order, and in agreement with what its text says of them."""

from itertools import pairwise

import pytest

from studies.comparison.paper import (
    ACTIVATIONS,
    CONTRIBUTION,
    CONTRIBUTION_OF_MATTE,
    CONTRIBUTION_OF_SHINY,
    FINAL_COVERAGE,
    INCREMENTS,
    READING_ERROR,
    paper_lead,
    paper_order,
)

BOXES = [
    *(box for arms in FINAL_COVERAGE.values() for box in arms.values()),
    *ACTIVATIONS.values(),
    *CONTRIBUTION.values(),
]


def test_boxes_lie_between_their_whiskers():
    """Whisker, quartile, median, quartile, whisker rise, as far as they are known and to the reading error."""
    for box in BOXES:
        known = [end for end in (box.low, box.lower, box.median, box.upper, box.high) if end is not None]
        assert all(a <= b + READING_ERROR for a, b in pairwise(known)), box


def test_leads_are_those_of_the_text():
    """ "Up to 31 %" and "approximately 56 %" on D; 9.4, 7.9, 16.8 and 31.5 points from the printed medians, by hand."""
    assert round(paper_lead("D", "pb"), 2) == 0.31
    assert round(paper_lead("D", "re"), 2) == 0.56
    leads = [100 * paper_lead(part, "pb") for part in "ABCD"]
    assert leads == pytest.approx([9.44, 7.87, 16.79, 31.46])


def test_order_is_fra_first_and_re_second_on_a_alone():
    """The ray caster beats PB on the plain block."""
    assert [paper_order(part) for part in "ABCD"] == [("fra", "re", "pb"), *[("fra", "pb", "re")] * 3]


def test_contributions_are_about_what_the_text_says():
    """The means over A and B, and over C and D, are "around 10 %" and "approximately 30 %" to a point."""
    medians = {part: box.median for part, box in CONTRIBUTION.items()}
    assert (medians["A"] + medians["B"]) / 2 == pytest.approx(CONTRIBUTION_OF_MATTE, abs=READING_ERROR)
    assert (medians["C"] + medians["D"]) / 2 == pytest.approx(CONTRIBUTION_OF_SHINY, abs=READING_ERROR)


def test_recovery_views_lead_on_d_at_every_level():
    """ "Statistically higher" there; on B they lie 0.1 to 1.9 points from PB's where both are known."""
    both = {part: [pair for pair in rows.values() if None not in pair] for part, rows in INCREMENTS.items()}
    assert len(both["D"]) == 5
    assert all(recovery > pb for pb, recovery in both["D"])
    assert all(abs(recovery - pb) < 0.02 for pb, recovery in both["B"])
