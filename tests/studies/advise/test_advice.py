"""What is said of shares that are known."""

from studies.advise.advice import advice_from, advice_json, joined_words, read_advice
from studies.advise.sentences import advice_sentence, ranking_lines
from tests.studies.advise.made_up import remedy, tried

BASE = [0.50, 0.52, 0.54, 0.56, 0.54, 0.58]
SPRAYED = [0.97, 0.96, 0.97, 0.98, 0.97, 0.97]


def better(points: float, noise: float = 0.0) -> list[float]:
    """The base with a gain that varies from pose to pose."""
    return [share + points + noise * (-1) ** k for k, share in enumerate(BASE)]


def test_the_best_combination_is_advised_with_what_spray_would_give():
    """Two remedies that gain 27 points in every pose."""
    laser, roll, spray = remedy("laser", "60 mW"), remedy("roll", "90 deg"), remedy("spray", "matte")
    singles = [tried(laser, right=better(0.1)), tried(spray, right=SPRAYED)]
    advice, best = advice_from([tried(right=BASE), *singles, tried(laser, roll, right=better(0.27))], 6, 1)
    assert best.remedies == (laser, roll)
    text = advice_sentence(advice, {})
    assert text.startswith("Set the laser to 60 mW and turn the camera by 90 deg: right depth on 81 % (")
    assert text.endswith("instead of 54 %; spray would give 97 %.")
    assert advice.best.cost == "motion"
    assert advice.best.light == "new"


def test_spray_is_no_advice_even_where_nothing_else_helps():
    """A chrome ball: everything is level, but the matte one is measured."""
    laser = remedy("laser", "60 mW")
    advice, best = advice_from(
        [tried(right=BASE), tried(laser, right=better(0.01, 0.1)), tried(remedy("spray", "matte"), right=SPRAYED)], 6, 1
    )
    assert (advice.kind, best.remedies) == ("only spray", ())
    text = advice_sentence(advice, {"false_depth_reflection": 0.4, "reflection_dark": 0.06})
    assert text.startswith("Nothing but spray helps")
    assert "40 % false depth reflection, 6 % reflection dark" in text


def test_what_spray_would_give_is_said_with_the_exposure_that_it_needs():
    """A white part that drowns under the set-point of a dark one."""
    spray, darker = remedy("spray", "matte"), remedy("set-point", "32 DN")
    singles = [tried(remedy("laser", "60 mW"), right=better(0.1)), tried(spray, right=better(-0.2))]
    advice, best = advice_from([tried(right=BASE), *singles, tried(spray, darker, right=SPRAYED)], 6, 1)
    assert advice_sentence(advice, {}).endswith("spray and set-point 32 DN would give 97 %.")
    assert [one.factor.name for one in best.remedies] == ["laser"]


def test_what_makes_depth_up_on_top_of_what_helps_is_not_advised():
    """A filter takes 25 points of false depth away, and hole filling then adds ten of right depth and twenty of false:
    less false than without either, and still more made up than measured."""
    band, fill = remedy("band-pass filter", "850 nm"), remedy("filters", "hole filling, largest disparity")
    answers = [
        tried(right=[0.3] * 6, false=0.5),
        tried(band, right=[0.5] * 6, false=0.25),
        tried(fill, right=[0.35] * 6, false=0.6),
        tried(band, fill, right=[0.6] * 6, false=0.45),
    ]
    advice, best = advice_from(answers, 6, 1)
    assert best.remedies == (band,)
    assert [one.verdict for one in advice.combinations] == ["trades"]


def test_nothing_is_needed_where_spray_would_add_nothing():
    """A matte part."""
    advice, _ = advice_from([tried(right=SPRAYED), tried(remedy("spray", "matte"), right=SPRAYED)], 6, 1)
    assert (advice.kind, advice.beside) == ("nothing needed", None)
    assert advice_sentence(advice, {}).startswith("Nothing is needed against shine: right depth on 97 %")


def test_what_helps_a_matte_part_a_little_is_named_beside():
    """A turn gains five points of it, and spray none under any exposure that was tried: alone it drowns."""
    spray, darker, turn = remedy("spray", "matte"), remedy("set-point", "32 DN"), remedy("roll", "90 deg")
    singles = [tried(spray, right=better(-0.2)), tried(darker, right=better(0.03)), tried(turn, right=better(0.05))]
    advice, best = advice_from([tried(right=BASE), *singles, tried(spray, darker, right=better(0.03))], 6, 1)
    assert (advice.kind, advice.shine_matters, best.remedies) == ("nothing needed", False, ())
    assert advice.beside is not None
    assert advice.beside.name == "roll"
    assert advice_sentence(advice, {}).endswith("Turn the camera by 90 deg: 59 %, as on matte parts.")


def test_a_matte_part_in_bad_light_needs_a_remedy_that_is_not_against_shine():
    """Under a darker set-point it gains thirty points, sprayed or not."""
    spray, darker = remedy("spray", "matte"), remedy("set-point", "32 DN")
    singles = [tried(spray, right=BASE), tried(darker, right=better(0.3))]
    advice, best = advice_from([tried(right=BASE), *singles, tried(spray, darker, right=better(0.3))], 6, 1)
    assert (advice.kind, best.remedies) == ("remedy", (darker,))
    assert advice_sentence(advice, {}).endswith("Shine is not what is in the way.")


def test_a_gain_of_a_point_is_not_worth_a_remedy_though_it_is_told_apart():
    """Every pose gains one point."""
    advice, best = advice_from([tried(right=BASE), tried(remedy("laser", "60 mW"), right=better(0.01))], 6, 1)
    assert (advice.kind, best.remedies) == ("nothing helps", ())
    assert advice.remedies[0].verdict == "helps"


def test_a_smaller_gain_that_is_told_apart_is_advised_before_a_larger_one_that_is_not():
    """Six points in every pose, and eight in the mean that come and go."""
    sure, unsure = remedy("roll", "90 deg"), remedy("laser", "60 mW")
    advice, best = advice_from(
        [tried(right=BASE), tried(unsure, right=better(0.08, 0.3)), tried(sure, right=better(0.06))], 6, 1
    )
    assert (advice.kind, best.remedies) == ("remedy", (sure,))


def test_ranks_hold_what_is_not_told_apart():
    """Two that trade places from pose to pose share a rank; one that is worse in every pose does not."""
    a, b, c = remedy("laser", "60 mW"), remedy("laser", "90 mW"), remedy("laser", "30 mW")
    singles = [tried(a, right=better(0.2)), tried(b, right=better(0.19, 0.05)), tried(c, right=better(-0.2))]
    advice, _ = advice_from([tried(right=BASE), *singles], 6, 1)
    assert [(one.level, one.rank, one.verdict) for one in advice.remedies] == [
        ("60 mW", 1, "helps"),
        ("90 mW", 1, "helps"),
        ("30 mW", 3, "hurts"),
    ]
    assert "1 hurt" in ranking_lines(advice)[-1]


def test_an_advice_survives_its_file():
    """What is read is what was written."""
    advice, _ = advice_from([tried(right=BASE), tried(remedy("laser", "60 mW"), right=better(0.2))], 6, 1)
    assert read_advice(advice_json(advice)) == advice


def test_words_are_joined_as_people_do():
    """With one `and`."""
    assert joined_words(["a"]) == "a"
    assert joined_words(["a", "b", "c"]) == "a, b and c"
    assert joined_words([]) == ""
