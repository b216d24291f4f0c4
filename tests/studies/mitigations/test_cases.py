"""Presets and cases of a study of mitigations: what they ask, and bad ones refused in one line."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from materials.catalog import finish_names, material, metal_names
from render.d435i import SensorSettings
from scenes.build import COUPONS, coupon_scene
from scenes.reference_points import part_box
from studies.advise.changed_scene import changed_scene
from studies.advise.factors import REMEDY_FACTORS
from studies.mitigations.cases import mitigation_cases, tried_remedies
from studies.mitigations.preset import STANDARD_REMEDIES, MitigationsPreset
from tests.studies.mitigations.made_up_study import CASE, cases, preset


def test_full_preset_is_the_catalogue_on_every_coupon():
    """12 metals in all finishes that each can have, and one coated plastic; no case twice."""
    full = MitigationsPreset.named("full")
    assert (set(full.metals), set(full.finishes), set(full.coupons)) == (
        set(metal_names()), set(finish_names()), set(COUPONS),
    )  # fmt: skip
    found = mitigation_cases(full)
    metals = sum(len(finish_names(metal)) for metal in metal_names())
    assert len(found) == (metals + 1) * len(COUPONS)
    assert len({case.digest for case in found}) == len(found)
    assert "gold:oxidised" not in full.specs()


def test_metals_preset_has_all_metals_in_four_finishes_on_one_coupon():
    """And the plastic."""
    found = MitigationsPreset.named("metals")
    assert len(found.specs()) == 12 * 4 + 1
    assert len(found.coupons) == 1


def test_standard_remedies_touch_every_factor_but_two():
    """Fixed exposures say what set-points say, and profiles cost up to four times the pixels."""
    assert {factor.name for factor in REMEDY_FACTORS} - set(STANDARD_REMEDIES) == {"exposure", "profile"}
    assert len(tried_remedies(CASE, has_lamps=True)) == 1 + sum(map(len, STANDARD_REMEDIES.values()))


def test_lamps_are_not_changed_where_there_are_none():
    """Neither switched off nor diffused."""
    lit, dark = (tried_remedies(CASE, has_lamps) for has_lamps in (True, False))
    assert {name[0] for name in set(lit) - set(dark)} == {"lamps", "placing of lamps"}


@pytest.mark.parametrize("coupon", COUPONS)
def test_what_a_tilt_leaves_as_it_was_is_not_tilted(coupon: str):
    """A ball, and a cylinder that lies along the axis of the tilt: their boxes stay within a millimetre, those of the
    other coupons do not."""
    (case, *_), scene = cases(coupons=(coupon,)), coupon_scene(coupon, material("iron:blasted"))
    before, after = part_box(scene), part_box(changed_scene(scene, sprayed=False, tilt_deg=30.0, lamps="own"))
    changes = bool(np.abs(after - before).max() > 1e-3)
    assert changes == any("tilt of the part" in name for name in tried_remedies(case, has_lamps=True))


def test_what_the_camera_has_already_is_no_remedy():
    """150 mW is its laser power."""
    remedies = {"laser": ("150 mW", "60 mW")}
    assert list(tried_remedies(cases(remedies=remedies)[0], has_lamps=True)) == [(), ("laser", "60 mW")]


def test_poses_are_those_of_the_coupon_for_all_materials():
    """So that materials are compared from the same places; an inside corner, open towards -y, is looked into."""
    found = cases(coupons=("ball", "inside_corner"))
    by_coupon = {coupon: {case.settings.pose for case in found if case.coupon == coupon} for coupon in COUPONS}
    assert {coupon: len(poses) for coupon, poses in by_coupon.items() if poses} == {"ball": 1, "inside_corner": 1}
    (corner,), (ball,) = by_coupon["inside_corner"], by_coupon["ball"]
    towards = [math.sin(math.radians(float(text.split(",")[0]))) for text in corner]
    assert max(towards) < 0
    assert max(math.sin(math.radians(float(text.split(",")[0]))) for text in ball) > 0


def test_whatever_decides_counts_decides_the_name():
    """Light, camera, remedies, seeds."""
    changed = (
        {"lamps": "off"}, {"bench": "paper"}, {"sensor": SensorSettings(decimation=1, crop=None, profile="480x270")},
        {"remedies": {"laser": ("60 mW",)}}, {"seeds": 2}, {"seed": 5}, {"distance": 0.4},
    )  # fmt: skip
    digests = [cases(**change)[0].digest for change in changed]
    assert len({CASE.digest, *digests}) == len(changed) + 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"remedies": {"lasers": ("60 mW",)}}, "there is no factor lasers; did you mean laser"),
        ({"remedies": {"laser": ("61 mW",)}}, "laser has no level 61 mW; did you mean 60 mW"),
        ({"metals": ("aluminum",)}, "metals: there is no aluminum; did you mean aluminium"),
        ({"coupons": ("bal",)}, "coupons: there is no bal"),
        ({"coupons": ("ball", "ball")}, "ball stands there twice"),
        ({"finishes": ()}, "metals go with finishes"),
        ({"metals": (), "finishes": ()}, "lists no materials"),
        ({"lamps": "task"}, "lamps task"),
        ({"sensor": {"crop": (60, 40), "decimation": 1}}, "scored over the whole image"),
    ],
)
def test_bad_presets_are_refused(change: dict, words: str):
    """Before anything is measured."""
    with pytest.raises((ValidationError, ValueError), match=words):
        preset(**change)
