"""Draws depend on seed and number alone, keep to the declared domain, and come as often as it says."""

import numpy as np
import pytest
from scipy.stats import binomtest, kstest

from materials.catalog import material
from materials.input_error import InputError
from scenes.build import coupon_scene
from scenes.reference_points import part_box
from studies.base.config import validated
from studies.thresholds.config import Domain, ThresholdsPreset
from studies.thresholds.draw import run_draw, run_settings, subject_settings, view_draw, view_pose

DOMAIN = Domain(
    parts={"ball": 1, "plate": 3},
    materials={"own": 0, "iron:blasted": 1, "nickel:bright": 1},
    lamps={"dim": 1},
    distance_m=(0.3, 0.4),
    polar_deg=(20, 70),
)
RISKS = {"false_recoveries": {"most": 0, "level": 0.2}}


def test_numbers_alone_decide():
    """The same number gives the same draw; another seed, or another number, another one."""
    draws = [view_draw(DOMAIN, 3, number) for number in range(50)]
    assert draws == [view_draw(DOMAIN, 3, number) for number in range(50)]
    assert len({draw.seed for draw in draws}) == 50
    assert view_draw(DOMAIN, 4, 7) != draws[7]
    assert run_draw(DOMAIN, 3, 7).seed != draws[7].seed


def test_the_domain_is_kept():
    """Weights by a binomial test, angles by one of their distribution: uniform on the sphere, and all within range."""
    draws = [view_draw(DOMAIN, 0, number) for number in range(2000)]
    assert {draw.material for draw in draws} == {"iron:blasted", "nickel:bright"}
    plates = sum(draw.part == "plate" for draw in draws)
    assert binomtest(plates, 2000, 0.75).pvalue > 1e-3
    heights = np.cos(np.radians([draw.polar_deg for draw in draws]))
    low, high = np.cos(np.radians([70, 20]))
    assert kstest(heights, "uniform", (low, high - low)).pvalue > 1e-3
    assert kstest([draw.azimuth_deg for draw in draws], "uniform", (0, 360)).pvalue > 1e-3
    assert all(0.3 <= draw.distance_m <= 0.4 for draw in draws)


def test_where_a_view_stands():
    """At its distance and angle from the middle of the part, looking at it, turned by the mount."""
    scene = coupon_scene("ball", material("iron:blasted"), "dim")
    draw = view_draw(DOMAIN, 0, 1)
    pose, middle = view_pose(draw, scene, 90.0), part_box(scene).mean(axis=0)
    to_eye = pose.translation - middle
    assert np.linalg.norm(to_eye) == pytest.approx(draw.distance_m)
    assert np.degrees(np.arccos(to_eye[2] / draw.distance_m)) == pytest.approx(draw.polar_deg)
    axes = pose.rotation.as_matrix()
    np.testing.assert_allclose(axes[:, 2], -to_eye / draw.distance_m, atol=1e-9)
    assert axes[2, 1] == pytest.approx(0, abs=1e-9)  # on end: the image's columns are level
    assert abs(axes[2, 0]) > 0.2


def test_what_the_commands_are_told():
    """A drawn scene is one of `franbv reconstruct`; `own` leaves the material to the part."""
    preset = ThresholdsPreset(title="x", domain=DOMAIN, risks=RISKS)
    draw = run_draw(DOMAIN, 0, 5)
    settings = run_settings(DOMAIN, draw, preset.parameters)
    assert (settings.part, settings.material, settings.lamps) == (draw.part, (draw.material,), "dim")
    assert (settings.azimuth_deg, settings.seed, settings.planner) == (draw.azimuth_deg, draw.seed, "fra")
    own = view_draw(DOMAIN, 0, 0).model_copy(update={"material": "own"})
    assert subject_settings(DOMAIN, own).material == ()


BAD = {
    "parts: there is no bell": {"domain": {"parts": {"bell": 1}, "lamps": {"dim": 1}}},
    "distance_m: the lower end 0.5 is above": {
        "domain": {"parts": {"ball": 1}, "lamps": {"dim": 1}, "distance_m": [0.5, 0.3]}
    },
    "there is no false_recovery": {"risks": {"false_recovery": {"most": 0, "level": 0.1}}},
    "`risks.false_recoveries.level` = 1.5": {"risks": {"false_recoveries": {"most": 0, "level": 1.5}}},
    "the planner has no eta": {"settings": {"eta": [0.5]}},
    "recovered_share shows in reconstructions alone": {"settings": {"recovered_share": [0.3]}},
    "coverage_shortfall needs reconstructions": {
        "risks": {"coverage_shortfall": {"most": 0.2, "level": 0.1}},
        "budget": {"reconstructions": 0},
    },
    "prefer: coverage_shortfall shows in": {"prefer": "coverage_shortfall"},
    "unknown key `budgets`": {"budgets": {}},
}


@pytest.mark.parametrize("words", BAD)
def test_what_cannot_be_asked(words: str):
    """One line with the key and the mend."""
    stated = {"title": "x", "domain": DOMAIN.model_dump(mode="json"), "risks": RISKS} | BAD[words]
    with pytest.raises(InputError) as raised:
        validated(ThresholdsPreset, stated, "study.yaml")
    assert words in str(raised.value)
    assert "\n" not in str(raised.value)
