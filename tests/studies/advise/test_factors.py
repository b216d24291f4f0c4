"""The one table of remedies: what each needs, and what goes together."""

import pytest

from render.matcher.d400_preset import D400_PRESETS, load_preset
from studies.advise.factors import REMEDY_FACTORS, LightNeed, Remedy, go_together, remedies_for, set_up_with
from tests.studies.advise.made_up import base, remedy

ALL = [
    pytest.param(Remedy(factor, level), id=f"{factor.name}: {level.name}")
    for factor in REMEDY_FACTORS
    for level in factor.levels
]


@pytest.mark.parametrize("one", ALL)
def test_only_what_is_said_to_need_new_light_has_another_light(one: Remedy):
    """A re-scored remedy is measured from the base's radiance, so what is rendered may not depend on it."""
    setup = one.level.change(base())
    looks = [look for look in (setup.first_look, setup.second_look) if look is not None]
    needs_new = any(look.light != base().light for look in looks)
    assert needs_new == (one.factor.need is LightNeed.NEW) or setup == base()


def test_a_level_that_the_camera_has_already_is_no_remedy():
    """150 mW and the Default preset are the D435i's own."""
    titles = [one.title for one in remedies_for(base())]
    assert "laser: 150 mW" not in titles
    assert "preset: default" not in titles
    assert "laser: 60 mW" in titles
    at_60 = remedy("laser", "60 mW").level.change(base())
    assert "laser: 150 mW" in [one.title for one in remedies_for(at_60)]


def test_sixty_settings_and_more_are_tried():
    """The camera as it is set counts as one."""
    assert 1 + len(remedies_for(base())) >= 60


def test_a_threshold_stands_on_top_of_a_preset_whatever_the_order():
    """High accuracy with RSM at 31 of 168: its other values are librealsense's for that preset."""
    pair = (remedy("RSM removal threshold", "0.18"), remedy("preset", "high_accuracy"))
    one, other = set_up_with(base(), pair), set_up_with(base(), pair[::-1])
    assert one == other
    found = load_preset(one.sensor.preset)
    wanted = D400_PRESETS["high_accuracy"] | {"param-rsmremovethreshold": 31 / 168}
    assert dict(found.values) == pytest.approx(wanted)
    assert found.settings.neighbour_least == 31


def test_what_sets_the_exposure_twice_does_not_go_together():
    """One exposure at a time; a laser goes with any."""
    fixed, pair, laser = (
        remedy("exposure", "2000 us at gain 16"),
        remedy("HDR pair", "8500 and 150 us"),
        remedy("laser", "60 mW"),
    )
    assert not go_together((fixed, pair))
    assert not go_together((laser, remedy("laser", "90 mW")))
    assert go_together((laser, fixed))
