"""Presets of the sensitivity study: what they ask, which cases that makes, and bad ones refused in one line."""

from pathlib import Path

import pytest

from materials.catalog import finish_names
from materials.input_error import InputError
from render.sensor import SensorSettings
from studies.sensitivity.cases import look_camera, look_scene, sweep_cases
from studies.sensitivity.plan import read_plan, write_plan
from studies.sensitivity.preset import SensitivityPreset, Sweep


def test_full_preset_covers_what_it_promises():
    """At least 12 metals x 6 finishes x 8 angles from 0 to 75 deg x 2 distances, every combination of them, on the
    plate; every coupon of another shape and every part; several lamps, powers and seeds."""
    cases = [case.config for case in sweep_cases(SensitivityPreset.named("full"))]
    plate = {(c.material, c.polar_deg, c.distance_m) for c in cases if c.subject == "plate" and c.seed == 0}
    named = {spec for spec, _, _ in plate if ":" in spec and spec.partition(":")[2] in finish_names()}
    complete = {
        spec for spec in named if len({(angle, distance) for name, angle, distance in plate if name == spec}) == 8 * 2
    }
    metals, finishes = ({spec.split(":")[k] for spec in complete} for k in (0, 1))
    assert (len(metals), len(finishes), len(complete)) == (12, 6, 72)
    assert {angle for _, angle, _ in plate} >= {0.0, 75.0}
    assert {c.subject for c in cases} == {"plate", "lying_cylinder", "ball", "inside_corner", "A1", "B1", "C1", "D1"}
    assert {light.lamps for c in cases for light in c.lights} >= {"workshop", "off"}
    assert len({light.laser_mw for c in cases for light in c.lights}) >= 3
    assert len({c.seed for c in cases if c.subject == "plate"}) >= 5


@pytest.mark.parametrize("name", ["quick", "full"])
def test_no_case_is_measured_twice(name: str):
    """Two sweeps that differ in nothing but their name would waste an hour."""
    digests = [case.config.digest for case in sweep_cases(SensitivityPreset.named(name))]
    assert len(set(digests)) == len(digests)


def test_twins_are_shared_by_all_metals():
    """A twin depends on geometry, light, pose and seed: the quick preset's six surfaces at four angles need four."""
    angles = [case.config for case in sweep_cases(SensitivityPreset.named("quick")) if case.sweep == "angles"]
    assert len(angles) == 24
    assert len({twin.digest for case in angles for twin in case.twins}) == 4


def test_width_of_the_dots_is_one_more_factor():
    """Off by default: as many cases as before, of the sensor's own dots. Three widths make three cases and three twins
    of each; the camera has the dots that the case names, the sensor's own where it names none, and all else as it
    was."""
    one = Sweep(name="a", materials=("primer",))
    assert one.dots_fwhm_px == (None,)
    three = one.model_copy(update={"dots_fwhm_px": (None, 3.7, 5.0)})
    sensor = SensorSettings(dot_fwhm_px=4.4)
    configs = [case.config for case in sweep_cases(SensitivityPreset(title="dots", sweeps=(three,), sensor=sensor))]
    assert len({c.digest for c in configs}) == len({t.digest for c in configs for t in c.twins}) == 3
    scene = look_scene(configs[0], "primer", configs[0].lights[0])
    cameras = [look_camera(c, scene, c.lights[0]).settings for c in configs]
    assert [settings.dot_fwhm_px for settings in cameras] == [4.4, 3.7, 5.0]
    assert len({settings.model_copy(update={"dot_fwhm_px": None}).model_dump_json() for settings in cameras}) == 1


def test_plan_comes_back(tmp_path: Path):
    """What a study was asked for is read back from its folder, case by case."""
    preset = SensitivityPreset.named("quick")
    cases = [(case.sweep, case.config.digest) for case in sweep_cases(preset)]
    written = write_plan(tmp_path, preset.title, preset, cases)
    assert read_plan(tmp_path) == written
    assert written.cases == tuple(cases)


BAD = {
    "metal": ("sweeps: [{name: a, metals: [stell], finishes: [mirror]}]", "stell"),
    "finish": ("sweeps: [{name: a, metals: [iron], finishes: [shiny]}]", "shiny"),
    "subject": ("sweeps: [{name: a, subjects: [sphere], materials: [primer]}]", "sphere"),
    "angle": ("sweeps: [{name: a, materials: [primer], polar_deg: [95]}]", "95"),
    "no finish": ("sweeps: [{name: a, metals: [iron]}]", "finishes"),
    "own coupon": ("sweeps: [{name: a, materials: [own]}]", "own"),
    "poses without recovery": ("sweeps: [{name: a, materials: [primer], hemisphere_poses: 9}]", "recovery"),
    "dots": ("sweeps: [{name: a, materials: [primer], dots_fwhm_px: [2]}]", "dots_fwhm_px"),
    "same name": ("sweeps: [{name: a, materials: [primer]}, {name: a, materials: [rubber]}]", "two sweeps"),
    "nothing": ("sweeps: []", "sweeps"),
}


@pytest.mark.parametrize(("text", "word"), BAD.values(), ids=BAD)
def test_bad_preset_is_refused_in_one_line(tmp_path: Path, text: str, word: str):
    """The line names the file and what in it is wrong."""
    file = tmp_path / "mine.yaml"
    file.write_text(f"title: mine\n{text}\n")
    with pytest.raises(InputError) as refused:
        SensitivityPreset.named(str(file))
    assert str(file) in str(refused.value)
    assert word in str(refused.value)
    assert "\n" not in str(refused.value)


def test_unknown_preset_is_refused():
    """A name that is neither ours nor a file."""
    with pytest.raises(InputError, match="quick"):
        SensitivityPreset.named("quik")
