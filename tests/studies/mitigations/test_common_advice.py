"""Verdicts on common advice, on cases whose gains are known beforehand."""

import pytest

from studies.advise.search import Tried
from studies.mitigations.answers import answer_of, known_remedy
from studies.mitigations.common_advice import (
    COMMON_ADVICE,
    DEPENDS,
    NEARLY_RIGHT,
    NEARLY_WRONG,
    NOT_TOLD_APART,
    TOO_FEW_CASES,
    UNTRIED,
    JudgedAdvice,
    advice_verdict,
    explained_share,
    judged_advice,
    judged_piece,
    share_interval,
)
from studies.mitigations.polarised import COATED, polarised_materials
from studies.mitigations.sentences import advice_verdict_words, poses_caveat, study_paragraph
from studies.mitigations.tallies import tallies
from tests.studies.advise.made_up import shares
from tests.studies.mitigations.made_up_study import answer, cases, measured

LOW, HIGH, SPRAY = ("laser", "60 mW"), ("laser", "360 mW"), ("spray", "matte")
OFF, FILMS = ("lamps", "off"), ("polarisers", "on the imagers")
METALS = ("aluminium", "brass", "iron", "copper")
PIECES = {piece.words: piece for piece in COMMON_ADVICE}


def catalogue(**settings: object) -> list:
    """Four metals in two finishes, and a plastic: nine cases."""
    return cases(metals=METALS, materials=("black_plastic",), **settings)


def study() -> list:
    """A weaker laser hurts everywhere, a stronger one helps on blasted surfaces, lamps off help everywhere; films help
    on plastic alone."""
    return [
        answer(
            case,
            0.5,
            {
                LOW: -0.1,
                HIGH: 0.1 if case.finish == "blasted" else -0.1,
                OFF: 0.2,
                FILMS: 0.0 if case.finish else 0.3,
                SPRAY: 0.45,
            },
        )
        for case in catalogue()
    ]


def test_verdicts_follow_the_shares():
    """Nine of nine, none of nine, four of nine; what was not tried is not judged."""
    found = {one.words: one for one in judged_advice(study())}
    assert found["Switch the lamps off"].verdict == NEARLY_RIGHT
    assert found["Lower the laser"].verdict == NEARLY_WRONG
    assert found["Lower the laser"].counts == {"helps": 0, "level": 0, "trades": 0, "hurts": 9}
    stronger = found["Raise the laser"]
    assert (stronger.verdict, stronger.cases, stronger.share) == (DEPENDS, 9, pytest.approx(4 / 9))
    assert found["Tilt the part"].verdict == UNTRIED


def test_what_it_depends_on_is_the_finish():
    """All blasted surfaces, none of the polished ones and not the plastic."""
    (stronger,) = [one for one in judged_advice(study()) if one.words == "Raise the laser"]
    assert stronger.by == "finish"
    assert stronger.groups[0] == ("blasted", 1.0, 4)
    words = advice_verdict_words(stronger)
    assert "mostly on blasted" in words
    assert "seldom on polished and black plastic" in words


def test_what_gains_over_all_cases_and_is_told_apart_in_none_is_not_called_wrong():
    """Nine cases that a tilt gains ten points each in the mean, by what it does to one pose of six; of noise that comes
    and goes as much nothing remains in the median, and it stays wrong."""
    tilt = known_remedy("tilt of the part", "30 deg")

    def found(gains: list[float]) -> JudgedAdvice:
        answers = []
        for case in catalogue():
            tried = measured(0.3, {SPRAY: 0.45})
            one = Tried((tilt,), tilt.level.change(tried[0].setup), shares([0.3 + gain for gain in gains], 0.1))
            answers.append(answer_of(case, [*tried, one]))
        return judged_piece(PIECES["Tilt the part"], answers)

    gained = found([0.6, 0.0, 0.0, 0.01, -0.01, 0.0])
    assert (gained.counts["level"], gained.share, gained.verdict) == (9, 0.0, NOT_TOLD_APART)
    nothing = found([0.1, -0.1, 0.0, 0.01, -0.01, 0.0])
    assert (nothing.counts["level"], nothing.share, nothing.verdict) == (9, 0.0, NEARLY_WRONG)


def test_films_are_judged_on_bare_metal_alone():
    """The plastic, on which they help, is no bare metal."""
    (films,) = [one for one in judged_advice(study()) if one.words.startswith("Put a polariser")]
    assert (films.cases, films.share, films.verdict) == (8, 0.0, NEARLY_WRONG)


def test_cases_that_need_nothing_do_not_speak_against_advice():
    """Eight cases of nine have full depth: the verdict rests on the one that has not."""
    found = [
        answer(case, 0.5 if k == 0 else 0.97, {OFF: 0.2 if k == 0 else 0.0, SPRAY: 0.3 if k == 0 else 0.0})
        for k, case in enumerate(catalogue())
    ]
    off = judged_piece(PIECES["Switch the lamps off"], found)
    assert (off.cases, off.share) == (1, 1.0)
    assert off.verdict == TOO_FEW_CASES
    assert advice_verdict_words(off).startswith("too few cases to say: helps in 100 %")


def test_advice_with_two_remedies_counts_each_in_part():
    """A band of set-points would; here both HDR pairs of each case, of which one helps: half of each case."""
    pairs = {("HDR pair", "8500 and 1000 us"): 0.1, ("HDR pair", "8500 and 150 us"): -0.1, SPRAY: 0.4}
    found = judged_piece(PIECES["Take an HDR pair"], [answer(case, 0.5, pairs) for case in catalogue()])
    assert (found.share, found.cases) == (0.5, 9)
    assert sum(found.counts.values()) == 18
    assert found.gain is not None
    assert found.gain.value == pytest.approx(0.0)


def test_intervals_are_clopper_and_pearsons():
    """Of none of n the upper end is 1 - 0.025^(1/n), of all of n the lower end 0.025^(1/n); of five of ten the exact
    binomial tails are 2.5 % (ends from their tables: 18.7 and 81.3 %)."""
    assert share_interval(0.0, 10) == (0.0, pytest.approx(1 - 0.025**0.1))
    assert share_interval(1.0, 10) == (pytest.approx(0.025**0.1), 1.0)
    assert share_interval(0.5, 10) == (pytest.approx(0.187, abs=5e-4), pytest.approx(0.813, abs=5e-4))


@pytest.mark.parametrize(
    ("helped", "cases", "verdict"),
    [
        (5, 5, TOO_FEW_CASES), (6, 6, NEARLY_RIGHT), (0, 5, TOO_FEW_CASES), (0, 6, NEARLY_WRONG), (3, 6, DEPENDS),
        (8, 10, TOO_FEW_CASES), (16, 20, NEARLY_RIGHT), (2, 10, TOO_FEW_CASES), (4, 20, NEARLY_WRONG), (5, 20, DEPENDS),
    ],
)  # fmt: skip
def test_a_verdict_needs_an_interval_on_its_side_of_a_half(helped: int, cases: int, verdict: str):
    """Exact binomial tails at a half: all of five have 3.1 % and all of six 1.6 %; eight or more of ten 5.5 %, sixteen
    or more of twenty 0.6 %; the limit is 2.5 %."""
    share = helped / cases
    assert advice_verdict(share, *share_interval(share, cases), cases) == verdict


def test_explained_share_by_hand():
    """Two groups of two, means 0.5 and 1: within (0.5^2 x 2) / 2, all 0.75 / 3: 1 - 0.25 / 0.25 = 0. Groups that settle
    every value explain all; one group, and one for each value, explain nothing."""
    assert explained_share(["a", "a", "b", "b"], [0.0, 1.0, 1.0, 1.0]) == pytest.approx(0.0)
    assert explained_share(["a", "a", "b", "b"], [0.0, 0.0, 1.0, 1.0]) == 1.0
    assert explained_share(["a"] * 4, [0.0, 0.0, 1.0, 1.0]) == 0.0
    assert explained_share(list("abcd"), [0.0, 0.0, 1.0, 1.0]) == 0.0


def test_degrees_of_polarisation_are_those_of_fresnel():
    """At 45 deg R_p = R_s^2 for every smooth surface in air (Born and Wolf; it follows from the amplitudes), so that
    the degree is (1 - R_s) / (1 + R_s); known to whole percent: aluminium 5, brass 2, a coat of n 1.5 83."""
    rows = {row.name: row for row in polarised_materials(study())}
    assert list(rows) == ["iron", "aluminium", "copper", "brass", COATED]
    for row in rows.values():
        assert row.reflectance_p == pytest.approx(row.reflectance_s**2)
        assert row.degree == pytest.approx((1 - row.reflectance_s) / (1 + row.reflectance_s))
    known = {name: round(100 * rows[name].degree) for name in ("aluminium", "brass", COATED)}
    assert known == {"aluminium": 5, "brass": 2, COATED: 83}
    assert rows[COATED].gains["on the imagers"].value == pytest.approx(0.3)
    assert rows["iron"].gains["on the imagers"].value == pytest.approx(0.0)
    assert rows["iron"].gains["on the imagers"].count == 2


def test_the_paragraph_says_what_wins():
    """Lamps off, but on plastic, where films gain more; from 50 % by the median of 20 points."""
    found = study()
    words = study_paragraph(found, tallies(found))
    assert "In 9 of 9 cases a remedy helps" in words
    assert "turn the lamps off (8) and put polarisers on the imagers (1)" in words
    assert "by 20 points in the median; spray gives 95 %" in words
    assert study_paragraph([], []) == "No case is measured yet."


def test_few_poses_are_owned_up_to():
    """With three, noise alone agrees in an eighth of cases."""
    assert f"{100 * 0.5**3:.0f} %" in poses_caveat(3)
    assert poses_caveat(6) == ""
