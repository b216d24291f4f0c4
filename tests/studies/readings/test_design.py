"""The design of the study of readings: what orthogonal arrays promise, counted in the cells themselves."""

from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest

from franbv.parameters import Parameters
from studies.cli.main import main
from studies.comparison.cases import planned_runs
from studies.readings.decisions import DECIDED_FIELDS, DECISIONS, decided, read_by
from studies.readings.design import COLUMN, FIVE, N_CELLS, design_cells, level_signs, mixed_with
from studies.readings.preset import ReadingsPreset
from studies.readings.runs import apart, reading_runs
from studies.run.batch import check_runs

NAMES = [decision.name for decision in DECISIONS]


def test_columns_are_balanced_and_orthogonal():
    """Each decision at each level in eight cells, each pair of levels of two decisions in four."""
    columns = level_signs()
    assert columns.shape == (16, 13)
    assert (columns.sum(axis=0) == 0).all()
    for one, other in combinations(range(13), 2):
        pairs = {
            (a, b): int(((columns[:, one] == a) & (columns[:, other] == b)).sum()) for a in (-1, 1) for b in (-1, 1)
        }
        assert set(pairs.values()) == {4}


def test_no_column_is_used_twice():
    """Thirteen decisions in the fifteen columns that are not constant; two are empty."""
    assert sorted(COLUMN.values()) == [k for k in range(1, N_CELLS) if k not in {10, 11}]
    assert set(COLUMN) == set(NAMES)


def test_pairs_that_are_mixed_are_those_whose_product_is_the_column():
    """Multiplied out, cell by cell: each of the 78 pairs is a decision's own or, six of each, in an empty column."""
    columns = dict(zip(NAMES, level_signs().T, strict=True))
    told = {frozenset(pair): name for name in NAMES for pair in mixed_with(name)}
    assert len(told) == 78 - 2 * 6
    for one, other in combinations(NAMES, 2):
        # -1 is the first level of each: the product of two columns is a third, or that with all signs turned.
        product = columns[one] * columns[other]
        same = [name for name in NAMES if abs(product @ columns[name]) == N_CELLS]
        assert [told[frozenset((one, other))]] == same if same else frozenset((one, other)) not in told


def test_five_are_clear_of_their_own_pairs():
    """Resolution V among them: each other decision's column is that of one of their ten pairs; told first."""
    columns = dict(zip(NAMES, level_signs().T, strict=True))
    for one, other in combinations(FIVE, 2):
        product = columns[one] * columns[other]
        assert not any(abs(product @ columns[name]) for name in FIVE)
    firsts = [frozenset(mixed_with(name)[0]) for name in NAMES if name not in FIVE]
    assert len(set(firsts)) == len(firsts) == 8
    assert all(pair <= set(FIVE) for pair in firsts)


def test_first_cell_has_the_defaults_and_no_two_are_alike():
    """Cell 0 is the method as it comes; all cells differ in eight columns (the rows of a Hadamard matrix do), of which
    two are empty."""
    cells = design_cells()
    assert decided(Parameters(), cells[0].second) == Parameters()
    for one, other in combinations(cells, 2):
        assert 6 <= len(one.second ^ other.second) <= 8


def test_decisions_change_readings_alone():
    """Each changes its own fields and no other's, to another valid model, and none of what the paper's table states."""
    of_table = {"n_frames", "voxel_size", "n_candidates", "stand_off", "max_iterations", "stagnation_change",
                "stagnation_iterations", "lateral_offset", "recovery_distance", "recovered_share"}  # fmt: skip
    assert not DECIDED_FIELDS & of_table
    assert sum(len(decision.values[0]) for decision in DECISIONS) == len(DECIDED_FIELDS)
    before = Parameters().model_dump()
    for decision in DECISIONS:
        after = Parameters.model_validate(decision.changed(Parameters(), True).model_dump()).model_dump()
        assert {name for name in after if after[name] != before[name]} == set(decision.values[1])
        assert set(decision.values[0]) == set(decision.values[1])


def test_pb_is_told_nothing_of_the_recovery():
    """A reading that differs in detector and recovery alone is the same PB run, by its name on disk, and another of
    FRA's; one that differs in the map is another run of both."""
    preset = ReadingsPreset.named("full")
    of_recovery = frozenset(decision.name for decision in DECISIONS if decision.of_recovery)
    for planner, second, alike in (
        ("pb", of_recovery, True),
        ("fra", of_recovery, False),
        ("pb", {"weighting"}, False),
    ):
        told = [decided(preset.parameters, read_by(planner, frozenset(names))) for names in ((), second)]
        assert (told[0] == told[1]) is alike


def test_full_preset_is_one_start_after_the_other():
    """2 parts, 2 planners, 16 cells, 3 starts; the same start has the same azimuth and seed in every cell, and those of
    the comparison of fifteen starts."""
    preset = ReadingsPreset.named("full")
    runs = reading_runs(preset)
    assert [run.run for run in runs] == sorted([0, 1, 2] * 64)
    assert len({run.digest for run in runs}) == 192  # the eight decisions that PB reads differ between any two cells
    for start, azimuth in enumerate((0.0, 120.0, 240.0)):
        configs = [run.config for run in runs if run.run == start]
        assert {config.azimuth_deg for config in configs} == {azimuth}
        assert len({config.seed for config in configs}) == 1
        assert {(config.bench, config.lamps, config.sensor.roll_deg) for config in configs} == {("paper", "task", 90.0)}
    assert len({run.config.seed for run in runs}) == 3
    check_runs(runs)


def test_neighbours_share_no_burst():
    """Runs that two workers make at the same time look at another part or look first from another height."""
    cells = apart(design_cells())
    assert sorted(cell.number for cell in cells) == list(range(16))
    for preset in (ReadingsPreset.named("full"), ReadingsPreset.named("quick")):
        runs = reading_runs(preset)
        for one, other in pairwise(runs):
            elevations = [run.config.parameters.first_elevation_deg for run in (one, other)]
            same_planner = one.config.planner == other.config.planner and one.run == other.run
            assert not same_planner or one.part != other.part or elevations[0] != elevations[1]


def test_starts_and_seeds_are_those_of_a_comparison():
    """A reading's runs are found by the comparison that confirms it: three of its fifteen starts."""
    preset = ReadingsPreset.named("full")
    cell = design_cells()[3]
    ours = {run.config.azimuth_deg: run for run in reading_runs(preset) if run.arm == "fra, cell 3" and run.part == "D"}
    whole = preset.as_comparison(cell.second).model_copy(update={"starts": 15, "runs": 15})
    theirs = {run.digest for run in planned_runs(whole) if run.part == "D" and run.arm == "fra"}
    assert {run.digest for run in ours.values()} <= theirs
    assert np.isclose(sorted(ours), [0.0, 120.0, 240.0]).all()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("parts: [E]", "parts: the paper has no E; its parts are A, B, C, D"),
        ("parts: [C, C]", "parts: C stands there twice"),
        ("parameters: {located_on: any}", "located_on: the study itself decides that; leave it out"),
    ],
)
def test_bad_presets_are_one_line(text: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """What is wrong, exit status 2, and no output folder."""
    (tmp_path / "own.yaml").write_text(f"title: Mine\n{text}\n")
    flags = ["--out", str(tmp_path / "out"), "--preset", str(tmp_path / "own.yaml")]
    assert main(["study", "readings", *flags]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()
