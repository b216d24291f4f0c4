"""Which remedy wins a case, on shares that are known beforehand."""

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from materials.input_error import InputError
from studies.advise.scoring import SurfaceCount
from studies.mitigations.answers import stored_answers
from studies.mitigations.tallies import tallies, told_verdict
from studies.sensitivity.measurement import CASES, RESULT
from tests.studies.mitigations.made_up_study import CASE, answer, cases

LASER, ROLL, SPRAY = ("laser", "60 mW"), ("roll", "90 deg"), ("spray", "matte")
FILLED = ("filters", "hole filling, largest disparity")


def test_the_largest_honest_gain_wins():
    """Hole filling adds 20 points of right depth and 30 of false depth: it is named, and does not win; nor does spray,
    which is the ceiling."""
    found = answer(CASE, 0.5, {LASER: 0.1, ROLL: 0.15, FILLED: (0.2, 0.3), SPRAY: 0.45})
    assert found.winner is not None
    assert (found.winner.name, round(found.winner.gain, 6)) == ("roll", 0.15)
    assert {name: told_verdict(score) for name, score in found.scores.items()} == {
        "laser: 60 mW": "helps", "roll: 90 deg": "helps", f"filters: {FILLED[1]}": "trades", "spray: matte": "helps",
    }  # fmt: skip
    assert found.advice.ceiling is not None
    assert found.advice.ceiling.right_share == pytest.approx(0.95)


def test_a_gain_below_two_points_wins_nothing_and_counts_as_level():
    """Though it is told apart: it is the same at every pose."""
    found = answer(CASE, 0.5, {LASER: 0.015, ROLL: -0.015, SPRAY: 0.4})
    assert found.winner is None
    assert (found.advice.kind, found.needs_help) == ("only spray", True)
    assert {told_verdict(score) for name, score in found.scores.items() if name != "spray: matte"} == {"level"}


def test_where_spray_gains_nothing_no_help_is_needed():
    """So that advice is not blamed for it."""
    assert not answer(CASE, 0.96, {LASER: 0.0, SPRAY: 0.01}).needs_help


def test_tallies_count_verdicts_and_wins():
    """Two cases won by the turn, one by the laser; medians of 0.1, 0.1, 0.3 and 0.2, 0.2, -0.1."""
    found = tallies(
        [
            answer(CASE, 0.5, {LASER: 0.1, ROLL: 0.2}),
            answer(CASE, 0.5, {LASER: 0.1, ROLL: 0.2}),
            answer(CASE, 0.5, {LASER: 0.3, ROLL: -0.1}),
        ]
    )
    assert [(one.name, one.wins, one.cases) for one in found] == [("roll: 90 deg", 2, 3), ("laser: 60 mW", 1, 3)]
    assert found[0].counts == {"helps": 2, "level": 0, "trades": 0, "hurts": 1}
    assert [round(one.gain.value, 6) for one in found] == [0.2, 0.1]


def test_folders_that_are_there_are_read_and_others_passed_over(tmp_path: Path):
    """Counts as a case's folder holds them; one that cannot be read is named."""
    first, second = cases(remedies={"laser": ("60 mW",)}, poses=2)[:2]
    view = [asdict(SurfaceCount(2.0, 1.0, 0.5, 1.0))]
    better = [asdict(SurfaceCount(2.0, 1.5, 0.5, 1.0))]
    rows = [{"remedy": [], "views": [view, view]}, {"remedy": list(LASER), "views": [better, better]}]
    folder = tmp_path / CASES / second.digest
    folder.mkdir(parents=True)
    (folder / RESULT).write_text(json.dumps({"counts": rows}))
    (found,) = stored_answers(tmp_path, [first, second])
    assert found.case == second
    assert found.advice.base.right_share == 0.5
    assert found.winner is not None
    assert found.winner.gain == 0.25
    (folder / RESULT).write_text("{")
    with pytest.raises(InputError, match="copy the study whole"):
        stored_answers(tmp_path, [second])
