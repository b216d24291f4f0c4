"""Scores by hand, choices by construction, and how often choices are wrong by counting."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from franbv.parameters import Parameters
from materials.input_error import InputError
from studies.thresholds.bank import BankedView
from studies.thresholds.certificate import lower_share, promise
from studies.thresholds.choose import (
    breaks,
    check_budget,
    choose_setting,
    exceeded,
    known_mean,
    repeated,
    split,
)
from studies.thresholds.command import stated_draws
from studies.thresholds.config import Bearable, Budget, ThresholdsPreset
from studies.thresholds.score import false_depth_share, least_share, region_pixels, region_scores, scored
from tests.studies.thresholds.made_up_bank import made_up_view
from tests.studies.thresholds.made_up_study import STUDY

RISKS = {"false_recoveries": Bearable(most=0, level=0.2), "false_depth_believed": Bearable(most=0.5, level=0.25)}


@pytest.fixture
def view() -> BankedView:
    """4 x 6 pixels: the left half is the part, its first column a reflective hole, one pixel with false depth."""
    part, reflective = np.zeros((4, 6), bool), np.zeros((4, 6), bool)
    part[:, :3], reflective[:, 0] = True, True
    reflective[0, 1] = reflective[1, 1] = True
    expected = np.full((4, 6), 0.3)
    depths = np.where(reflective, 0, expected)[None].repeat(2, axis=0)
    depths[:, 3, 2] = 0.35
    camera = np.array([6.0, 4.0, 5.0, 5.0, 2.5, 1.5])
    return BankedView(depths, camera, np.eye(4), part, reflective, expected, np.array(16.0))


def test_scores_by_hand(view: BankedView):
    """Six reflective pixels; a region of three of them and one other pixel, and a smaller one of none."""
    pixels = np.array([[0, 0], [0, 1], [0, 2], [2, 0], [5, 3], [4, 3]])
    labels = np.array([0, 0, 0, 0, 1, 1])
    assert region_scores(view, pixels, labels, Parameters()) == (0.0, pytest.approx(0.5))
    assert region_scores(view, pixels, labels, Parameters(regions_recovered="all")) == (1.0, pytest.approx(0.5))
    assert region_scores(view, pixels, 1 - labels, Parameters())[0] == 1.0
    assert region_pixels(view, pixels, labels) == (3, 6, 6)
    assert region_pixels(view, pixels, np.where(labels == 1, -1, labels)) == (3, 4, 6)
    nothing = region_scores(view, np.zeros((0, 2), int), np.zeros(0, int), Parameters())
    assert nothing == (0.0, 1.0)
    assert false_depth_share(view, view.depths[0]) == pytest.approx(1 / 6)  # of 12 pixels of the part 6 have depth


def test_too_small_a_hole_says_nothing(view: BankedView):
    """Four reflective pixels are less than a blob that could be found."""
    view.reflective[:2, 1] = False
    assert np.isnan(region_scores(view, np.zeros((0, 2), int), np.zeros(0, int), Parameters())[1])


def test_settings_scored_together_or_alone():
    """Sharing the map among settings that cluster differently changes no number; the mirroring ball is found."""
    view = made_up_view(STUDY.banks[0], 3)
    settings = STUDY.grid.settings
    together = scored(view, settings, 7).risks
    alone = np.concatenate([scored(view, [parameters], 7).risks for parameters in settings])
    np.testing.assert_array_equal(together, alone)
    assert together[0, 0] == 0
    assert together[0, 1] < 0.9


@given(st.floats(0.0, 1.0), st.integers(1, 40))
def test_shares_that_tell_the_same_frames_apart(share: float, n_frames: int):
    """Whatever number of frames is invalid, both shares judge it alike."""
    least = least_share(share, n_frames)
    assert all((k / n_frames >= share) == (k / n_frames >= least) for k in range(n_frames + 1))


def test_exceeding():
    """More than what is borne, not as much; what says nothing under one setting says nothing under any."""
    scores = {"false_recoveries": np.array([[0.0, 1.0], [2.0, np.nan], [1.0, 0.0]])}
    found = exceeded(scores, {"false_recoveries": Bearable(most=1, level=0.1)})["false_recoveries"]
    np.testing.assert_array_equal(found, [[0, 0], [np.nan, np.nan], [0, 0]])


def test_cameras_speak_for_themselves():
    """What a draw does not say under one camera takes nothing from what it says under another: the camera that leaves
    no hole in the bad half of the draws does not make the other's misses unseen."""
    numbers = np.array([[1.0, 0.0, np.nan, np.nan], [0.0, np.nan, 1.0, 0.0]])
    bearable = {"missed_reflective_area": Bearable(most=0.5, level=0.3)}
    found = exceeded({"missed_reflective_area": numbers}, bearable, np.array([0, 0, 1, 1]))["missed_reflective_area"]
    np.testing.assert_array_equal(found, [[1, 0, np.nan, np.nan], [np.nan, np.nan, 1, 0]])
    bad = np.arange(400) % 2 == 0
    missed = np.column_stack([np.where(bad, 0.9, 0.1), np.where(bad, np.nan, 0.1)])
    rows = {"missed_reflective_area": np.arange(400)}
    choice = choose_setting(
        {"missed_reflective_area": missed}, bearable, "missed_reflective_area", rows, rows, 0.9, np.array([0, 1])
    )
    assert choice.certified == (1,)
    assert choice.naive == 1


def test_what_the_budget_cannot_promise():
    """By the closed form: 39 draws without a failure reach 1 - 0.1^(1/39) = 5.73 % at 0.9."""
    draws, budget = {"false_recoveries": 60}, Budget(views=60)
    check_budget(draws, {"false_recoveries": Bearable(most=0, level=0.06)}, budget, 0.9)
    with pytest.raises(InputError, match=r"= 0.05: 39 certifying draws reach 0.0573 at confidence 0.9") as raised:
        check_budget(draws, {"false_recoveries": Bearable(most=0, level=0.05)}, budget, 0.9)
    assert "draw 70 or more" in str(raised.value)  # 45 certify 5 %, and 35 % of the draws learn


def test_splits_are_disjoint():
    """Every draw is dealt once."""
    dealt = split(101, (0.2, 0.5, 0.3), np.random.default_rng(1))
    assert [len(rows) for rows in dealt] == [20, 51, 30]
    assert sorted(np.concatenate(dealt)) == list(range(101))


CHANCES = {
    "false_recoveries": np.array([0.45, 0.3, 0.2, 0.08, 0.03]),
    "false_depth_believed": np.array([0.05, 0.05, 0.05, 0.1, 0.4]),
}
"""Probability to exceed under five settings: the fourth alone is well within both levels; the third is at one."""


def drawn(rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Numbers of n draws; the preferred one falls from setting to setting."""
    chance = {name: (rng.random((n, 1)) < chances) * 1.0 for name, chances in CHANCES.items()}
    return chance | {"missed_reflective_area": np.linspace(0.1, 0.9, 5) + rng.normal(size=(n, 1)) * 0.1}


def test_the_choice():
    """The one setting within both levels is certified; with less at stake more are, and the preferred is taken."""
    rng = np.random.default_rng(2)
    scores, n = drawn(rng, 700), np.arange(700)
    rows = [dict.fromkeys(scores, part) for part in (n[:250], n[250:])]
    choice = choose_setting(scores, RISKS, "missed_reflective_area", *rows, 0.9)
    assert choice.certified == (3,)
    assert choice.chosen == 3
    one = {"false_depth_believed": RISKS["false_depth_believed"]}
    free = choose_setting(scores, one, "missed_reflective_area", *rows, 0.9)
    assert free.chosen == min(free.certified)
    none = choose_setting(
        scores, {**RISKS, "false_recoveries": Bearable(most=0, level=0.02)}, "missed_reflective_area", *rows, 0.9
    )
    assert (none.certified, none.chosen, none.naive) == ((), None, None)


def test_a_domain_without_holes():
    """Of matte parts nothing is missed, so that what is preferred tells no setting from another; without a warning the
    first certified one is taken, and a mean of nothing is nothing."""
    rng = np.random.default_rng(6)
    scores = drawn(rng, 700) | {"missed_reflective_area": np.full((700, 5), np.nan)}
    rows = [dict.fromkeys(scores, part) for part in (np.arange(250), np.arange(250, 700))]
    one = {"false_depth_believed": RISKS["false_depth_believed"]}
    choice = choose_setting(scores, one, "missed_reflective_area", *rows, 0.9)
    assert choice.chosen == min(choice.certified)
    np.testing.assert_array_equal(known_mean(np.array([[1.0, np.nan], [2.0, np.nan]])), [1.5, np.nan])


def test_repetitions_count_what_is_wrong():
    """Choices exceed no more often than the confidence allows; naive ones, tempted by the third setting, far more often
    than those."""
    scores = drawn(np.random.default_rng(4), 900)
    found = repeated(scores, RISKS, "missed_reflective_area", Budget(views=900, repetitions=40), 0.9, 0)
    assert found.runs == 40
    assert found.violations <= found.allowed(0.9)
    assert found.naive_violations > 4 * max(1, found.violations)
    assert found.silent < 20


def test_what_breaks():
    """A share above its level on the draws that are looked at; no setting breaks nothing."""
    flags = {"false_recoveries": np.array([[1.0], [0.0], [np.nan], [0.0]])}
    risk = {"false_recoveries": Bearable(most=0, level=0.4)}
    assert not breaks(flags, risk, 0, {"false_recoveries": np.array([0, 1, 2, 3])})
    assert breaks(flags, risk, 0, {"false_recoveries": np.array([0, 1])})
    assert not breaks(flags, risk, None, {"false_recoveries": np.array([0, 1])})


def test_combinations_by_closed_form():
    """n of n draws: the lower end is 0.05^(1/n); of few draws nothing is said; NaN is no draw."""
    assert lower_share(10, 10) == pytest.approx(0.05 ** (1 / 10))
    assert lower_share(4, 4) == 0.0
    found = promise("false_recoveries", RISKS["false_recoveries"], np.array([1.0, np.nan, 0.0, 1.0]))
    assert (found.draws, found.exceeding, found.share) == (3, 2, pytest.approx(2 / 3))


@pytest.mark.parametrize("name", ["quick", "full"])
def test_the_stored_presets_ask_for_what_their_budgets_can_certify(name: str):
    """No level that no outcome could reach."""
    preset = ThresholdsPreset.named(name)
    check_budget(stated_draws(preset), preset.risks, preset.budget, preset.confidence)
