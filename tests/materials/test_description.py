"""The list that the command line shows."""

import pytest

from materials.catalog import material_names
from materials.description import describe, describe_all
from materials.input_error import InputError
from materials.lights import Band
from materials.user_materials import UserMaterials


def test_a_metal_is_described_by_its_constants_and_both_sources():
    """R0 of iron at 850 nm is 0.57 by its n, k (Johnson and Christy 1974); a roughness by hand has no source."""
    iron = describe("iron:brushed@alpha=0.05,0.2")
    assert (iron.kind, iron.n, iron.k, iron.alpha_u, iron.alpha_v) == ("metal", 2.948, 3.459, 0.05, 0.2)
    assert iron.normal_reflectance == pytest.approx(0.572, abs=1e-3)
    assert "Johnson" in iron.source
    assert "given by hand" in iron.source
    assert "Ward" in describe("iron:ground").source
    assert iron.line().startswith(
        "iron:brushed@alpha=0.05,0.2  metal  n 2.948  k 3.459  R0 0.57  alpha 0.05 x 0.2  "
        "under white_led 0.52, halogen 0.55  (n, k:"
    )


def test_what_is_known_of_a_material_under_lamps_is_said_and_what_is_not_as_well():
    """Iron's mean reflectance over the database's table is 0.520 and 0.552 (`test_effective_constants`). A material of
    the user's that names no lamp counts as at 850 nm, and says so; a measured file has its own spectra."""
    iron = dict(describe("iron:polished").under_lamps)
    assert iron == {Band.WHITE_LED: pytest.approx(0.520, abs=1e-3), Band.HALOGEN: pytest.approx(0.552, abs=1e-3)}
    floor = {"kind": "matte", "reflectance": 0.4, "source": "s"}
    entries = {
        "plain": floor,
        "partly": floor | {"lamps": {"white_led": 0.3}},
        "chrome": {"kind": "measured", "file": "a.bsdf", "source": "own"},
    }
    user = UserMaterials.model_validate({"materials": entries})
    assert describe("plain", user).line() == "plain  matte  diffuse 0.4  under white_led, halogen as at 850 nm  (s)"
    partly = "partly  matte  diffuse 0.4  under white_led 0.3, under halogen as at 850 nm  (s)"
    assert describe("partly", user).line() == partly
    assert "850 nm" not in describe("chrome", user).line()


def test_under_lamps_a_plastic_is_described_as_it_is_seen():
    """Dyed black plastic is 0.038 under white LEDs as seen from outside: 0.03 and, by hand, 3 % of the LED's electrons
    beyond 720 nm at 0.27 more."""
    dyed = dict(describe("dyed_black_plastic").under_lamps)
    assert dyed[Band.WHITE_LED] == pytest.approx(0.03 + 0.03 * 0.27, abs=0.002)


def test_a_plastic_is_described_as_it_is_seen():
    """White PVC reflects 0.705 at 850 nm (USGS), whatever its base must be for that; its coat reflects 0.04."""
    white = describe("white_plastic")
    assert white.diffuse_reflectance == pytest.approx(0.705, abs=0.006)
    assert white.normal_reflectance == pytest.approx(0.04, abs=1e-9)


def test_half_of_an_oxidised_metal_is_oxide():
    """Diffuse light: the share of the oxide times its albedo."""
    assert describe("iron:oxidised").diffuse_reflectance == pytest.approx(0.5 * 0.06)


def test_every_material_is_listed_with_a_source_on_one_line():
    """The list has each name once, and no line without a source."""
    user = UserMaterials.model_validate(
        {"materials": {"mine": {"kind": "measured", "file": "a.bsdf", "source": "own"}}}
    )
    rows = describe_all(user)
    assert [row.name.partition(":")[0] for row in rows] == list(material_names(user))
    for row in rows:
        assert len(row.source) >= 3
        assert "\n" not in row.line()


def test_unknown_names_raise_as_in_the_catalogue():
    """One source of messages."""
    with pytest.raises(InputError, match="unknown material"):
        describe("unobtainium:polished")
