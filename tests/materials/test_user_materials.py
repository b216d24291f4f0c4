"""Materials from a YAML file: what can be written, and the one line for what cannot."""

import numpy as np
import pytest

from materials.bands import in_band
from materials.catalog import finish_names, material, material_names, metal_names
from materials.coat import seen_reflectance
from materials.input_error import InputError
from materials.lights import LAMP_BANDS, SPECTRUM_NM, Band, electron_weights
from materials.material import Matte, Measured, RoughConductor, RoughPlastic
from materials.user_entries import UserMatte
from materials.user_materials import load_user_materials, named_files
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


def test_a_user_may_say_what_the_lamps_light_finds(tmp_path):
    """n, k and reflectances under a lamp stand in the material; a lamp that is not named counts as 850 nm does. An
    entry without lamps dumps as it did before there were any, so that names by content stay."""
    path = tmp_path / "m.yaml"
    path.write_text("""
materials:
  sheet:
    kind: metal
    n: 2.9
    k: 4.4
    valid_nm: [400, 1000]
    source: s
    oxide_reflectance: 0.2
    lamps: {white_led: [2.2, 3.8]}
    oxide_lamps: {halogen: 0.15}
  cover: {kind: plastic, n: 1.5, alpha: 0.1, reflectance: 0.3, source: s, lamps: {white_led: 0.04, halogen: 0.2}}
  floor: {kind: matte, reflectance: 0.4, source: s, lamps: {halogen: 0.35}}
""")
    user = load_user_materials(path)
    sheet = material("sheet:oxidised", user)
    led, halogen = in_band(sheet, Band.WHITE_LED), in_band(sheet, Band.HALOGEN)
    assert isinstance(led, RoughConductor)
    assert isinstance(halogen, RoughConductor)
    assert (led.n, led.k, led.oxide_reflectance) == (2.2, 3.8, 0.2)
    assert (halogen.n, halogen.k, halogen.oxide_reflectance) == (2.9, 4.4, 0.15)
    cover = in_band(material("cover", user), Band.WHITE_LED)
    assert isinstance(cover, RoughPlastic)
    assert seen_reflectance(1.5, cover.reflectance) == pytest.approx(0.04)
    assert in_band(material("floor", user), Band.HALOGEN) == Matte("floor", 0.35)
    assert in_band(material("floor", user), Band.WHITE_LED).reflectance == 0.4  # pyright: ignore
    plain = UserMatte(kind="matte", reflectance=0.4, source="s")
    assert plain.model_dump() == {"source": "s", "kind": "matte", "reflectance": 0.4}


def test_a_spectrum_gives_the_numbers_under_lamps(tmp_path):
    """A step at 600 nm from 0.1 to 0.5: the mean is 0.1 and 0.4 times the share of electrons beyond. A metal of one
    colour keeps its n, k. The numbers stand in the entry, so that nothing depends on the file any more."""
    (tmp_path / "step.csv").write_text("nm,R\n400,0.1\n599.5,0.1\n600.5,0.5\n850,0.5\n")
    (tmp_path / "steel.txt").write_text("# nm n k\n380 2.9 4.4\n1100\t2.9; 4.4\n")
    path = tmp_path / "m.yaml"
    path.write_text("""
materials:
  paint: {kind: matte, reflectance: 0.5, source: s, spectrum: step.csv}
  sheet: {kind: metal, n: 2.9, k: 4.4, valid_nm: [400, 1000], source: s, spectrum: steel.txt}
""")
    assert named_files(path) == {"paint": tmp_path / "step.csv", "sheet": tmp_path / "steel.txt"}
    user = load_user_materials(path)
    for band in LAMP_BANDS:
        beyond = float(np.sum(electron_weights(band)[SPECTRUM_NM > 600.0]))
        at_step = float(electron_weights(band)[SPECTRUM_NM == 600.0][0])
        paint, sheet = in_band(material("paint", user), band), in_band(material("sheet:polished", user), band)
        assert isinstance(paint, Matte)
        assert paint.reflectance == pytest.approx(0.1 + 0.4 * (beyond + at_step / 2), abs=1e-6)
        assert isinstance(sheet, RoughConductor)
        assert (sheet.n, sheet.k) == pytest.approx((2.9, 4.4), rel=1e-6)
    assert user.materials["paint"].model_dump(mode="json").keys() == {"source", "kind", "reflectance", "lamps"}


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (None, "s.csv: cannot be read"),
        ("", "s.csv: give at least two lines of finite numbers with rising wavelengths"),
        ("400,0.1\n", "give at least two lines"),
        ("850,0.1\n400,0.1\n", "give at least two lines of finite numbers with rising wavelengths"),
        ("400,nan\n850,0.1\n", "give at least two lines of finite numbers"),
        ("nm,R\nnm,R\n400,0.1\n850,0.1\n", "line 2 does not hold wavelength and reflectance; mend it there"),
        ("400,0.1\n600,0.1,0.2\n850,0.1\n", "line 2 does not hold wavelength and reflectance"),
        ("0.4,0.1\n0.85,0.1\n", "its wavelengths end at 0.85; give them in nm, not um"),
        ("500,0.1\n850,0.1\n", "covers 500 to 850 nm; a spectrum must cover 400 to 850 nm"),
        ("400,10\n850,20\n", "a: reflectance under white_led is 1"),
        (b"\xff\xfe\x00", "s.csv: is no text; give a table of wavelength and reflectance"),
    ],
)
def test_bad_spectra_are_named_with_a_mend(tmp_path, content, fault):
    """One line with the material file, the table and what to do; a reflectance in percent is out of range."""
    if content is not None:
        (tmp_path / "s.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    path = tmp_path / "m.yaml"
    path.write_text("materials: {a: {kind: matte, reflectance: 0.4, source: s, spectrum: s.csv}}")
    with pytest.raises(InputError) as raised:
        load_user_materials(path)
    assert fault in str(raised.value)
    assert str(raised.value).startswith(str(path))
    assert "\n" not in str(raised.value)


MATTE = "kind: matte, reflectance: 0.4, source: s"
METAL = "kind: metal, n: 2, k: 3, valid_nm: [800, 900], source: s"


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (
            f"materials: {{a: {{{MATTE}, colour: red}}}}",
            "materials.a.colour: unknown key; known: source, kind, reflectance, lamps, spectrum",
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
        (
            f"materials: {{a: {{{MATTE}, lamps: {{led: 0.3}}}}}}",
            "materials.a.lamps.led: unknown key; known: white_led, halogen",
        ),
        (
            f"materials: {{a: {{{MATTE}, lamps: 0.3}}}}",
            "materials.a.lamps: names no lamps; write lamps: {white_led: ...}",
        ),
        (
            f"materials: {{a: {{{MATTE}, lamps: {{halogen: 1.3}}}}}}",
            "a: reflectance under halogen is 1.3; give a number",
        ),
        (
            f"materials: {{a: {{{METAL}, lamps: {{halogen: 1.3}}}}}}",
            "materials.a.lamps.halogen: input should be a valid tuple",
        ),
        (f"materials: {{a: {{{METAL}, lamps: {{halogen: [1.3]}}}}}}", "materials.a.lamps.halogen.1: missing; add it"),
        (
            f"materials: {{a: {{{METAL}, lamps: {{halogen: [0, 3]}}}}}}",
            "a: n under halogen is 0; give a number from 0.01",
        ),
        (
            f"materials: {{a: {{{METAL}, oxide_lamps: {{white_led: 2}}}}}}",
            "a: oxide_reflectance under white_led is 2; give",
        ),
        (
            f"materials: {{a: {{{MATTE}, lamps: {{halogen: 0.3}}, spectrum: s.csv}}}}",
            "a: has both lamps and spectrum; leave one",
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
