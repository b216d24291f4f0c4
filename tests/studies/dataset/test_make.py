"""`dataset make`: the same bytes whoever makes it and however often it is killed; bad input in one line."""

import errno
import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from studies.cli.main import main
from studies.dataset.config import load_dataset_config
from studies.dataset.draw.draw import draw_scene
from studies.dataset.draw.objects import object_pool
from studies.dataset.format import folders
from studies.dataset.format.scene_files import scene_fault
from studies.dataset.make import command as make
from studies.dataset.make.manifest import dataset_digest


def contents(root: Path) -> dict[str, bytes]:
    """Every file and its bytes."""
    return {path.relative_to(root).as_posix(): path.read_bytes() for path in root.rglob("*") if path.is_file()}


def test_the_same_command_finds_it_done(small_config: Path, small_dataset: Path, capsys: pytest.CaptureFixture):
    """Nothing is made and no byte changes."""
    before = contents(small_dataset)
    assert main(["dataset", "make", str(small_config), str(small_dataset), "--json"]) == 0
    figures = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert (figures["views"], figures["failed"], figures["made_now"]) == (4, 0, 0)
    assert contents(small_dataset) == before


@pytest.mark.parametrize(
    ("name", "words"),
    [("gray", "gray/000000.png is missing"), ("statistics.json", "statistics.json is missing"), ("manifest.json", "")],
)
def test_a_scene_that_lost_something_is_not_taken_for_whole(
    small_config: Path, small_dataset: Path, tmp_path: Path, name: str, words: str
):
    """A folder of images, a text, the manifest: the scene counts as missing, and the reason is named."""
    copy = Path(shutil.copytree(small_dataset, tmp_path / "copy"))
    lost = copy / "train/000001" / name
    shutil.rmtree(lost) if lost.is_dir() else lost.unlink()
    config = load_dataset_config(str(small_config))
    digest = dataset_digest(config)
    assert scene_fault(small_dataset / "train/000001", config, digest, 1) is None
    fault = scene_fault(copy / "train/000001", config, digest, 1)
    assert fault is not None
    assert words in fault


def test_a_scene_whose_manifest_lists_too_little_is_not_whole(small_config: Path, small_dataset: Path, tmp_path: Path):
    """Files gone before they were listed: the manifest agrees with what is left, the configuration does not."""
    copy = Path(shutil.copytree(small_dataset / "train/000000", tmp_path / "copy"))
    shutil.rmtree(copy / "gray")
    manifest = json.loads((copy / "manifest.json").read_text())
    manifest["files"] = {name: entry for name, entry in manifest["files"].items() if not name.startswith("gray/")}
    (copy / "manifest.json").write_text(json.dumps(manifest))
    config = load_dataset_config(str(small_config))
    assert scene_fault(copy, config, dataset_digest(config), 0) == "gray/000000.png is missing"


def test_a_writer_whose_folder_is_cleared_away_installs_nothing(tmp_path: Path):
    """Cleared in the middle of its files, as by a `make` that was started while a worker of the last one lives on."""
    (tmp_path / ".work").mkdir()

    def write() -> None:
        with folders.written_whole(tmp_path, tmp_path / "train/000000") as folder:
            for number in range(6):
                (folder / f"layer{number}").mkdir()
                (folder / f"layer{number}/000000.png").write_bytes(b"x")
                if number == 3:
                    folders.removed_at_once(tmp_path, folder)

    with pytest.raises(FileNotFoundError):
        write()
    assert not (tmp_path / "train/000000").exists()
    assert list((tmp_path / ".work").iterdir()) == []


def test_a_folder_that_is_no_scene_of_the_dataset_is_refused(
    small_config: Path, small_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture
):
    """It would be counted in index and card."""
    copy = Path(shutil.copytree(small_dataset, tmp_path / "copy"))
    shutil.copytree(copy / "train/000000", copy / "train/000007")
    assert main(["dataset", "make", str(small_config), str(copy)]) == 2
    assert "000007: is no scene of this dataset" in capsys.readouterr().err
    assert not (copy / ".work").exists()


def test_scenes_of_other_versions_are_not_added_to(
    small_config: Path, small_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture
):
    """A dataset half made with another numpy: exit status 2, both versions named, nothing changed."""
    copy = Path(shutil.copytree(small_dataset, tmp_path / "copy"))
    shutil.rmtree(copy / "train/000001")
    path = copy / "train/000000/manifest.json"
    manifest = json.loads(path.read_text())
    manifest["versions"]["numpy"] = "1.0"
    path.write_text(json.dumps(manifest))
    before = contents(copy)
    assert main(["dataset", "make", str(small_config), str(copy), "--workers", "1"]) == 2
    assert f"has numpy 1.0, not the {np.__version__} of this machine" in capsys.readouterr().err
    assert contents(copy) == before


def test_a_scene_is_made_again_to_the_byte(small_config: Path, small_dataset: Path, tmp_path: Path):
    """As after a kill between two scenes, with debris of a killed process lying about."""
    copy = Path(shutil.copytree(small_dataset, tmp_path / "copy"))
    shutil.rmtree(copy / "train/000001")
    for name in ("index.json", "README.md"):
        (copy / name).unlink()
    (copy / ".work/000001-host-123/gray").mkdir(parents=True)
    (copy / ".index.json.123.tmp").write_bytes(b"half")
    assert main(["dataset", "make", str(small_config), str(copy), "--workers", "1"]) == 0
    assert contents(copy) == contents(small_dataset)


@pytest.mark.slow
def test_two_workers_make_the_same_bytes(small_config: Path, small_dataset: Path, tmp_path: Path):
    """As one."""
    assert main(["dataset", "make", str(small_config), str(tmp_path / "two"), "--workers", "2"]) == 0
    assert contents(tmp_path / "two") == contents(small_dataset)


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # what Dask and its parts warn of is theirs
def test_dask_workers_make_the_same_bytes(small_config: Path, small_dataset: Path, tmp_path: Path):
    """A cluster of two processes, found by its address."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", resources={"GPU": 1}) as cluster:
        address = cluster.scheduler_address
        command = ["dataset", "make", str(small_config), str(tmp_path / "dask"), "--scheduler", address]
        assert main([*command, "--resource", "TPU"]) == 2
        assert main([*command, "--resource", "GPU"]) == 0
    assert contents(tmp_path / "dask") == contents(small_dataset)


def test_a_scene_does_not_depend_on_how_many_there_are(small_config: Path):
    """Its draw is that of a longer dataset; a shorter one has its first views."""
    config = load_dataset_config(str(small_config))
    pool = object_pool(config)
    longer = config.model_copy(update={"views": 100})
    assert draw_scene(longer, pool, 1) == draw_scene(config, pool, 1)
    shorter = draw_scene(config.model_copy(update={"views": 3}), pool, 1)
    assert shorter.views == draw_scene(config, pool, 1).views[:1]


def test_another_configuration_is_refused_in_the_same_folder(
    small_config: Path, small_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture
):
    """Exit status 2, and the key that differs."""
    other = tmp_path / "other.yaml"
    other.write_text(small_config.read_text().replace("seed: 3", "seed: 4"))
    assert main(["dataset", "make", str(other), str(small_dataset)]) == 2
    assert "holds another dataset (`seed` differs)" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("parts: {A1: 1, C1: 1}", "parts: {A1: 1, Z: 1}"), "objects.parts: Z: there is none"),
        (("brass: 1", "bras: 1"), "did you mean brass"),
        (("workshop: 1", "workshop: -1"), "greater than or equal to 0"),
        (("[0.3, 0.4]", "[0.4, 0.3]"), "swap them"),
        (("seed: 3", "sead: 3"), "unknown key `sead`"),
        (('"off": 1', "off: 1"), 'quote it: "off"'),
        (("rubber: 1}\nsurr", "'iron:milled': 1}\nsurr"), "materials.non_metals: iron:milled: there is none"),
        (("rubber: 1}\nsurr", "brass: 1}\nsurr"), "materials.non_metals: brass: there is none"),
        (("brass: 1, iron: 1}\n  finishes: {polished: 1, milled: 1}", "gold: 1}\n  finishes: {oxidised: 1}"), "gold"),
        (("pile_parts: [2, 2]", "pile_parts: [0, 0]"), "objects.pile_parts.0"),
        (("clutter: [1, 2]", "clutter: [-1, 2]"), "surroundings.clutter.0"),
        (("clutter: [1, 2]", "clutter: [1, 2]\n  clutter_size_m: [0, 0.1]"), "clutter_size_m.0"),
        (("{424x240: 1}", "{424x240: 1}, laser_mw: [0, 360]"), "camera.laser_mw.0"),
        (("{424x240: 1}", "{424x240: 1}, laser_mw: [30, 5000]"), "camera.laser_mw.1"),
        (("{424x240: 1}", "{424x240: 1}, exposure_us: [-5, 9]"), "camera.exposure_us.0"),
        (("{424x240: 1}", "{424x240: 1}, exposure_us: [9, 1.0e+9]"), "camera.exposure_us.1"),
        (("[35, 70]", "[-80, 70]"), "poses.elevation_deg.0"),
        (("[35, 70]", "[2, 70]"), "the camera is in the table"),
        (("[0.3, 0.4]", "[-1, 0.4]"), "poses.distance_m.0"),
        (("[0.3, 0.4]", "[0.3, 8]"), "poses.distance_m.1"),
        (
            (
                "pile_parts",
                "cad: [{file: a/x.stl, units: mm, material: ['iron:milled']}, "
                "{file: b/x.stl, units: mm, material: ['brass:milled']}], pile_parts",
            ),
            "2 files are named x.stl",
        ),
        (("pile_parts", "cad: [{file: no.stl, units: mm, material: ['iron:milled']}], pile_parts"), "no.stl"),
    ],
)
def test_a_wrong_configuration_is_one_line(
    small_config: Path, tmp_path: Path, capsys: pytest.CaptureFixture, change: tuple[str, str], words: str
):
    """Exit status 2; nothing is written."""
    path = tmp_path / "wrong.yaml"
    assert change[0] in small_config.read_text()
    path.write_text(small_config.read_text().replace(*change))
    assert main(["dataset", "make", str(path), str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("views", ["0", "9999999999"])
def test_a_wrong_number_of_views_is_one_line(
    small_config: Path, tmp_path: Path, capsys: pytest.CaptureFixture, views: str
):
    """From the flag as from the file: between 1 and a million."""
    assert main(["dataset", "make", str(small_config), str(tmp_path / "out"), "--views", views]) == 2
    error = capsys.readouterr().err
    assert "--views" in error
    assert error.count("\n") == 1


def test_a_broken_mesh_in_the_pool_is_one_line(small_config: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    """Found before anything is rendered, though it may be drawn late or never."""
    (tmp_path / "broken.stl").write_bytes(b"solid nothing\nendsolid nothing\n")
    path = tmp_path / "wrong.yaml"
    cad = "cad: [{file: broken.stl, units: mm, material: ['iron:milled']}], pile_parts"
    path.write_text(small_config.read_text().replace("pile_parts", cad))
    assert main(["dataset", "make", str(path), str(tmp_path / "out")]) == 2
    assert "broken.stl" in capsys.readouterr().err


def test_a_folder_that_cannot_be_written_is_one_line(small_config: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    """A file stands where the folder should be."""
    (tmp_path / "file").touch()
    assert main(["dataset", "make", str(small_config), str(tmp_path / "file/out")]) == 2
    assert "is a file, not a folder" in capsys.readouterr().err


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS])
def test_a_full_or_read_only_disk_is_one_line(
    small_config: Path, tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch, number: int
):
    """Met while the head of the dataset is written: exit status 2, and no half-written file."""

    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr("studies.base.atomic_file.os.replace", fail)
    assert main(["dataset", "make", str(small_config), str(tmp_path / "out")]) == 2
    assert ("the disk is full" if number == errno.ENOSPC else "read-only") in capsys.readouterr().err
    assert [path for path in (tmp_path / "out").rglob("*") if path.is_file()] == []


def test_a_full_disk_in_a_scene_leaves_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The scene is not there, its partial folder is gone, and the reason is one line."""

    def fail(_: Path) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("studies.base.atomic_file.flush_tree", fail)
    with (
        pytest.raises(folders.InputError, match="the disk is full"),
        folders.written_whole(tmp_path, tmp_path / "train/000000") as folder,
    ):
        (folder / "half.png").write_bytes(b"x")
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
    assert not (tmp_path / "train/000000").exists()


def test_two_processes_do_not_make_one_dataset(small_config: Path, small_dataset: Path, capsys: pytest.CaptureFixture):
    """The second one is told so."""
    with make._alone(small_dataset):
        assert main(["dataset", "make", str(small_config), str(small_dataset)]) == 2
    assert "another process makes this dataset" in capsys.readouterr().err


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nonsense", "foo://bar:1"])
def test_a_scheduler_that_is_not_there_is_one_line(
    small_config: Path, tmp_path: Path, capsys: pytest.CaptureFixture, address: str
):
    """Exit status 2 within seconds, and nothing is written."""
    assert main(["dataset", "make", str(small_config), str(tmp_path / "out"), "--scheduler", address]) == 2
    assert "no scheduler answers there" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
