"""Settings of a subject: a preset file counts by its content, and the mount alone says how the camera is turned."""

import json

import pytest
import trimesh

from franbv.parameters import Parameters
from materials.bands import in_band
from materials.input_error import InputError
from materials.lights import Band
from render.sensor import SensorSettings
from studies.base.case_folder import case_digest
from studies.run.reconstruct import ReconstructSettings, resolved_run
from studies.run.scene_settings import SubjectSettings, build_subject, mounted, on_bench, resolved


def subject(preset) -> SubjectSettings:
    """Part A before a camera with this preset."""
    return SubjectSettings(part="A", sensor=SensorSettings(preset=str(preset)))


def test_a_case_is_named_by_a_preset_s_content(tmp_path):
    """The same file elsewhere and under another name makes the same case, another content in its place another one."""
    (tmp_path / "other").mkdir()
    paths = [tmp_path / "one.json", tmp_path / "other" / "two.json"]
    for path in paths:
        path.write_text(json.dumps({"param-secondpeakdelta": 500, "controls-laserpower": 300}))
    digests = [case_digest("frame", resolved(subject(path))) for path in paths]
    assert digests[0] == digests[1]
    paths[0].write_text(json.dumps({"param-secondpeakdelta": 501, "controls-laserpower": 300}))
    assert case_digest("frame", resolved(subject(paths[0]))) != digests[0]
    paths[0].write_text(json.dumps({"param-secondpeakdelta": 500, "controls-laserpower": 299}))
    assert case_digest("frame", resolved(subject(paths[0]))) != digests[0]


def test_a_case_is_named_by_what_the_files_of_its_materials_hold(tmp_path):
    """A spectrum beside the material file decides the result as much as the file itself: with another content the case
    is another one. A file without others is named as before, by itself alone."""
    spectrum, materials = tmp_path / "paint.csv", tmp_path / "m.yaml"
    materials.write_text("materials: {paint: {kind: matte, reflectance: 0.4, source: s, spectrum: paint.csv}}")
    settings = SubjectSettings(part="plate", material=("paint",), materials_file=materials)
    digests = []
    for value in (0.3, 0.4):
        spectrum.write_text(f"400,{value}\n850,0.4\n")
        digests.append(case_digest("frame", resolved(settings)))
    assert digests[0] != digests[1]
    assert in_band(build_subject(settings).scene.bodies[0].material, Band.WHITE_LED).reflectance == pytest.approx(0.4)
    materials.write_text("materials: {paint: {kind: matte, reflectance: 0.4, source: s}}")
    assert set(resolved(settings).digests) == {"materials_file"}


def test_what_a_preset_says_in_vain_is_said(tmp_path):
    """Keys without a counterpart are a notice of the subject; a missing file is an input error."""
    path = tmp_path / "one.json"
    path.write_text(json.dumps({"param-secondpeakdelta": 500, "param-lambdacensus": 26}))
    assert [line.endswith("ignored: param-lambdacensus") for line in build_subject(subject(path)).notices] == [True]
    with pytest.raises(InputError, match="no such preset file"):
        build_subject(subject(tmp_path / "none.json"))


def test_the_planner_takes_its_roll_from_the_mount():
    """The settings of a run hold the sensor's roll twice, and a planner that is told another one is refused."""
    settings = ReconstructSettings(part="A", sensor=SensorSettings(roll_deg=90))
    assert resolved_run(settings).parameters.roll_deg == 90
    assert resolved_run(resolved_run(settings)) == resolved_run(settings)
    with pytest.raises(InputError, match="the sensor is turned by 0 deg"):
        mounted(Parameters(roll_deg=45), SensorSettings())


def test_the_bench_decides_what_the_settings_leave_open():
    """Lamps, plinth and roll are names and numbers in the resolved settings, and what was said explicitly stays."""
    workshop, paper = (resolved(SubjectSettings(part="A", bench=bench)) for bench in ("workshop", "paper"))
    assert (workshop.lamps, workshop.plinth, workshop.sensor.roll_deg) == ("workshop", None, 0.0)
    assert (paper.lamps, paper.plinth, paper.sensor.roll_deg) == ("task", "black", 90.0)
    said = SubjectSettings(
        part="A", bench="paper", lamps="hall", plinth="white", sensor=SensorSettings(roll_deg=0.0, profile="640x480")
    )
    assert on_bench(said) == said
    assert resolved(resolved(said)) == resolved(said)
    digests = {case_digest("frame", resolved(settings)) for settings in (workshop, paper, said)}
    assert len(digests) == 3


def test_the_paper_s_bench_turns_camera_and_planner():
    """A run on it has the camera on end in sensor and planner alike, as if the roll had been given."""
    run = resolved_run(ReconstructSettings(part="A", bench="paper"))
    assert (run.sensor.roll_deg, run.parameters.roll_deg) == (90.0, 90.0)
    given = ReconstructSettings(
        part="A", bench="paper", lamps="task", plinth="black", sensor=SensorSettings(roll_deg=90)
    )
    assert case_digest("reconstruct", resolved_run(given)) == case_digest("reconstruct", run)


def test_every_subject_stands_on_the_paper_s_plinth(tmp_path):
    """Parts, coupons and CAD files, on a plinth of the colour that is asked for."""
    mesh = tmp_path / "cube.stl"
    trimesh.creation.box((20, 20, 20)).export(mesh)
    steel = ("iron:ground",)
    for what in (
        {"part": "B"},
        {"part": "ball", "material": steel},
        {"mesh": mesh, "units": "mm", "material": steel},
    ):
        scene = build_subject(SubjectSettings(bench="paper", plinth="white", lamps="hall", **what)).scene
        under = next(body for body in scene.bodies if not body.is_part)
        assert (under.name, under.material.name) == ("plinth", "white_paint")
        assert "task lamp" not in [lamp.name for lamp in scene.lamps]


@pytest.mark.parametrize(
    ("wrong", "line"),
    [
        (
            {"plinth": "black"},
            r"^plinth black: the workshop's table has no plinth; leave it out, or add --bench paper$",
        ),
        ({"bench": "paper", "lamps": "workshop"}, r"^lamps workshop: the paper's bench has none; .*task"),
        ({"lamps": "task"}, r"^lamps task: there is no such preset; .*workshop"),
    ],
)
def test_what_a_bench_does_not_have_is_named(wrong, line):
    """One line with thing and mend."""
    with pytest.raises(InputError, match=line):
        build_subject(SubjectSettings(part="A", **wrong))
