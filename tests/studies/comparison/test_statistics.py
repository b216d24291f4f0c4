"""What a comparison says of its runs, against figures worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from studies.comparison.paper_results import points
from studies.comparison.report.increments_figure import axis_ends
from studies.comparison.report.planner_curves_figure import coinciding, held
from studies.comparison.report.sentences import link_words
from studies.comparison.report.tables import arm_rows, loss_rows
from studies.comparison.statistics import Comparison
from studies.comparison.view_increments import binned_increments, recovery_advantage
from studies.drawing.cells import mean_and_range, signed
from studies.statistics.medians import first_less_second
from tests.studies.comparison.comparison_records import made_record

EXPOSURE_S = 0.5
"""15 frames at 30 Hz."""


def test_iterations_take_their_recoveries_in():
    """first r r n n r: the given view ends with the third, the two iterations with the fourth and the sixth.

    The first view is no iteration; what it makes recover is paid in the first one, here three views, then two.
    """
    record = made_record(coverage=(0.1, 0.2, 0.3, 0.4, 0.5, 0.6), kinds="frrnnr")
    np.testing.assert_array_equal(record.by_iteration(record.coverage), [0.3, 0.4, 0.6])
    times = record.iteration_times()
    np.testing.assert_allclose(times["planning"], [0.3, 0.2])
    np.testing.assert_allclose(times["motion"], [3.0, 2.0])
    np.testing.assert_allclose(times["exposure"], [3 * EXPOSURE_S, 2 * EXPOSURE_S])


def test_runs_are_compared_at_their_ends_or_where_both_have_got():
    """FRA ends at 0.9 after 2 iterations and 4 views, PB at 0.8 after 3 iterations and 4 views... by hand."""
    fra = made_record(arm="fra", coverage=(0.3, 0.5, 0.7, 0.9), kinds="frnn", raw=(0.4, 0.6, 0.75, 0.95))
    pb = made_record(arm="pb", coverage=(0.3, 0.4, 0.6, 0.7, 0.8), kinds="fnnnn", raw=(0.4, 0.5, 0.7, 0.85, 0.9))
    comparison = Comparison([fra, pb])

    def mean(*where) -> float:
        found = comparison.difference("D", "fra", "pb", *where)
        assert found is not None
        return found.interval.mean

    assert mean() == pytest.approx(0.9 - 0.8)
    assert mean("iterations") == pytest.approx(0.9 - 0.6)  # both made two; PB's third view ends its second
    assert mean("acquisitions") == pytest.approx(0.9 - 0.7)  # both took four
    assert mean("acquisitions", "raw") == pytest.approx(0.95 - 0.85)
    assert mean("end", "raw") == pytest.approx(0.95 - 0.9)


def test_only_equal_starts_are_paired():
    """Runs 0 and 2 have partners; run 1 of FRA and run 3 of PB have none and do not count."""
    records = [made_record(arm="fra", run=k, coverage=(0.1, 0.5 + k / 10), kinds="fn") for k in (0, 1, 2)]
    records += [made_record(arm="pb", run=k, coverage=(0.1, 0.4), kinds="fn") for k in (0, 2, 3)]
    found = Comparison(records).difference("D", "fra", "pb")
    assert found is not None
    assert found.interval.count == 2
    assert found.interval.mean == pytest.approx((0.1 + 0.3) / 2)
    assert Comparison(records).difference("A", "fra", "pb") is None


def test_time_is_that_of_the_average_iteration_of_a_run():
    """Views of 1.6 s; runs of 3, 5 and 4 views after the first in two iterations: 2.4, 4.0, 3.2 s, median 3.2 s.

    A recovery of four views in one of sixteen iterations moves the average by a quarter and the pooled median not.
    """
    kinds = ("fnnr", "frrnnr", "fnrrn")
    runs = [
        made_record(run=k, coverage=tuple(0.1 * v for v in range(1, len(word) + 1)), kinds=word)
        for k, word in enumerate(kinds)
    ]
    time = Comparison(runs).iteration_time("D", "fra")
    assert time is not None
    assert (time.lower, time.median, time.upper) == pytest.approx((2.8, 3.2, 3.6))
    assert time.count == 3
    word = "f" + 15 * "n" + "nrrrr"
    rare = Comparison([made_record(coverage=tuple(0.04 * v for v in range(1, 22)), kinds=word)])
    average, single = rare.iteration_time("D", "fra"), rare.single_iteration_time("D", "fra")
    assert average is not None
    assert single is not None
    assert (average.median, single.median) == pytest.approx((20 / 16 * 1.6, 1.6))
    assert (average.count, single.count) == (1, 16)
    assert Comparison([made_record(coverage=(0.1,), kinds="f")]).iteration_time("D", "fra") is None


def test_overhead_is_added_for_every_view():
    """Iterations of 2 and 1 views of 1.6 s, 2.4 s on average; 10 s more a view makes 23.2 and 11.6 s, 17.4 s."""
    comparison = Comparison([made_record(coverage=(0.1, 0.2, 0.3, 0.4), kinds="frnn")])
    plain, loaded = (comparison.iteration_time("D", "fra", overhead_s=s) for s in (0.0, 10.0))
    assert plain is not None
    assert loaded is not None
    assert (plain.median, loaded.median) == pytest.approx((2.4, 17.4))


def test_increments_by_prior_coverage():
    """Views 2 and 3 of PB start from 0.3 and 0.5; the first view is none of PB's choice."""
    comparison = Comparison([made_record(arm="pb", coverage=(0.3, 0.5, 0.6))])
    bins = binned_increments(comparison, "D", "pb", "nbv")
    assert [len(values) for values in bins] == [0, 0, 0, 1, 0, 1, 0, 0, 0, 0]
    assert bins[3] == pytest.approx([0.2])
    assert bins[5] == pytest.approx([0.1])


def test_recovery_advantage_compares_like_with_like():
    """Five PB views add 0.05 and five recovery views 0.08 from 0.45; PB's larger steps from 0.1 do not count."""
    records = [
        made_record(arm="pb", run=k, coverage=(0.1, 0.45, 0.5), kinds="fnn") for k in range(5)
    ] + [made_record(arm="fra", run=k, coverage=(0.45, 0.53), kinds="fr") for k in range(5)]  # fmt: skip
    found = recovery_advantage(Comparison(records), "D")
    assert found is not None
    assert (found.gain.mean, found.gain.low, found.gain.high) == pytest.approx((0.03, 0.03, 0.03))
    assert (found.pb, found.gain.count) == (pytest.approx(0.05), 5)
    assert recovery_advantage(Comparison(records[:-1]), "D") is None


def test_recovery_advantage_scatters_as_the_runs_do():
    """Views of a run hang together: nine views of one of eight runs come and go as one.

    Seven runs with one recovery view of +0.05, one with nine of -0.01 and PB's views at +0.04: the mean over views is
    below zero, and samples without that run lie at +0.01, so that the interval holds zero.
    """
    pb = [made_record(arm="pb", run=k, coverage=(0.42, 0.46), kinds="fn") for k in range(8)]
    fra = [made_record(arm="fra", run=k, coverage=(0.42, 0.47), kinds="fr") for k in range(7)]
    fra.append(made_record(arm="fra", run=7, coverage=tuple(0.499 - 0.01 * k for k in range(10)), kinds="f" + 9 * "r"))
    found = recovery_advantage(Comparison(pb + fra), "D")
    assert found is not None
    assert found.gain.mean == pytest.approx((7 * 0.01 - 9 * 0.05) / 16)
    assert found.gain.high == pytest.approx(0.01)
    assert found.gain.low < found.gain.mean


def test_axis_of_the_boxes_holds_what_is_drawn():
    """Five views of 24 points need an axis of 30; four of 90 are too few to be drawn; nothing drawn leaves 10.

    A view of 90 points beside seven of 5 lies beyond the whisker, is not drawn, and must not squeeze the boxes. Views
    that take 12 points away need an axis from -20; the paper's medians of 20.7 and -1.6 on B one from -10 to 30.
    """
    records = [made_record("C", "pb", k, (0.3, 0.54), "fn") for k in range(5)]
    records += [made_record("C", "fra", k, (0.05, 0.95), "fr") for k in range(4)]
    assert axis_ends(Comparison(records), ["C"]) == (0.0, 30.0)
    assert axis_ends(Comparison(records[5:]), ["C"]) == (0.0, 10.0)
    outlier = [made_record("C", "pb", k, (0.05, 0.1), "fn") for k in range(7)]
    outlier.append(made_record("C", "pb", 7, (0.05, 0.95), "fn"))
    assert axis_ends(Comparison(outlier), ["C"]) == (0.0, 10.0)
    falling = [made_record("C", "pb", k, (0.42, 0.3), "fn") for k in range(5)]
    assert axis_ends(Comparison(falling), ["C"]) == (-20.0, 10.0)
    assert axis_ends(Comparison([]), ["B"]) == (-10.0, 30.0)


def test_a_single_run_has_no_interval():
    """Said in words instead of brackets that look like certainty."""
    records = [made_record(arm=arm, coverage=(0.3, end), kinds="fn") for arm, end in (("fra", 0.9), ("pb", 0.8))]
    assert points(Comparison(records).difference("D", "fra", "pb")) == "+10.0 points (one run)"
    assert mean_and_range(Comparison(records).figure("D", "fra", "coverage_5mm"), 100, ".1f") == "90.0"


def test_cells_have_their_interval_below_and_real_minus_signs():
    """Differences of -10 and +10 points: the mean is 0 without a sign of its own, the range of two runs their ends."""
    records = [made_record(arm="fra", run=k, coverage=(0.1, end), kinds="fn") for k, end in ((0, 0.4), (1, 0.6))]
    records += [made_record(arm="pb", run=k, coverage=(0.1, 0.5), kinds="fn") for k in (0, 1)]
    assert signed(Comparison(records).difference("D", "fra", "pb")) == "+0.0<small>\u221210.0 to +10.0</small>"
    assert signed(None) == "n/a"


def test_what_recovery_brought_is_told_view_by_view_and_may_be_negative():
    """Recovery views of +0.1, -0.05 and +0.02 on the map, 0.07 in all, whatever the raw cloud gained; last -0.2."""
    gaining = made_record(coverage=(0.3, 0.4, 0.35, 0.5, 0.52), kinds="frrnr", raw=(0.4, 0.6, 0.7, 0.8, 0.9))
    before, brought = gaining.increments("recovery")
    assert before == pytest.approx([0.3, 0.4, 0.5])
    assert brought == pytest.approx([0.1, -0.05, 0.02]), "those of the map"
    losing = made_record(run=1, coverage=(0.5, 0.3, 0.4), kinds="frn")
    found = Comparison([gaining, losing]).median("D", "fra", "recovery_contribution")
    assert found is not None
    assert found.value == pytest.approx((0.07 - 0.2) / 2)


def test_figures_of_medians_are_of_the_starts_that_all_have():
    """FRA's start 2 has no partner; over starts 0 and 1 the medians are 0.7 and 0.45."""
    records = [made_record("D", "fra", k, (0.1, end), "fn") for k, end in enumerate((0.6, 0.8, 0.1))]
    records += [made_record("D", "pb", k, (0.1, end), "fn") for k, end in enumerate((0.4, 0.5))]
    found = Comparison(records).of_medians("D", ("fra", "pb"), first_less_second)
    assert found is not None
    assert (found.value, found.count) == (pytest.approx(0.25), 2)
    assert Comparison(records).of_medians("D", ("fra", "re"), first_less_second) is None


def test_only_fra_has_recoveries_to_count():
    """Of the others it is no result that they have none."""
    rows = arm_rows(Comparison([made_record(arm="fra"), made_record(arm="pb")]), ["D"], ["fra", "pb"])
    assert [(row["activations"], row["contribution"]) for row in rows] == [("0.0", "0.0"), ("\u2013", "\u2013")]


def test_largest_gamma_is_that_of_any_run():
    """Counts are averaged, the maximum is not."""
    records = [made_record(run=k) for k in (0, 1)]
    records[1] = replace(records[1], losses={**records[1].losses, "largest_gamma": 0.4, "regions": 4})
    (row,) = loss_rows(Comparison(records), ["D"])
    assert (row["largest_gamma"], row["regions"]) == (0.4, 3.0)


def test_a_run_that_has_ended_keeps_its_coverage():
    """Curves of two and four points."""
    curves = held([np.array([0.1, 0.2]), np.array([0.3, 0.4, 0.5, 0.6])], 5)
    np.testing.assert_array_equal(curves, [[0.1, 0.2, 0.2, 0.2, 0.2], [0.3, 0.4, 0.5, 0.6, 0.6]])


def test_runs_that_coincide_are_named():
    """On B every run of FRA is that of PB; on C the second run differs in its last view; on D there is no PB."""
    records = [made_record(part, arm, run) for part in "BC" for arm in ("fra", "pb") for run in (0, 1)]
    records[-1] = made_record("C", "pb", 1, (0.3, 0.5, 0.61))
    records.append(made_record("D", "fra"))
    assert coinciding(Comparison(records), ["B", "C", "D"]) == ["B"]


def test_words_about_links_say_what_bounds_the_lead():
    """PB at 0.8 of D leaves 20 points, fewer than the paper's lead; ablations that move nothing are said to."""
    records = [
        made_record(arm=arm, run=k, coverage=(0.3, end), kinds="fn")
        for k in range(4)
        for arm, end in (("fra", 0.9), ("pb", 0.8), ("unweighted", 0.9))
    ]
    ((part, sentences),) = link_words(Comparison(records), ["C", "D"], 0.3)
    assert part == "D"
    assert "by more than 20.0 points. The paper's lead of 31 points cannot be reached." in sentences[0]
    assert "calls 10.0 % of the surface's voxels free" in sentences[-2]
    assert "false depth" not in sentences[-2].lower()  # the runs do not tell the cause
    assert sentences[-1].startswith("1 change of the method")
    assert "none moved" in sentences[-1]
