"""`franbv advise`: bad input in one line; a whole advice of a small render, taken up again and made anew."""

import json
from pathlib import Path

import numpy as np
import pytest

from materials.input_error import InputError
from render.d435i import SimulatedD435i
from studies.advise.camera_files import SENSOR_FILE, VIEWER_PRESET
from studies.advise.factors import LightNeed, remedies_for
from studies.advise.poses import pose_texts
from studies.advise.scoring import frames_of, measured_part
from studies.advise.settings import AdviseSettings, base_setup, checked_settings, subject_of
from studies.advise.stored_advice import ADVICE
from studies.advise.stored_light import LIGHT, LightStore, PoseLight
from studies.cli.main import main
from studies.run.scene_settings import build_subject

SMALL = ["--part", "plate", "--material", "aluminium:ground", "--sensor.profile", "424x240", "--seeds", "1"]
POSES = ["--pose", "20,60,0.3", "200,50,0.3"]


@pytest.mark.parametrize(
    ("flags", "words"),
    [
        (["--minutes", "0"], "--minutes 0: is no time"),
        (["--sensor.crop", "60", "40"], "--sensor.crop: remedies are scored over the whole image"),
        (["--pose", "0,40,0.3"], "give two or more, or --poses N"),
        (["--pose", "0,40,0.3", "0,-40,0.3"], "is under the table"),
        (["--part", "Q"], "part Q: there is none"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(
    flags: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """Exit status 2, before anything is rendered."""
    part = [] if "--part" in flags else SMALL[:4]
    assert main(["advise", *part, *flags, "--out", str(tmp_path / "out")]) == 2
    message = capsys.readouterr().err.strip()
    assert words in message
    assert "\n" not in message
    assert not (tmp_path / "out").exists()


def test_poses_of_a_smaller_number_are_the_first_of_a_larger_one():
    """So that what is rendered stays good."""
    few, many = (AdviseSettings(part="A", poses=n) for n in (3, 6))
    scene = build_subject(few).scene
    assert pose_texts(many, scene)[:3] == pose_texts(few, scene)
    assert len(set(pose_texts(many, scene))) == 6


def test_where_no_pose_is_free_the_distance_is_named():
    """Five metres from the part is outside the workshop, whatever the side."""
    settings = AdviseSettings(part="A", poses=3, distance=5.0)
    with pytest.raises(InputError, match="0 are free at 5 m"):
        pose_texts(settings, build_subject(settings).scene)


@pytest.mark.slow
def test_twenty_rescored_settings_are_what_a_new_rendering_gives(tmp_path: Path):
    """Bit for bit: a camera made with the setting from the start, and light rendered for it, against stored light."""
    settings = checked_settings(
        AdviseSettings(part="plate", material=("aluminium:ground",), pose=("20,60,0.3", "200,50,0.3"))
    )
    small = settings.model_copy(update={"sensor": settings.sensor.model_copy(update={"profile": "424x240"})})
    scene, base = build_subject(small).scene, base_setup(small)
    store = LightStore(tmp_path, subject_of(small), scene, small.pose, 0.0)
    stored = [one for one in remedies_for(base) if one.factor.need is LightNeed.STORED][::2]
    assert len(stored) >= 20
    light = store.light(base.light, 0)
    with pytest.raises(ValueError, match="other light"):
        store.camera(base.light).set_to(base.sensor.model_copy(update={"profile": "640x360"}), 0)
    for remedy in stored:
        setup = remedy.level.change(base)
        anew = SimulatedD435i(scene, setup.sensor, seed=3, known=store.camera(base.light).world)
        rendered = PoseLight(light.T_world_cam, anew.render(light.T_world_cam), light.seen)
        z16, infrared = frames_of(anew, rendered, setup)
        again, again_infrared = frames_of(store.camera(base.light).set_to(setup.sensor, 3), light, setup)
        np.testing.assert_array_equal(again, z16, err_msg=remedy.title)
        np.testing.assert_array_equal(again_infrared, infrared)
        assert measured_part(store, setup, 0, 3).outcome.shape == light.seen.depth.shape


@pytest.mark.slow
def test_an_advice_is_whole_and_the_same_command_goes_on_from_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A short time tries what is re-scored; a longer one goes on with new light and renders nothing twice."""
    command = ["advise", *SMALL, *POSES, "--out", str(tmp_path), "--json"]
    assert main([*command, "--minutes", "0.05"]) == 0
    first = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert first["settings"] >= 40
    assert first["untried"]
    for name in (ADVICE, VIEWER_PRESET, SENSOR_FILE, "report.html"):
        assert (tmp_path / name).is_file()
    rendered = {path: path.stat().st_mtime_ns for path in (tmp_path / LIGHT).glob("*.npz")}
    assert len(rendered) == 2 * 2  # two poses, as set and sprayed
    assert main([*command, "--minutes", "1.5"]) == 0
    second = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert second["settings"] > first["settings"]
    assert {path: path.stat().st_mtime_ns for path in rendered} == rendered
    assert first["base"] == second["base"]
    for one in second["remedies"]:
        assert one["right_share"] + one["false_share"] + one["hole_share"] == pytest.approx(1.0)
        assert one["lo"] <= one["right_share"] <= one["hi"]
    page = (tmp_path / "report.html").read_bytes()
    assert main(["report", str(tmp_path)]) == 0
    assert (tmp_path / "report.html").read_bytes() == page
