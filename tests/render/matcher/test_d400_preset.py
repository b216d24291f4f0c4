"""Presets: the Default is the matcher's default, others keep their proportion to it, files say what they cannot set."""

import json

import pytest

from materials.input_error import InputError
from render.matcher.d4.settings import D4Settings
from render.matcher.d400_preset import D400_PRESETS, load_preset, preset_by_name, preset_from_file

DEFAULT_FILE = {
    "param-leftrightthreshold": "24",
    "param-secondpeakdelta": "325",
    "param-scanlinep1": "60",
    "param-scanlinep1onediscon": "105",
    "param-scanlinep1twodiscon": "70",
    "param-scanlinep2": "342",
    "param-scanlinep2onediscon": "190",
    "param-scanlinep2twodiscon": "130",
    "param-rsmdiffthreshold": "4",
    "param-rsmremovethreshold": "0.375",
    "param-usersm": "1",
    "param-disparityshift": "0",
    "param-depthunits": "1000",
    "param-lambdacensus": "26",
    "param-texturecountthresh": "0",
}
"""As the viewer exports the Default preset; 0.375 is 63 of 168."""


def write(path, content):
    """A preset file."""
    path.write_text(json.dumps(content))
    return path


def test_default_preset_is_the_default():
    """The settings were found for cameras that ran the Default preset, so it must not change them."""
    assert preset_by_name("Default").settings == D4Settings()


def test_default_file_is_the_default(tmp_path):
    """The viewer's export of the same preset says the same, and what has no counterpart is named."""
    preset = preset_from_file(write(tmp_path / "d.json", DEFAULT_FILE))
    assert preset.settings == D4Settings()
    assert preset.shift == 0
    assert preset.depth_unit == pytest.approx(1e-3)
    assert preset.ignored == ("param-lambdacensus", "param-texturecountthresh")


def test_values_keep_their_proportion(tmp_path):
    """Twice the Default's score difference and penalties, half its left-right threshold; numbers may be bare."""
    changed = {"param-secondpeakdelta": 650, "param-scanlinep2": 684, "param-leftrightthreshold": 12}
    preset = preset_from_file(write(tmp_path / "d.json", {"parameters": changed, "schema version": 1}))
    assert preset.settings.second_peak == pytest.approx(2 * D4Settings().second_peak)
    assert preset.settings.p2 == (2462, *D4Settings().p2[1:])
    assert preset.settings.left_right_px == D4Settings().left_right_px * 12 / 24


def test_shift_units_and_bypass(tmp_path):
    """Disparity shift is in pixels and depth units in micrometres; `usersm` 0 switches the neighbour count off."""
    content = {"param-disparityshift": "40", "param-zunits": "100", "param-usersm": "0"}
    preset = preset_from_file(write(tmp_path / "d.json", content))
    assert preset.shift == 40
    assert preset.depth_unit == pytest.approx(1e-4)
    assert preset.settings.neighbour_least == 0


@pytest.mark.parametrize("name", ["High Accuracy", "high-density", "MEDIUM_DENSITY", "hand"])
def test_names_as_the_viewer_writes_them(name):
    """Spelling of blanks, dashes and case is free."""
    assert preset_by_name(name).settings != D4Settings()


def test_costs_stay_within_16_bits():
    """Five paths of at most 803 + P2 must fit into 16 bits, for every preset and for the largest value of a file."""
    standard, default = D4Settings(), D400_PRESETS["default"]
    largest = max(p * 1023 / default[key] for p, key in zip(standard.p2, list(default)[-3:], strict=True))
    assert 5 * (803 + largest) < 2**15
    assert all(5 * (803 + max(preset_by_name(name).settings.p2)) < 2**15 for name in D400_PRESETS)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({"param-secondpeakdelta": "many"}, "param-secondpeakdelta"),
        ({"param-secondpeakdelta": -1}, "from 0 to 1023"),
        ({"param-leftrightthreshold": None}, "param-leftrightthreshold"),
        ({"param-disparityshift": "nan"}, "from 0 to 512"),
        ([1, 2], "no parameters"),
    ],
)
def test_bad_values_are_named(tmp_path, content, words):
    """File, key and range, in one line."""
    path = write(tmp_path / "bad.json", content)
    with pytest.raises(InputError, match=words) as error:
        preset_from_file(path)
    assert "bad.json" in str(error.value)


def test_bad_files_and_names(tmp_path):
    """What is missing, not JSON, or unknown is said with the mend."""
    with pytest.raises(InputError, match="no such preset file"):
        preset_from_file(tmp_path / "none.json")
    (tmp_path / "text.json").write_text("{")
    with pytest.raises(InputError, match="export it from the viewer"):
        preset_from_file(tmp_path / "text.json")
    with pytest.raises(InputError, match="did you mean high_density"):
        preset_by_name("high densty")


@pytest.mark.parametrize(
    "content",
    [
        {"parameters": {"Depth Units": 0.00025, "Laser Power": 91}},
        {"presets": [{"name": "mine"}], "parameters": {}},
        {},
    ],
)
def test_files_without_a_known_key_are_refused(tmp_path, content):
    """An L500's export, say, is no preset of a D400: nothing of it would count, however deep one looks."""
    with pytest.raises(InputError, match="no key is known"):
        preset_from_file(write(tmp_path / "l500.json", content))


def test_values_are_found_inside_other_objects(tmp_path):
    """One object with known keys counts wherever it is; of two nobody knows which is meant."""
    inner = {"param-secondpeakdelta": "647"}
    assert preset_from_file(write(tmp_path / "w.json", {"presets": [inner]})).settings.second_peak == pytest.approx(
        D4Settings().second_peak * 647 / 325
    )
    with pytest.raises(InputError, match="holds 2 objects with parameters"):
        preset_from_file(write(tmp_path / "w.json", {"presets": [inner, inner]}))


def test_text_without_an_end_is_no_preset(tmp_path):
    """Nesting beyond what a parser follows is said, not raised."""
    (tmp_path / "deep.json").write_text("[" * 100_000)
    with pytest.raises(InputError, match="cannot be read as a preset file"):
        preset_from_file(tmp_path / "deep.json")


def test_matcher_text_says_the_same_again(tmp_path):
    """The matcher's part of a file, as text, gives the same matcher."""
    preset = preset_from_file(write(tmp_path / "d.json", DEFAULT_FILE | {"controls-laserpower": 90}))
    again = load_preset(preset.matcher_text)
    assert again.settings == preset.settings
    assert "laser" not in preset.matcher_text
    assert load_preset(preset_by_name("hand").matcher_text) == preset_by_name("hand")


def test_a_whole_file_as_text_says_the_same_again(tmp_path):
    """Laser, exposure and all; a preset with a name is its name."""
    preset = preset_from_file(write(tmp_path / "d.json", DEFAULT_FILE | {"controls-laserpower": 90}))
    again = load_preset(preset.text)
    assert (again.settings, again.values, again.text) == (preset.settings, preset.values, preset.text)
    assert again.values["controls-laserpower"] == 90
    assert preset_by_name("hand").text == "hand"
