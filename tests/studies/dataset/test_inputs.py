"""What a dataset is made of: CAD and BSDF files are known by their content, and a folder of others is left alone."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

import studies.dataset
from materials.input_error import InputError
from scenes.primitives import sphere
from scenes.scene import Mesh
from studies.base.output_errors import FutileError
from studies.cli.main import main
from studies.dataset.check.command import pool_of
from studies.dataset.check.head import table_problems
from studies.dataset.config import DatasetConfig, load_dataset_config
from studies.dataset.draw.draw import draw_scene
from studies.dataset.draw.objects import object_pool
from studies.dataset.format.folders import compact_json
from studies.dataset.make import bop
from studies.dataset.make import command as make
from studies.dataset.make.manifest import dataset_digest, head, input_digests, measured_digests
from studies.dataset.make.scene_case import SceneTask, make_scene
from studies.work.workers import Failure
from tests.materials.rgl_file import spectral_measurement, write_tensor_file
from tests.studies.dataset.test_make import contents

PARTS = "parts: {A1: 1, C1: 1}"
ARRANGEMENT = "arrangement: {single: 0.3, pile: 0.7}"


def of_block(small_config: Path, folder: Path, size_mm: tuple[float, float, float]) -> DatasetConfig:
    """Piles of one CAD file, a block of this size."""
    trimesh.creation.box(size_mm).export(folder / "block.stl")
    path = folder / "block.yaml"
    cad = "parts: {}, cad: [{file: block.stl, units: mm, material: ['iron:milled']}]"
    path.write_text(small_config.read_text().replace(PARTS, cad).replace(ARRANGEMENT, "arrangement: {pile: 1}"))
    return load_dataset_config(str(path))


def test_a_changed_cad_file_is_loaded_again(small_config: Path, tmp_path: Path):
    """Though the process has loaded one of its name; and a scene of the dataset that was begun with the old one is
    refused."""
    config = of_block(small_config, tmp_path, (40, 30, 20))
    begun = input_digests(config, object_pool(config))
    assert list(begun) == ["block.stl"]
    trimesh.creation.box((80, 30, 20)).export(tmp_path / "block.stl")
    assert np.ptp(object_pool(config)[0].mesh.vertices, axis=0) == pytest.approx([0.08, 0.03, 0.02])
    task = SceneTask(tmp_path / "out", config, dataset_digest(config), 0, inputs=begun)
    with pytest.raises(FutileError, match=r"block\.stl: is not the file that .* was begun with"):
        make_scene(task)
    assert not (tmp_path / "out").exists()


def test_check_says_when_it_is_given_another_file(small_config: Path, tmp_path: Path):
    """Rather than that the dataset is wrong."""
    config, root = of_block(small_config, tmp_path, (40, 30, 20)), tmp_path / "out"
    root.mkdir()
    (root / "dataset.json").write_bytes(compact_json(head(config, object_pool(config), {})))
    assert pool_of(root, config) == object_pool(config)
    trimesh.creation.box((80, 30, 20)).export(tmp_path / "block.stl")
    with pytest.raises(InputError, match=r"block\.stl: is not the file that"):
        pool_of(root, config)


def test_a_dataset_that_cannot_be_read_is_left_to_the_check(small_config: Path, tmp_path: Path):
    """Without a readable `dataset.json` there is nothing to hold CAD files against; the check then names that file."""
    config, root = of_block(small_config, tmp_path, (40, 30, 20)), tmp_path / "out"
    root.mkdir()
    (root / "dataset.json").write_text("no table of names")
    assert pool_of(root, config) == object_pool(config)


@pytest.mark.parametrize("size_mm", [(900, 700, 5), (2, 2, 50)])
def test_what_no_pile_holds_lies_alone(small_config: Path, tmp_path: Path, size_mm: tuple[float, float, float]):
    """Wider than the table's map, or too thin to be sure that it stands: one object, the others counted as left out."""
    config = of_block(small_config, tmp_path, size_mm)
    draw = draw_scene(config, object_pool(config), 0)
    assert len(draw.objects) == 1
    assert draw.left_out >= 1


def test_more_bodies_than_can_be_told_apart_are_refused(
    small_config: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
):
    """Before anything is written, though such a scene may be drawn late or never."""
    monkeypatch.setattr("studies.dataset.draw.objects.FIRST_LAMP", 10)
    assert main(["dataset", "make", str(small_config), str(tmp_path / "out")]) == 2
    assert "lower objects.pile_parts" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_bsdf_file_is_not_looked_for_by_check(small_config: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The dataset knows its name and hash alone: checked from another folder it is sound, and nothing is opened there
    that is called the same."""
    write_tensor_file(tmp_path / "chrome.bsdf", spectral_measurement(np.linspace(360, 1000, 9)))
    path, user = tmp_path / "own.yaml", "\n  user: {chrome: {kind: measured, file: chrome.bsdf, source: own}}\nsurround"
    path.write_text(small_config.read_text().replace("\nsurround", user))
    config = load_dataset_config(str(path))
    pool = object_pool(config)
    top = json.loads(compact_json(head(config, pool, measured_digests(config))))
    assert list(input_digests(config, pool)) == ["chrome.bsdf"]
    monkeypatch.chdir(tmp_path.parent)
    assert list(table_problems(top, DatasetConfig.model_validate(top["config"]), pool)) == []


def test_a_folder_of_others_is_left_alone(small_config: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    """Another dataset in BOP's layout, with the names that ours has: exit status 2, and not a byte changes."""
    for name in ("README.md", "camera.json", "models/obj_000001.ply", "train/000000/rgb/000000.png", ".notes.tmp"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("theirs")
    before = contents(tmp_path)
    assert main(["dataset", "make", str(small_config), str(tmp_path)]) == 2
    assert "holds other files" in capsys.readouterr().err
    assert contents(tmp_path) == before


def test_a_lost_head_is_written_again(small_config: Path, dataset: Path):
    """Its scenes say that the folder is this dataset's."""
    before = contents(dataset)
    (dataset / "dataset.json").unlink()
    assert main(["dataset", "make", str(small_config), str(dataset)]) == 0
    assert contents(dataset) == before


def test_check_says_that_another_version_made_it(dataset: Path, capsys: pytest.CaptureFixture):
    """A difference may be the version's; said beside the problems."""
    manifest = dataset / "train/000000/manifest.json"
    told = json.loads(manifest.read_text())
    told["versions"]["numpy"] = "0.1"
    manifest.write_text(json.dumps(told))
    assert main(["dataset", "check", str(dataset)]) == 1
    assert "The dataset was made by numpy 0.1, not the " in capsys.readouterr().out


def test_a_scene_of_another_dataset_is_left_alone(small_config: Path, dataset: Path, capsys: pytest.CaptureFixture):
    """It is named, exit status 2, and not a byte changes."""
    manifest = dataset / "train/000001/manifest.json"
    manifest.write_text(manifest.read_text().replace(json.loads(manifest.read_text())["dataset"], "0" * 16))
    before = contents(dataset)
    assert main(["dataset", "make", str(small_config), str(dataset)]) == 2
    assert "train/000001: is a scene of another dataset; move it away" in capsys.readouterr().err
    assert contents(dataset) == before


def test_the_order_of_keys_does_not_matter(
    small_config: Path, small_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture
):
    """The same weights in another order are the same dataset."""
    path, text = tmp_path / "turned.yaml", small_config.read_text()
    assert "{polished: 1, milled: 1}" in text
    path.write_text(text.replace("{polished: 1, milled: 1}", "{milled: 1, polished: 1}"))
    assert main(["dataset", "make", str(path), str(small_dataset), "--json"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["made_now"] == 0


def test_a_full_disk_met_by_workers_is_bad_input(small_config: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Exit status 2, as where the command meets it; a scene that fails by itself is 1."""
    for futile, status in ((True, 2), (False, 1)):
        failure = Failure("scene 000000", "no more", futile)
        monkeypatch.setattr(make, "make_missing", lambda *_, failure=failure: ([failure], [0]))
        assert main(["dataset", "make", str(small_config), str(tmp_path / "out")]) == status


def test_workers_are_not_for_a_scheduler(small_config: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    """Said, instead of being ignored."""
    command = ["dataset", "make", str(small_config), str(tmp_path / "out"), "--scheduler", "tcp://127.0.0.1:1"]
    assert main([*command, "--workers", "2"]) == 2
    assert "--workers is for this machine" in capsys.readouterr().err


def test_a_linked_dataset_is_checked(small_dataset: Path, tmp_path: Path):
    """The link itself may be anywhere; what is in the folder may not be linked."""
    (tmp_path / "link").symlink_to(small_dataset)
    assert main(["dataset", "check", str(tmp_path / "link")]) == 0


def test_diameter_is_measured_in_blocks(monkeypatch: pytest.MonkeyPatch):
    """Of a box its diagonal, of a ball twice its radius to its facets' fineness, whatever the size of the blocks; a
    model of too many corners is refused in one line."""
    monkeypatch.setattr(bop, "BLOCK", 3)
    corners = np.array(np.meshgrid([0, 0.03], [0, 0.04], [0, 0.12])).reshape(3, -1).T
    assert bop.model_info(Mesh(corners, np.zeros((0, 3), int)))["diameter"] == pytest.approx(130)
    ball = sphere(0.05, 48)
    assert bop.model_info(ball)["diameter"] == pytest.approx(100, rel=1e-3)
    monkeypatch.setattr(bop, "MOST_CORNERS", 100)
    with pytest.raises(InputError, match="simplify it to 100 or fewer"):
        bop.model_info(ball)


def test_the_reader_says_what_is_wrong(dataset: Path, tmp_path: Path):
    """Decimated images have their own K; a linked layer and malformed text are refused in one line."""
    view = studies.dataset.open(dataset)[0]
    assert view.intrinsics_decimated[0, 0] == pytest.approx(view.intrinsics[0, 0] / 8)
    assert view.intrinsics_decimated[0, 2] == pytest.approx((view.intrinsics[0, 2] + 0.5) / 8 - 0.5)
    layer = dataset / "train/000000/depth"
    layer.rename(tmp_path / "elsewhere")
    layer.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(ValueError, match="is a link"):
        _ = view.depth
    (dataset / "train/000000/scene_camera.json").write_text("null")
    with pytest.raises(InputError, match="run `franbv dataset check"):
        studies.dataset.open(dataset)
