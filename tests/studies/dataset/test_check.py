"""`dataset check` finds every change of any file; and wrong labels even where the hashes were made to fit."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from studies.cases import file_digest
from studies.cli import main
from studies.dataset.card import write_card
from studies.dataset.check import dataset_problems
from studies.dataset.folders import compact_json, listed_files
from studies.dataset.index import scene_folders, write_index


@pytest.fixture
def dataset(small_dataset: Path, tmp_path: Path) -> Path:
    """A copy that a test may spoil."""
    return Path(shutil.copytree(small_dataset, tmp_path / "copy"))


def _files(root: Path) -> list[Path]:
    return sorted(path for path in root.rglob("*") if path.is_file())


def test_a_sound_dataset_has_no_problem(small_dataset: Path, capsys: pytest.CaptureFixture):
    """Exit status 0 and the number of views."""
    assert main(["dataset", "check", str(small_dataset), "--json"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1]) == {"views": 4, "problems": 0}


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


def _made_to_fit(root: Path) -> None:
    """Manifests, index and card as if the changed files had been made so: only their content can give them away."""
    for scene in scene_folders(root):
        path = root / "train" / scene / "manifest.json"
        manifest = json.loads(path.read_text())
        path.unlink()
        path.write_bytes(compact_json(manifest | {"files": listed_files(path.parent)}))
    write_index(root, scene_folders(root))
    write_card(root)


def _edit(path: Path, change: Callable[[np.ndarray], None]) -> None:
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    change(image)
    cv2.imwrite(str(path), image)


def test_made_to_fit_alone_makes_no_problem(dataset: Path):
    """So that the tests below find what they mean to find."""
    before = {path: file_digest(path) for path in _files(dataset)}
    _made_to_fit(dataset)
    assert {path: file_digest(path) for path in _files(dataset)} == before


def _first(image: np.ndarray, where: np.ndarray) -> tuple[int, ...]:
    return tuple(np.argwhere(where)[len(np.argwhere(where)) // 2])


NEITHER = "has depth and a cause, or neither"
CONTENT = {
    "a hole without a cause": ("cause", lambda a: a.__setitem__(_first(a, a > 0), 0), NEITHER),
    "a cause with depth": ("cause", lambda a: a.__setitem__(_first(a, a == 0), 3), NEITHER),
    "a code that is none": ("cause", lambda a: a.__setitem__(_first(a, a > 0), 99), "no cause"),
    "false depth called right": ("false_depth", lambda a: a.fill(0), "calls depth right that is false"),
    "right depth called false": ("false_depth", lambda a: np.copyto(a, 21, where=a == 0), "false"),
    "depth in another unit": ("depth", lambda a: np.copyto(a, a // 10), "depth"),
    "truth in another unit": ("depth_true", lambda a: np.copyto(a, a // 10), "depth"),
    "something where nothing is": ("body", lambda a: a.fill(0), "says that something is there"),
    "another material": ("material", lambda a: np.copyto(a, a + 1), "is not that of the body"),
    "a smoother surface": ("roughness_v", lambda a: np.copyto(a, a // 2), "is not that of the body"),
    "a mirrored normal": ("normal", lambda a: np.copyto(a, a[..., ::-1].copy()), "angle between normal and view ray"),
    "frames that were there": ("missing_frames", lambda a: a.fill(0), "does not agree with depth"),
}  # fmt: skip


@pytest.mark.parametrize("case", CONTENT)
def test_wrong_content_is_found_behind_right_hashes(dataset: Path, case: str):
    """The label algebra, the units and the agreement of the truth are checked, not only the bytes."""
    layer, change, words = CONTENT[case]
    _edit(dataset / "train/000000" / layer / "000001.png", change)
    _made_to_fit(dataset)
    assert any(words in problem for problem in dataset_problems(dataset)[1])


@pytest.mark.parametrize(
    ("name", "key", "change", "words"),
    [
        ("scene_camera", "cam_K", lambda v: [*v[:2], v[2] + 0.5, *v[3:]], "cam_K"),
        ("scene_camera", "cam_t_w2c", lambda v: [x / 1000 for x in v], "in mm"),
        ("scene_camera", "depth_scale", lambda v: 0.1, "depth_scale"),
    ],
)
def test_wrong_intrinsics_and_poses_are_found(dataset: Path, name: str, key: str, change: Callable, words: str):
    """In the files that BOP's readers take."""
    path = dataset / "train/000001" / f"{name}.json"
    content = json.loads(path.read_text())
    content["1"][key] = change(content["1"][key])
    path.write_bytes(compact_json(content))
    _made_to_fit(dataset)
    assert any(words in problem for problem in dataset_problems(dataset)[1])


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
