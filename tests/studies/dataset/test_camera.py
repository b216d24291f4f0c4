"""The user's camera in a dataset: preset by content, model and mount in every pose, and a check that knows of them."""

import json
from pathlib import Path

import numpy as np
import pytest

from materials.input_error import InputError
from studies.base.config import read_yaml, validated
from studies.cli.main import main
from studies.dataset.config import DatasetConfig, load_dataset_config
from studies.dataset.draw.draw import draw_scene
from studies.dataset.draw.objects import object_pool
from studies.dataset.make.manifest import dataset_digest


def written(path: Path, small_config: Path, **camera) -> Path:
    """The small configuration with this camera."""
    content = read_yaml(small_config)
    content["camera"] |= camera
    path.write_text(json.dumps(content))  # JSON is YAML
    return path


def test_a_preset_file_counts_by_its_content(tmp_path, small_config):
    """Beside the configuration, under another name, with a laser that a dataset draws itself: the same dataset."""
    (tmp_path / "a.json").write_text(json.dumps({"param-secondpeakdelta": 500}))
    (tmp_path / "b.json").write_text(json.dumps({"controls-laserpower": 30, "param-secondpeakdelta": "500"}))
    configs = [written(tmp_path / f"{name}.yaml", small_config, preset=f"{name}.json") for name in "ab"]
    digests = [dataset_digest(load_dataset_config(str(path))) for path in configs]
    assert digests[0] == digests[1]
    plain = load_dataset_config(str(small_config))
    assert digests[0] != dataset_digest(plain)
    assert plain.camera.sensor("424x240").preset == "default"


def test_depth_units_of_a_preset_are_refused(tmp_path, small_config):
    """A dataset's depth is in whole millimetres."""
    (tmp_path / "a.json").write_text(json.dumps({"param-depthunits": 100}))
    with pytest.raises(InputError, match="depth units are 100 um"):
        load_dataset_config(str(written(tmp_path / "a.yaml", small_config, preset="a.json")))


def test_every_view_hangs_as_the_mount_has_it(small_config):
    """At 90 deg and no drawn turn, the same places are looked at with the image's x axis where its y axis was; with
    drawn turns, their record is 90 deg more."""
    content, draws = read_yaml(small_config), {}
    pool = object_pool(load_dataset_config(str(small_config)))
    for mount in (0.0, 90.0):
        for spread in (0.0, 15.0):
            content["camera"]["roll_deg"], content["poses"]["roll_deg"] = mount, spread
            config = validated(DatasetConfig, content, "test")
            draws[mount, spread] = draw_scene(config, pool, 0).views
    for upright, on_end in zip(draws[0.0, 0.0], draws[90.0, 0.0], strict=True):
        T, R = np.array(upright.T_world_cam), np.array(on_end.T_world_cam)
        np.testing.assert_allclose(R[:3, 3], T[:3, 3])
        np.testing.assert_allclose(R[:3, 0], T[:3, 1], atol=1e-12)
        np.testing.assert_allclose(R[:3, 2], T[:3, 2], atol=1e-12)
    for upright, on_end in zip(draws[0.0, 15.0], draws[90.0, 15.0], strict=True):
        assert on_end.roll_deg == pytest.approx(upright.roll_deg + 90)
        assert abs(upright.roll_deg) <= 15


def test_on_end_the_camera_needs_more_room_above_the_table(small_config):
    """0.3 m away and 15 deg high, aimed 30 mm too low, the left imager is 48 mm up: enough for half a housing's height
    of 12.5 mm, not for the 62.5 mm that hang below it on end."""
    content = read_yaml(small_config)
    content["poses"]["elevation_deg"] = [15, 70]
    validated(DatasetConfig, content, "test")
    content["camera"]["roll_deg"] = 90
    with pytest.raises(InputError, match="the camera is in the table"):
        validated(DatasetConfig, content, "test")


def test_an_input_in_the_dataset_s_folder_is_refused(tmp_path, small_config, capsys):
    """Its files are written, renewed and removed, so a configuration there is refused and stays."""
    (tmp_path / "set").mkdir()
    path = written(tmp_path / "set" / "own.yaml", small_config)
    assert main(["dataset", "make", str(path), str(tmp_path / "set")]) == 2
    assert "move it out of there" in capsys.readouterr().err
    assert path.exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    "camera",
    [
        {"model": "d415", "profiles": {"424x240": 1}, "roll_deg": 90.0},
        {"profiles": {"640x480": 1}, "preset": "shifted.json"},
    ],
)
def test_what_is_made_passes_the_check(tmp_path, small_config, capsys, camera):
    """Another model on end, and a crop with a shifted search: made, and every file is found to be what it should."""
    (tmp_path / "shifted.json").write_text(json.dumps({"param-disparityshift": 30, "param-secondpeakdelta": 647}))
    config = written(tmp_path / "own.yaml", small_config, **camera)
    assert main(["dataset", "make", str(config), str(tmp_path / "set"), "--views", "2", "--workers", "1"]) == 0
    assert main(["dataset", "check", str(tmp_path / "set")]) == 0, capsys.readouterr()
