"""Materials by name, and the one line that says what is wrong with a name."""

import pytest

from materials.catalog import finish_names, material, material_names, matte_twin, metal_names
from materials.finishes import FINISHES
from materials.input_error import InputError
from materials.material import Matte, Measured, RoughConductor, RoughPlastic
from materials.non_metals import NON_METALS
from materials.optical_constants import METALS


@pytest.mark.parametrize("metal", METALS)
@pytest.mark.parametrize("finish", FINISHES)
def test_every_metal_takes_every_finish_that_it_can_have(metal, finish):
    """The name resolves to the constants of the metal and the roughness of the finish; gold alone cannot oxidise."""
    if finish not in finish_names(metal):
        with pytest.raises(InputError, match="oxide"):
            material(f"{metal}:{finish}")
        return
    found = material(f"{metal}:{finish}")
    row = FINISHES[finish]
    assert isinstance(found, RoughConductor)
    assert (found.n, found.k) == (METALS[metal].n, METALS[metal].k)
    assert (found.alpha_u, found.alpha_v, found.oxide_share) == (row.alpha_u, row.alpha_v, row.oxide_share)
    assert (found.oxide_reflectance > 0) == (finish == "oxidised")


def test_roughness_can_be_given_by_hand():
    """One number is the same in all directions, two are along and across the lay."""
    one = material("stainless_austenitic:polished@alpha=0.07")
    two = material("brass:brushed@alpha=0.05,0.2")
    assert isinstance(one, RoughConductor)
    assert isinstance(two, RoughConductor)
    assert (one.alpha_u, one.alpha_v) == (0.07, 0.07)
    assert (two.alpha_u, two.alpha_v) == (0.05, 0.2)
    assert one.name == "stainless_austenitic:polished@alpha=0.07"


@pytest.mark.parametrize(
    ("spec", "thing", "mend"),
    [
        ("steal:polished", "unknown material", "known: stainless_austenitic"),
        ("aluminum:polished", "unknown material", "did you mean aluminium"),
        ("iron:polishd", "unknown finish polishd", "did you mean polished"),
        ("iron:shiny", "unknown finish shiny", "known: mirror"),
        ("iron", "a metal needs a finish", "write iron:polished"),
        ("iron:", "a metal needs a finish", "write iron:polished"),
        ("rubber:polished", "rubber is no metal", "write rubber"),
        ("rubber@alpha=0.1", "rubber is no metal", "write rubber"),
        ("iron:polished@alpha=-0.1", "alpha_u is -0.1", "from 0.001 to 1"),
        ("iron:polished@alpha=0", "alpha_u is 0", "from 0.001 to 1"),
        ("iron:polished@alpha=1.5", "alpha_u is 1.5", "from 0.001 to 1"),
        ("iron:polished@alpha=nan", "alpha_u is nan", "from 0.001 to 1"),
        ("iron:brushed@alpha=0.1,2", "alpha_v is 2", "from 0.001 to 1"),
        ("iron:polished@alpha=rough", "cannot read the roughness", "write @alpha=0.07"),
        ("iron:polished@alpha=0.1,0.2,0.3", "cannot read the roughness", "write @alpha=0.07"),
        ("iron:polished@roughness=0.1", "cannot read the roughness", "write @alpha=0.07"),
        ("iron:polished@", "cannot read the roughness", "write @alpha=0.07"),
        ("", "unknown material", "known:"),
    ],
)
def test_a_bad_name_is_one_line_with_thing_and_mend(spec, thing, mend):
    """The command line prints the message as it is and exits with 2."""
    with pytest.raises(InputError) as raised:
        material(spec)
    message = str(raised.value)
    assert message.startswith(spec.partition(":")[0])
    assert thing in message
    assert mend in message
    assert "\n" not in message


def test_non_metals_come_by_name_with_their_source():
    """Each says where its reflectance comes from, or that it is a choice."""
    for name, row in NON_METALS.items():
        assert material(name) is row.material
        assert row.material.name == name
        assert any(word in row.source for word in ("USGS", "SLUM", "SICK", "choice"))


def test_black_plastic_with_carbon_black_is_darker_than_with_dyes():
    """Dyes are clear at 850 nm, carbon black is not: the trap that colours seen by eye lay."""
    carbon, dyed = material("black_plastic"), material("dyed_black_plastic")
    assert isinstance(carbon, RoughPlastic)
    assert isinstance(dyed, RoughPlastic)
    assert carbon.reflectance < dyed.reflectance / 5


def test_all_shiny_materials_share_one_matte_twin(tmp_path):
    """One twin rendering must serve every metal of a study; what is diffuse already has nothing to lose."""
    shiny = [material("iron:mirror"), material("gold:brushed"), material("black_plastic"), Measured("m", tmp_path)]
    twins = {matte_twin(one) for one in shiny}
    assert len(twins) == 1
    assert isinstance(twins.pop(), Matte)
    paint = material("dark_paint")
    assert matte_twin(paint) is paint


def test_the_lists_for_the_command_line_hold_what_can_be_named():
    """Every listed name resolves."""
    for metal in metal_names():
        for finish in finish_names(metal):
            material(f"{metal}:{finish}")
    for name in set(material_names()) - set(metal_names()):
        material(name)
    assert finish_names() == tuple(FINISHES)
    assert "oxidised" not in finish_names("gold")


@pytest.mark.parametrize(
    ("make", "fault"),
    [
        (lambda: RoughConductor("x", 0.0, 3.0, 0.1, 0.1), "n is 0"),
        (lambda: RoughConductor("x", 2.0, float("inf"), 0.1, 0.1), "k is inf"),
        (lambda: RoughConductor("x", 2.0, 3.0, 0.1, 0.1, oxide_share=1.2), "oxide_share is 1.2"),
        (lambda: RoughConductor("x", 2.0, 3.0, 0.1, 0.1, 0.5, -0.1), "oxide_reflectance is -0.1"),
        (lambda: RoughPlastic("x", 0.9, 0.1, 0.5), "n is 0.9"),
        (lambda: RoughPlastic("x", 1.5, 0.1, 1.5), "reflectance is 1.5"),
        (lambda: Matte("x", 1.01), "reflectance is 1.01"),
    ],
)
def test_no_invalid_material_can_be_made(make, fault):
    """The check sits in the material, so that no way around the catalogue leads past it."""
    with pytest.raises(InputError, match=f"^x: {fault}; give a number from"):
        make()
