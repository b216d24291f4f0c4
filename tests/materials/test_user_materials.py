"""Materials from a YAML file: what can be written, and the one line for what cannot."""

import numpy as np
import pytest

from materials.catalog import finish_names, material, material_names, metal_names
from materials.coat import seen_reflectance
from materials.input_error import InputError
from materials.material import Matte, Measured, RoughConductor, RoughPlastic
from materials.user_materials import load_user_materials
from tests.materials.rgl_file import spectral_measurement, write_tensor_file

GOOD = """
materials:
  my_steel:
    kind: metal
    n: 2.91
    k: 4.42
    valid_nm: [400, 1000]
    source: ellipsometry
    oxide_reflectance: 0.2
  my_mirror: {kind: metal, n: 0.05, k: 5.8, valid_nm: [400, 700], source: visible only}
  my_cover: {kind: plastic, n: 1.55, alpha: 0.1, reflectance: 0.3, source: sphere}
  my_floor: {kind: matte, reflectance: 0.4, source: grey card}
  my_chrome: {kind: measured, file: chrome.bsdf, source: own measurement}
"""


@pytest.fixture
def user(tmp_path):
    """The materials of a good file."""
    write_tensor_file(tmp_path / "chrome.bsdf", spectral_measurement(np.linspace(360, 1000, 9)))
    path = tmp_path / "materials.yaml"
    path.write_text(GOOD)
    return load_user_materials(path)


def test_metals_of_the_user_take_every_finish(user):
    """They stand beside the built-in ones, with their own constants and oxide."""
    found = material("my_steel:brushed@alpha=0.05,0.2", user)
    assert found == RoughConductor("my_steel:brushed@alpha=0.05,0.2", 2.91, 4.42, 0.05, 0.2)
    rusty = material("my_steel:oxidised", user)
    assert isinstance(rusty, RoughConductor)
    assert (rusty.oxide_share, rusty.oxide_reflectance) == (0.5, 0.2)
    assert "my_steel" in metal_names(user)
    assert "oxidised" in finish_names("my_steel")


def test_other_materials_come_by_name(user, tmp_path):
    """A plastic is given by what is seen of it from outside; the base under the coat follows (Saunderson)."""
    cover = material("my_cover", user)
    assert isinstance(cover, RoughPlastic)
    assert (cover.n, cover.alpha) == (1.55, 0.1)
    assert seen_reflectance(1.55, cover.reflectance) == pytest.approx(0.3)
    assert material("my_floor", user) == Matte("my_floor", 0.4)
    assert material("my_chrome", user) == Measured("my_chrome", tmp_path / "chrome.bsdf")
    assert set(material_names(user)) >= {"my_steel", "my_cover", "my_floor", "my_chrome", "iron", "rubber"}


def test_a_metal_that_was_not_measured_at_850_nm_raises_when_it_is_used(user):
    """Constants of the visible say nothing about the projector's light."""
    with pytest.raises(InputError, match="my_mirror: its n, k hold from 400 to 700 nm, the projector emits 850 nm"):
        material("my_mirror:polished", user)


def test_an_oxide_must_be_given_to_be_used(tmp_path):
    """No albedo is invented for a metal that the table does not know."""
    path = tmp_path / "m.yaml"
    path.write_text("materials: {a: {kind: metal, n: 2, k: 3, valid_nm: [800, 900], source: s}}")
    with pytest.raises(InputError, match="gives no oxide_reflectance for a; add it"):
        material("a:oxidised", load_user_materials(path))


MATTE = "kind: matte, reflectance: 0.4, source: s"
METAL = "kind: metal, n: 2, k: 3, valid_nm: [800, 900], source: s"


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (
            f"materials: {{a: {{{MATTE}, colour: red}}}}",
            "materials.a.colour: unknown key; known: source, kind, reflectance",
        ),
        (f"material: {{a: {{{MATTE}}}}}", "material: unknown key; did you mean materials?"),
        ("materials: {a: {kind: matte, source: s}}", "materials.a.reflectance: missing; add it"),
        ("materials: {a: {kind: matte, reflectance: 0.4}}", "materials.a.source: missing"),
        ("materials: {a: {reflectance: 0.4, source: s}}", "materials.a: has no kind; add kind"),
        ("materials: {a: {kind: velvet, source: s}}", "materials.a: unknown kind; use metal"),
        (
            "materials: {a: {kind: matte, reflectance: grey, source: s}}",
            "materials.a.reflectance: input should be a valid",
        ),
        (
            "materials: {a: {kind: matte, reflectance: 1.4, source: s}}",
            "a: reflectance is 1.4; give a number from 0 to 1",
        ),
        (f"materials: {{a: {{{METAL.replace('n: 2', 'n: -2')}}}}}", "a: n is -2; give a number from 0.01"),
        (
            "materials: {a: {kind: plastic, n: 0.5, alpha: 0.1, reflectance: 0.4, source: s}}",
            "a: n is 0.5; give a number",
        ),
        (f"materials: {{iron: {{{METAL}}}}}", "iron: a built-in material has this name; choose another"),
        (f"materials: {{'my:steel': {{{METAL}}}}}", "my:steel: bad material name; use lower-case"),
        ("materials: [a, b]", "materials: is no table of names; write materials"),
        ("- 1", "the file: is no table of names"),
        ("materials: {a: [}", "is not YAML"),
        ("materials: !!python/object/apply:os.getcwd []", "is not YAML"),
        ("materials: {a: {kind: measured, file: none.bsdf, source: s}}", "none.bsdf: cannot be read"),
    ],
)
def test_bad_files_are_named_with_key_and_mend(tmp_path, content, fault):
    """One line: the file, the key, what to do. Tags that would run code are refused as well (safe_load)."""
    path = tmp_path / "materials.yaml"
    path.write_text(content)
    with pytest.raises(InputError) as raised:
        load_user_materials(path)
    message = str(raised.value)
    assert fault in message
    assert message.startswith(str(tmp_path))
    assert "\n" not in message


def test_a_missing_file_is_named(tmp_path):
    """The operating system's reason, and the path."""
    with pytest.raises(InputError, match=r"none\.yaml: cannot be read"):
        load_user_materials(tmp_path / "none.yaml")


def test_an_empty_file_is_a_fault_not_a_crash(tmp_path):
    """YAML gives None for it."""
    path = tmp_path / "empty.yaml"
    path.write_text("")
    with pytest.raises(InputError, match="the file: is no table of names"):
        load_user_materials(path)
