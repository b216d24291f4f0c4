"""Tables and sentences about what was changed: like is compared with like, and chance is told."""

import pytest

from studies.comparison.links import LINKS, arm_name
from studies.comparison.report.change_tables import changed_link_rows, variant_rows
from studies.comparison.report.links_figure import links_figure, moved_leads
from studies.comparison.report.sentences import link_words
from studies.comparison.statistics import Comparison
from tests.studies.comparison.comparison_records import made_record


def ends(arm: str, coverages: dict[int, float]) -> list:
    """Runs of an arm on D by their starts, which end at these coverages."""
    return [made_record("D", arm, run, (0.1, coverage), "fn") for run, coverage in coverages.items()]


def test_changed_links_are_compared_over_their_own_starts():
    """Starts 0 and 3 were run without lamps. There FRA leads PB by 20 and 10 points unchanged, by 30 and 40 changed:
    15 and 35 points, 20 more. Start 1, where FRA leads by 80, was not, and must not count.
    """
    records = [
        *ends("fra", {0: 0.6, 1: 0.9, 3: 0.5}),
        *ends("pb", {0: 0.4, 1: 0.1, 3: 0.4}),
        *ends(arm_name("fra", "lamps_off"), {0: 0.7, 3: 0.8}),
        *ends(arm_name("pb", "lamps_off"), {0: 0.4, 3: 0.4}),
    ]
    plain, changed = changed_link_rows(Comparison(records), ["C", "D"])
    assert (plain["words"], plain["pairs"], plain["fra"], plain["pb"]) == ("nothing changed", 2, "55.0", "40.0")
    assert (changed["pairs"], changed["fra"], changed["pb"]) == (2, "75.0", "40.0")
    assert plain["end"] == "+15.0<small>+10.0 to +20.0</small>"
    assert changed["end"] == "+35.0<small>+30.0 to +40.0</small>"
    assert changed["change"] == "+20.0<small>+10.0 to +30.0</small>"
    assert plain["change"] == ""


def test_best_variant_of_re_covers_most_from_the_same_starts():
    """Over start 0 alone RE covers 50 %, its variants 60 and 40 %; RE's 90 % of start 1 must not make it the best."""
    records = [
        *ends("fra", {0: 0.8, 1: 0.8}),
        *ends("re", {0: 0.5, 1: 0.9}),
        *ends("re_unobserved", {0: 0.6}),
        *ends("re_entropy", {0: 0.4}),
    ]
    rows = variant_rows(Comparison(records), ["D"])
    assert [(row["covers"], row["best"], row["end"]) for row in rows] == [
        ("50.0", False, "+30.0"),
        ("60.0", True, "+20.0"),
        ("40.0", False, "+40.0"),
    ]
    assert variant_rows(Comparison(records[:4]), ["D"]) == []


def test_changes_that_move_a_result_are_named_with_what_chance_would_do():
    """Five starts. Without lamps FRA's lead grows by 10 points in all of them, p = 2 / 32 as small as five runs can
    give; without weights its coverage changes sign from start to start. Four results at 1/16 each: 0.2 by chance.
    """
    starts = range(5)
    records = [
        *ends("fra", dict.fromkeys(starts, 0.6)),
        *ends("pb", dict.fromkeys(starts, 0.5)),
        *ends("unweighted", {run: 0.6 + 0.1 * (-1) ** run for run in starts}),
        *ends(arm_name("fra", "lamps_off"), {run: 0.7 + 0.01 * run for run in starts}),
        *ends(arm_name("pb", "lamps_off"), {run: 0.5 + 0.01 * run for run in starts}),
    ]
    ((part, sentences),) = link_words(Comparison(records), ["D"], 0.3)
    assert part == "D"
    told = next(k for k, sentence in enumerate(sentences) if sentence.startswith("2 changes"))
    assert "4 results compared: 1 moved with p at most 0.062; by chance alone up to 0.2 would." in sentences[told]
    assert sentences[told + 1 :] == ["no lamps: lead of FRA over PB +10.0 points (+10.0 to +10.0)"]


def test_the_chart_of_links_has_the_largest_change_first():
    """Unchanged FRA leads by 20 points in two starts; by 30 without lamps, by 0 with OpenCV's matcher: +10 and -20."""
    records = [*ends("fra", {0: 0.6, 1: 0.7}), *ends("pb", {0: 0.4, 1: 0.5})]
    for link, lead in (("lamps_off", 0.3), ("opencv_matcher", 0.0)):
        records += ends(arm_name("fra", link), {0: 0.4 + lead, 1: 0.5 + lead})
        records += ends(arm_name("pb", link), {0: 0.4, 1: 0.5})
    rows = moved_leads(Comparison(records), "D")
    assert [row.words for row in rows] == [LINKS["opencv_matcher"].words, LINKS["lamps_off"].words]
    assert [row.change.mean for row in rows] == pytest.approx([-0.2, 0.1])
    assert [row.lead.mean for row in rows] == pytest.approx([0.0, 0.3])
    figure = str(links_figure(Comparison(records), ["C", "D"], {"D": "Column"}))
    assert figure.count("<circle") == 2
    assert links_figure(Comparison(records[:4]), ["D"], {"D": "Column"}) == ""
