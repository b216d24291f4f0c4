"""`dataset check` finds every change of any file; and wrong labels even where the hashes were made to fit."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from studies.cli.main import main
from studies.dataset.check.command import dataset_problems, missing_scenes
from studies.dataset.check.head import ply_points
from studies.dataset.format.folders import compact_json, listed_files


def _files(root: Path) -> list[Path]:
    return sorted(path for path in root.rglob("*") if path.is_file())


def test_a_sound_dataset_has_no_problem(small_dataset: Path, capsys: pytest.CaptureFixture):
    """Exit status 0 and the number of views."""
    assert main(["dataset", "check", str(small_dataset), "--json"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1]) == {"schema": 1, "views": 4, "problems": 0}


def test_materials_of_the_user_are_known(small_config: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    """A dataset of a metal that only its configuration knows is sound, and can be shown."""
    metals = "  metals: {brass: 1, iron: 1}"
    assert metals in small_config.read_text()
    own = "  user: {mine: {kind: metal, n: 2.9, k: 4.4, valid_nm: [400, 1000], source: a test}}\n  metals: {mine: 1}"
    config, root = tmp_path / "own.yaml", tmp_path / "own"
    config.write_text(small_config.read_text().replace(metals, own).replace("views: 4", "views: 1"))
    assert main(["dataset", "make", str(config), str(root), "--workers", "1"]) == 0
    assert main(["dataset", "check", str(root)]) == 0
    assert main(["dataset", "show", str(root)]) == 0
    assert "mine:" in (root / "README.md").read_text()


def flip_a_bit(root: Path, rng: np.random.Generator) -> None:
    """Of any file, anywhere in it."""
    path = _pick(_files(root), rng)
    data = bytearray(path.read_bytes())
    data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))
    path.write_bytes(data)


def truncate(root: Path, rng: np.random.Generator) -> None:
    """At least the last byte goes."""
    path = _pick(_files(root), rng)
    path.write_bytes(path.read_bytes()[: rng.integers(path.stat().st_size)])


def swap_two(root: Path, rng: np.random.Generator) -> None:
    """Two files of different content change places."""
    first = _pick(_files(root), rng)
    second = _pick([path for path in _files(root) if path.read_bytes() != first.read_bytes()], rng)
    held = first.read_bytes()
    first.write_bytes(second.read_bytes())
    second.write_bytes(held)


def delete(root: Path, rng: np.random.Generator) -> None:
    """Any file."""
    _pick(_files(root), rng).unlink()


def add_a_stray_file(root: Path, rng: np.random.Generator) -> None:
    """A copy of a file under another name in any folder."""
    folder = _pick([root, *(path for path in root.rglob("*") if path.is_dir())], rng)
    (folder / f"stray_{rng.integers(10**6)}.png").write_bytes(_pick(_files(root), rng).read_bytes())


def edit_a_label(root: Path, rng: np.random.Generator) -> None:
    """One pixel of one label map gets another code that is a cause, the PNG stays a PNG."""
    path = _pick(sorted(root.glob("train/*/cause/*.png")), rng)
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    at = tuple(rng.integers(image.shape))
    image[at] = (image[at] + 1 + rng.integers(10)) % 12
    cv2.imwrite(str(path), image)


CORRUPTIONS = (flip_a_bit, truncate, swap_two, delete, add_a_stray_file, edit_a_label)


def _pick(choices: list[Path], rng: np.random.Generator) -> Path:
    return choices[rng.integers(len(choices))]


@pytest.mark.parametrize("corrupt", CORRUPTIONS, ids=lambda f: f.__name__)
@pytest.mark.parametrize("seed", range(2))
def test_a_corruption_is_found(dataset: Path, corrupt: Callable, seed: int):
    """Whatever is changed, wherever: at least one problem, and exit status 1."""
    corrupt(dataset, np.random.default_rng(seed))
    assert main(["dataset", "check", str(dataset)]) == 1


@pytest.mark.slow
@pytest.mark.parametrize("corrupt", CORRUPTIONS, ids=lambda f: f.__name__)
def test_every_one_of_many_corruptions_is_found(small_dataset: Path, tmp_path: Path, corrupt: Callable):
    """34 of each kind, 204 in all, each on a fresh copy."""
    missed = []
    for seed in range(100, 134):
        root = Path(shutil.copytree(small_dataset, tmp_path / str(seed)))
        corrupt(root, np.random.default_rng(seed))
        if not dataset_problems(root)[1]:
            missed.append(seed)
        shutil.rmtree(root)
    assert missed == []


def test_a_link_out_of_the_folder_is_not_followed(dataset: Path, tmp_path: Path):
    """A link to the same bytes elsewhere is a problem, and so is a manifest that names a path outside."""
    image = dataset / "train/000000/gray/000000.png"
    outside = tmp_path / "outside.png"
    image.rename(outside)
    image.symlink_to(outside)
    assert any("is a link" in problem for problem in dataset_problems(dataset)[1])
    image.unlink()
    outside.rename(image)
    path = dataset / "train/000000/manifest.json"
    manifest = json.loads(path.read_text())
    manifest["files"]["../../../outside.png"] = [1, "00"]
    path.write_bytes(compact_json(manifest))
    assert any("which is no name" in problem for problem in dataset_problems(dataset)[1])


def test_an_unfinished_dataset_says_so(dataset: Path):
    """Its work folder is still there."""
    (dataset / ".work").mkdir()
    assert dataset_problems(dataset)[1] == [".work: the dataset is unfinished; give the `make` command again"]


def test_no_dataset_at_all(tmp_path: Path, capsys: pytest.CaptureFixture):
    """Exit status 2, one line."""
    assert main(["dataset", "check", str(tmp_path)]) == 2
    assert "holds no dataset.json" in capsys.readouterr().err


@pytest.mark.parametrize(
    "name", ["dataset.json", "camera.json", "models/models_info.json", "train/000000/scene_gt.json"]
)
@pytest.mark.parametrize("content", ["[" * 200_000, "7", "[]", "{}", '{"0": 1e999}', "\x1b[31m\n"])
def test_crafted_json_is_a_problem_and_no_crash(dataset: Path, name: str, content: str):
    """Nested without end, of another type, with a terminal's commands: one printable line each."""
    (dataset / name).write_text(content)
    manifest = dataset / "train/000000/manifest.json"
    files = listed_files(manifest.parent)
    files.pop("manifest.json")
    manifest.write_bytes(compact_json(json.loads(manifest.read_text()) | {"files": files}))
    problems = dataset_problems(dataset)[1]
    assert problems
    assert all(problem.isprintable() and len(problem) < 500 for problem in problems)


def test_a_model_cannot_ask_for_more_memory_than_it_has_corners(tmp_path: Path):
    """Whatever its head says: 30 digits, or more corners than the file has room for."""
    for count in ("9" * 30, "99999999", "-1"):
        with pytest.raises(ValueError, match="no PLY file"):
            ply_points(f"ply\nelement vertex {count}\nend_header\n0 0 0\n".encode())


def test_missing_scenes_take_one_line(dataset: Path):
    """However many a crafted configuration asks for."""
    assert missing_scenes([f"{n:06d}" for n in range(10**5)]) == [
        "train/000000 and 99999 more: missing; give the `make` command again"
    ]


def test_the_mend_is_said(dataset: Path, capsys: pytest.CaptureFixture):
    """Delete what is wrong, then make it again."""
    (dataset / "train/000001/gray/000000.png").unlink()
    (dataset / "README.md").write_text("")
    assert main(["dataset", "check", str(dataset)]) == 1
    said = capsys.readouterr().out
    assert "To mend it: delete train/000001, README.md, then give the `make` command again" in said


def test_the_configuration_may_be_given_and_must_be_the_dataset_s_own(
    small_config: Path, small_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture
):
    """It brings the CAD files; with another one, scenes would be drawn that nobody asked for."""
    assert main(["dataset", "check", str(small_dataset), "--config", str(small_config)]) == 0
    other = tmp_path / "other.yaml"
    other.write_text(small_config.read_text().replace("seed: 3", "seed: 4"))
    assert main(["dataset", "check", str(small_dataset), "--config", str(other)]) == 2
    assert "was not made from this configuration" in capsys.readouterr().err
