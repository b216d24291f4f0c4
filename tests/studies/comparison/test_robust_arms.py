"""The presets about fra-robust, the parts of its ablation, and the table of its changes."""

from pathlib import Path

import pytest

from scenes.parts import EXTRA_PARTS
from studies.base.config import load_config
from studies.comparison.cases import planned_runs
from studies.comparison.preset import CORNER, ComparisonPreset
from studies.comparison.report.page import comparison_html
from studies.comparison.robust_arms import robust_ablations, robust_tables
from studies.comparison.statistics import Comparison
from studies.comparison.summary import json_summary
from studies.run.ablation import ABLATIONS
from studies.run.batch import check_runs
from tests.studies.comparison.comparison_records import made_record

ARMS = ("pb_robust_map", "fra_robust_map")


def test_the_robust_preset_takes_over_a_study_of_fewer_planners(tmp_path: Path):
    """180 runs of thirty views on A to D; those of FRA and PB go by the names that a file without the third gives."""
    runs = planned_runs(ComparisonPreset.named("robust"))
    assert (len(runs), {run.part for run in runs}) == (180, set("ABCD"))
    assert {run.config.parameters.max_iterations for run in runs} == {29}
    assert all(run.config.parameters.stagnation_iterations > 29 for run in runs)
    path = tmp_path / "two.yaml"
    path.write_text("title: Two\nplanners: [fra, pb]\nparameters: {max_iterations: 29, stagnation_iterations: 30}\n")
    two = {run.digest for run in planned_runs(load_config(ComparisonPreset, path))}
    assert two == {run.digest for run in runs if run.arm != "fra-robust"}


def test_the_ablation_preset_has_every_arm_on_every_part_from_the_same_starts():
    """Three starts and twenty views (recoveries apart) of planners and ablations, on concave and convex things too."""
    preset = ComparisonPreset.named("robust_ablation")
    runs = planned_runs(preset)
    check_runs(runs)
    assert set("ABCD") | {CORNER, "ball"} | set(EXTRA_PARTS) <= {run.part for run in runs}
    starts: dict[tuple[str, str], set[int]] = {}
    for run in runs:
        starts.setdefault((run.part, run.arm), set()).add(run.run)
    arms = {"fra", "pb", "re", "fra-robust", *preset.ablations}
    assert starts == {(part, arm): {0, 5, 10} for part in preset.ablated_parts for arm in arms}
    assert {run.config.parameters.max_iterations for run in runs} == {19}
    assert len({run.digest for run in runs}) == len(runs)


def test_parts_of_ablations_alone_are_run_from_their_starts():
    """The planners make the starts of the ablations there, and only where there are ablations; coupons have a metal."""
    preset = ComparisonPreset(
        title="One", parts=("A",), ablated_parts=("A", "E1", "ball"), ablations=ARMS, ablation_runs=2, speed=False
    )
    runs = planned_runs(preset)
    assert sum(run.arm == "fra" and run.part == "A" for run in runs) == 15
    assert sorted(run.run for run in runs if run.arm == "fra" and run.part == "E1") == [0, 7]
    assert {run.config.material for run in runs if run.part == "ball"} == {("stainless_austenitic:bright",)}
    assert {run.config.material for run in runs if run.part == "E1"} == {()}
    alone = planned_runs(preset.model_copy(update={"ablations": ()}))
    assert {run.part for run in alone} == {"A"}
    corner = preset.model_copy(update={"corner": "nickel:bright", "ablated_parts": (CORNER,)})
    assert {run.config.material for run in planned_runs(corner) if run.part == CORNER} == {("nickel:bright",)}


@pytest.mark.parametrize(("part", "says"), [("E5", "known: A, B, C, D, A1"), ("bal", "did you mean ball?")])
def test_an_unknown_part_is_named(part: str, says: str):
    """With what it may have been meant to be, or all that there are."""
    with pytest.raises(ValueError, match=f"there is no {part}; {says}"):
        ComparisonPreset(title="One", ablated_parts=(part,))


def even(part: str, arm: str, run: int, end: float):
    """Twenty acquisitions that rise evenly: half of the end after ten."""
    return made_record(part, arm, run, tuple(end * k / 20 for k in range(1, 21)), "f" + 19 * "n")


def two_parts() -> Comparison:
    """Starts 0 and 5 of the arms, start 1 of the planners alone; on C and, without fra-robust, on E1."""
    ends = {"fra": (0.4, 0.6), "pb": (0.4, 0.4), "fra_robust_map": (0.8, 0.8), "fra-robust": (1.0, 1.0)}
    records = [
        even(part, arm, run, end)
        for part in ("C", "E1")
        for arm, found in ends.items()
        for run, end in zip((0, 5), found, strict=True)
        if (part, arm) != ("E1", "fra-robust")
    ]
    return Comparison([*records, even("C", "fra", 1, 0.9), even("C", "fra-robust", 1, 0.9)])


def test_arms_are_compared_over_the_starts_of_the_ablations():
    """FRA's start 1 does not count: half of 40 and 60 % after ten is 25 %, and the map alone adds 20 and 10 points."""
    tables = robust_tables(two_parts())
    assert list(tables) == ["C", "E1"]
    table = tables["C"]
    assert list(table.arms) == ["fra", "pb", "fra_robust_map", "fra-robust"]
    assert list(table.levels) == [10, 20]
    fra, lead = table.covers("fra", 10), table.less_fra("fra_robust_map", 10)
    assert fra is not None
    assert lead is not None
    assert (fra.mean, fra.count) == (pytest.approx(0.25), 2)
    i = lead.interval
    assert (i.mean, i.low, i.high) == pytest.approx((0.15, 0.1, 0.2))
    assert table.less_fra("fra", 10) is None
    free = table.wrongly_free("pb")
    assert free is not None
    assert free.mean == pytest.approx(0.1)
    assert "fra-robust" not in tables["E1"].arms
    assert robust_tables(Comparison([made_record(), made_record(arm="poses_8")])) == {}


def test_ablations_of_the_method_itself_are_none_of_fra_robusts():
    """The named ones are; what changes FRA's detection or RE's rays is not."""
    assert {*ARMS, "pb_robust_views", "fra_robust_both"} <= set(robust_ablations())
    assert not {"poses_8", "no_erosion", "re_entropy"} & set(robust_ablations())


def test_page_and_json_have_a_row_per_arm_and_a_column_per_part():
    """Parts of the ablation alone stand in this table and in no other; what was not run has a dash."""
    preset = ComparisonPreset(
        title="One", runs=3, parts=("C",), ablated_parts=("C", "E1"), planners=("fra", "pb", "fra-robust"),
        ablations=("fra_robust_map",), speed=False,
    )  # fmt: skip
    html = comparison_html(preset, two_parts(), 16, [], None)
    section = html[html.index('id="robust"') : html.index('id="ablations"')]
    assert '<th class="n">C</th><th class="n">E1</th>' in section
    rows = section[section.index(f"<td>{ABLATIONS['fra_robust_map'].words}</td>") :].split("</tr>")
    assert "40.0<small>+15.0<small>+10.0 to +20.0</small></small>" in rows[0]
    assert "80.0<small>+30.0<small>+20.0 to +40.0</small></small>" in rows[1]
    assert rows[2].count('<td class="n">10.0</td>') == 2
    whole = section[section.index("<td>fra-robust</td>") :].split("</tr>")[0]
    assert '<td class="n">\u2013</td>' in whole
    before = html[: html.index('id="robust"')]
    assert "<td>E1</td>" not in before
    found = json_summary(two_parts(), ["C", "E1"], preset.planners, 0, 1.0)["robust_ablation"]
    arm = found["C"]["fra_robust_map"]
    assert (arm["runs"], [cell["after"] for cell in arm["coverage"]]) == (2, [10, 20])
    assert arm["less_fra"][1]["ci95"] == pytest.approx([0.2, 0.4])
    assert arm["wrongly_free_share"]["mean"] == pytest.approx(0.1)
