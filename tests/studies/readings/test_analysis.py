"""From runs to a reading: planted figures of every cell come back as medians, distances, effects and candidates."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from franbv.parameters import Parameters
from studies.comparison.cases import planned_runs
from studies.comparison.preset import ComparisonPreset
from studies.comparison.records import Record
from studies.comparison.statistics import Comparison
from studies.readings import evaluation
from studies.readings.analysis import DISTANCE, Analysis, Response, analysed
from studies.readings.candidates import candidates_of
from studies.readings.decisions import DECISIONS, decided
from studies.readings.design import design_cells
from studies.readings.distance import distance_of, distance_term
from studies.readings.preset import ReadingsPreset
from studies.readings.runs import reading_runs
from studies.work.workers import Failure
from tests.studies.comparison.comparison_records import made_record

MISS, LOCATED = "miss_probability", "located_on"
NOISE = 0.004
"""Of a start's coverage [-]."""


def planted(part: str, planner: str, second: frozenset[str]) -> tuple[float, int]:
    """Coverage and recoveries of a made-up method: PB holds 0.2 more with weak misses, FRA 0.1; holes placed
    otherwise bring FRA 0.05 and four recoveries more."""
    coverage = {"C": 0.6, "D": 0.4}[part]
    if planner == "pb":
        return coverage + 0.2 * (MISS in second), 0
    return coverage + 0.1 * (MISS in second) + 0.05 * (LOCATED in second), 3 + 4 * (LOCATED in second)


def made_runs(starts: int = 3) -> list[Record]:
    """Of all cells; of the coverage the last third comes from a recovery."""
    rng = np.random.default_rng(0)
    runs = []
    for planned in reading_runs(ReadingsPreset(title="Made", starts=starts)):
        planner, number = planned.arm.split(", cell ")
        coverage, activations = planted(planned.part, planner, design_cells()[int(number)].second)
        end = coverage + rng.normal(0.0, NOISE)
        views = (end / 3, 2 * end / 3, end)
        kinds = "fnr" if planner == "fra" else "fnn"
        runs.append(made_record(planned.part, planned.arm, planned.run, views, kinds, activations=activations))
    return runs


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    """Three starts a cell on both parts."""
    return analysed(Comparison(made_runs()), ("C", "D"), 3)


def test_planted_differences_are_the_effects(analysis: Analysis):
    """Full differences between the levels, on both parts; the median of three of sd NOISE, sixteen of them over 8, has
    an error of NOISE * sqrt(16 * 0.449) / 8 = 0.33 NOISE, and five of those are allowed."""
    slack = 5 * 0.34 * NOISE
    for part in ("C", "D"):
        for figure, wanted in {
            "fra": {MISS: 0.1, LOCATED: 0.05},
            "pb": {MISS: 0.2},
            "lead": {MISS: -0.1, LOCATED: 0.05},
            "activations": {LOCATED: 4.0},
            "contribution": {MISS: 0.1 / 3, LOCATED: 0.05 / 3},
        }.items():
            effects = analysis.effects[Response(part, figure)]
            for decision in DECISIONS:
                # The lead has the noise of two methods.
                assert effects[decision.name].value == pytest.approx(wanted.get(decision.name, 0.0), abs=1.5 * slack)
            assert all(effects[name].is_sure for name in wanted)


def test_cells_hold_medians_and_their_distance(analysis: Analysis):
    """Cell 0 counted from its runs; each figure less the paper's (its figures written out), over what is allowed."""
    runs = {(r.part, r.arm, r.run): r for r in made_runs()}
    terms = []
    theirs = {"C": (84.74, 67.95, 6, 24.77), "D": (76.85, 45.39, 7, 34.56)}
    found = analysis.figures(0)
    for part, (fra, pb, activations, brought) in theirs.items():
        ends = [
            sorted(runs[part, f"{arm}, cell 0", start].coverage[-1] for start in range(3))[1] for arm in ("fra", "pb")
        ]
        assert [found[Response(part, arm)] for arm in ("fra", "pb")] == pytest.approx(ends)
        assert found[Response(part, "lead")] == pytest.approx(ends[0] - ends[1])
        terms += [
            (100 * ends[0] - fra) / 10,
            (100 * ends[1] - pb) / 10,
            (100 * (ends[0] - ends[1]) - (fra - pb)) / 8,
            (3 - activations) / 2,
            (100 * ends[0] / 3 - brought) / 10,
        ]
    assert found[DISTANCE] == pytest.approx(math.sqrt(sum(t * t for t in terms) / 10))


def test_distance_is_one_where_all_is_as_far_off_as_allowed():
    """Ten points, two recoveries, eight points of lead: each term is one, of either sign."""
    assert distance_term("fra", "D", 0.8685) == pytest.approx(1.0)
    assert distance_term("lead", "D", 0.3146 - 0.08) == pytest.approx(-1.0)
    assert distance_term("activations", "D", 9.0) == pytest.approx(1.0)
    assert distance_of([1.0, -1.0, 1.0]) == pytest.approx(1.0)
    assert math.isnan(distance_of([1.0, math.nan]))


def test_candidates_follow_the_distance(analysis: Analysis):
    """Best takes exactly those second levels whose effect on the distance is negative beyond its margin; the cell that
    is named measured the least distance, and the method as it comes is cell 0."""
    default, best, measured = candidates_of(analysis)
    effects = analysis.effects[DISTANCE]
    assert best.second == {n for n, e in effects.items() if e.value < 0 and abs(e.value) > e.beyond}
    assert LOCATED in best.second  # more recoveries and more lead on both parts are both nearer to the paper
    assert MISS not in best.second  # it takes from the lead
    assert (default.cell, default.second) == (0, frozenset())
    distances = [analysis.figures(cell.number)[DISTANCE] for cell in design_cells()]
    assert measured.cell == int(np.argmin(distances))
    assert measured.measured is not None
    assert measured.measured[DISTANCE] == min(distances)


def test_prediction_is_the_mean_and_half_of_each_sure_effect(analysis: Analysis):
    """A linear model of the decisions that move the distance: of PB on D, by hand."""
    pb = Response("D", "pb")
    effects = analysis.effects[pb]
    mean = np.mean([analysis.figures(cell.number)[pb] for cell in design_cells()])
    halves = sum((0.5 if name == LOCATED else -0.5) * effects[name].value for name in analysis.sure)
    assert analysis.predicted(frozenset({LOCATED}))[pb] == pytest.approx(mean + halves)


def test_nothing_is_told_before_every_cell_has_its_figures():
    """One cell without PB on D: no effects, no candidates, and the figures that are there."""
    runs = [run for run in made_runs() if (run.part, run.arm) != ("D", "pb, cell 7")]
    partial = analysed(Comparison(runs), ("C", "D"), 3)
    assert not partial.effects
    assert candidates_of(partial) == []
    assert math.isnan(partial.figures(7)[Response("D", "lead")])
    assert partial.figures(7)[Response("D", "fra")] > 0
    assert (partial.n_starts(7), partial.n_starts(6)) == (0, 3)


@pytest.mark.parametrize("n_kept", [0, 63, 192])
def test_page_summary_and_candidates_of_any_number_of_runs(
    n_kept: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """A stopped study has a page of what it has, a whole one its candidates; what fails is listed, and escaped."""
    preset = ReadingsPreset.named("full").model_copy(update={"title": "Readings <made>"})
    runs = reading_runs(preset)
    monkeypatch.setattr(evaluation, "read_records", lambda out, runs: made_runs()[:n_kept])
    told = evaluation.evaluate_readings(tmp_path, preset, runs, [Failure("D fra, cell 3, start 1", "<SIGKILL>")], 1.0)
    html = told.report.read_text()
    assert "Readings &lt;made&gt;" in html
    assert "&lt;SIGKILL&gt;" in html
    assert all(decision.name in html for decision in DECISIONS)
    stored = json.loads((tmp_path / evaluation.READINGS_SUMMARY).read_text())
    assert (stored["runs"], stored["planned"], stored["failed"]) == (n_kept, 192, 1)
    assert len(stored["cells"]) == 16
    whole = n_kept == 192
    assert ("Distance from the paper</strong>" in html) is whole
    assert len(stored["candidates"]) == (3 if whole else 0)
    assert (tmp_path / "reading_best.yaml").exists() is whole
    assert [row["decision"] for row in stored["effects"]["D"]["pb"][:1]] == ([MISS] if whole else [])


def test_confirmations_are_comparisons_of_the_whole_table(
    analysis: Analysis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The file is a preset of `franbv study comparison`: 4 parts, 3 planners, 15 starts on the same bench, with the
    reading's parameters, and the study's own FRA runs are among its."""
    preset = ReadingsPreset.named("full")
    monkeypatch.setattr(evaluation, "read_records", lambda out, runs: made_runs())
    evaluation.evaluate_readings(tmp_path, preset, reading_runs(preset), [], 1.0)
    comparison = ComparisonPreset.named(str(tmp_path / "reading_measured.yaml"))
    cell = analysis.nearest_cell
    assert comparison.parameters == decided(Parameters(), cell.second)
    runs = planned_runs(comparison)
    assert len(runs) == 180
    assert {run.config.bench for run in runs} == {"paper"}
    ours = {run.digest for run in reading_runs(preset) if run.arm == f"fra, cell {cell.number}"}
    assert len(ours) == 6
    assert ours <= {run.digest for run in runs}
