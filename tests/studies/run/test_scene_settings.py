"""Settings of a subject: a preset file counts by its content, and the mount alone says how the camera is turned."""

import json

import pytest

from franbv.parameters import Parameters
from materials.input_error import InputError
from render.sensor import SensorSettings
from studies.base.case_folder import case_digest
from studies.run.reconstruct import ReconstructSettings, resolved_run
from studies.run.scene_settings import SubjectSettings, build_subject, mounted, resolved


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
