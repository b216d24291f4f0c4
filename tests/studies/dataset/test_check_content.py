"""`dataset check` finds wrong content behind hashes that were made to fit: it derives what it can again."""

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from render.world.rig import d435i_rig
from studies.base.atomic_file import file_digest
from studies.dataset.card.card import write_card
from studies.dataset.check.command import dataset_problems
from studies.dataset.check.images import depth_faults
from studies.dataset.format.folders import compact_json, listed_files
from studies.dataset.format.index import scene_folders, write_index


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
    before = {path: file_digest(path) for path in dataset.rglob("*") if path.is_file()}
    _made_to_fit(dataset)
    assert {path: file_digest(path) for path in dataset.rglob("*") if path.is_file()} == before


def _first(image: np.ndarray, where: np.ndarray) -> tuple[int, ...]:
    return tuple(np.argwhere(where)[len(np.argwhere(where)) // 2])


NEITHER = "has depth and a cause, or neither"
CONTENT = {
    "a hole without a cause": ("cause", lambda a: a.__setitem__(_first(a, a > 0), 0), NEITHER),
    "a cause with depth": ("cause", lambda a: a.__setitem__(_first(a, a == 0), 3), NEITHER),
    "a code that is none": ("cause", lambda a: a.__setitem__(_first(a, a > 0), 99), "no cause"),
    "false depth called right": ("false_depth", lambda a: a.fill(0), "calls depth right that is false"),
    "right depth called false": ("false_depth", lambda a: np.copyto(a, 21, where=a == 0), "calls depth false"),
    "depth in another unit": ("depth", lambda a: np.copyto(a, a // 10), "is in another unit than the true depth"),
    "truth in another unit": ("depth_true", lambda a: np.copyto(a, a // 10), "calls depth right that is false"),
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


def _edit_json(path: Path, change: Callable[[dict], object]) -> None:
    content = json.loads(path.read_text())
    change(content)
    path.write_bytes(compact_json(content))


def _swap(first: Path, second: Path) -> None:
    held = first.read_bytes()
    first.write_bytes(second.read_bytes())
    second.write_bytes(held)


def _found(root: Path, words: str) -> bool:
    _made_to_fit(root)
    return any(words in problem for problem in dataset_problems(root)[1])


@pytest.mark.parametrize(
    ("first", "second"),
    [("gray/000000", "gray/000001"), ("gray/000000", "gray_right/000000"), ("depth_frames/000000_000000",) * 2],
)
@pytest.mark.parametrize("frames_kept", [True, False])
def test_an_infrared_image_of_elsewhere_gives_another_depth(
    dataset: Path, first: str, second: str, frames_kept: bool, monkeypatch: pytest.MonkeyPatch
):
    """The pair is matched again: swapped views, swapped sides, a blackened image (where both are one name)."""
    scene = dataset / "train/000000"
    if first == second:
        _edit(scene / "gray/000000.png", lambda a: a.fill(0))
    else:
        _swap(scene / f"{first}.png", scene / f"{second}.png")
    if not frames_kept:  # then only what all frames share can tell
        monkeypatch.setattr("studies.dataset.check.view.read_frames", lambda *_: None)
    assert _found(dataset, "matched with gray_right it gives another depth")


DECIMATED = {
    "another unit": ("depth_decimated", lambda a: np.copyto(a, a // 10), "depth_decimated"),
    "one cause for all": ("cause_decimated", lambda a: np.copyto(a, 8, where=a > 0), "most frequent cause"),
    "all false": ("false_depth_decimated", lambda a: a.fill(20), "decimated"),
    "none false": ("false_depth_decimated", lambda a: a.fill(0), "does not agree with decimated true depth"),
    "a frame of elsewhere": ("depth_frames", lambda a: np.copyto(a, a[::-1].copy()), "is not the median of the frames"),
}  # fmt: skip


@pytest.mark.parametrize("case", DECIMATED)
def test_what_follows_from_the_frames_is_derived_again(dataset: Path, case: str):
    """Decimated images and the median, of the stored frames."""
    layer, change, words = DECIMATED[case]
    for path in sorted((dataset / "train/000000" / layer).glob("000000*")):
        _edit(path, change)
    assert _found(dataset, words)


def test_decimated_depth_of_frames_that_are_not_kept_is_bounded(dataset: Path, monkeypatch: pytest.MonkeyPatch):
    """Then it cannot be derived, but its unit and where it is can."""
    monkeypatch.setattr("studies.dataset.check.view.read_frames", lambda *_: None)
    _edit(dataset / "train/000000/depth_decimated/000000.png", lambda a: np.copyto(a, a // 10))
    assert _found(dataset, "in another unit than depth")
    _edit(dataset / "train/000000/depth_decimated/000000.png", lambda a: a.fill(0))
    assert _found(dataset, "has none where pixels of the block have depth")


def test_causes_that_geometry_decides_are_checked(dataset: Path):
    """A hole beyond the right image is no occlusion, and one in the middle is not beyond it. At 0.3 to 0.4 m the left
    213 * 50 / 400 = 26 columns at least are beyond it."""
    path = dataset / "train/000000/cause/000000.png"
    before = path.read_bytes()
    _edit(path, lambda a: np.copyto(a, 4, where=a == 3))
    assert _found(dataset, "calls holes otherwise that by true depth are no_overlap")
    path.write_bytes(before)
    _edit(path, lambda a: np.copyto(a[:, 120:], 3, where=a[:, 120:] > 0))
    assert _found(dataset, "calls holes no_overlap where true depth says that they are not")


def test_true_depth_that_leaves_the_table_is_found(dataset: Path):
    """The truth of one view, 3 mm deeper: what lay on the table's plane lies below it."""
    _edit(dataset / "train/000000/depth_true/000000.png", lambda a: np.copyto(a, a + 30, where=a > 0))
    assert _found(dataset, "points where, from this pose,")


SCENE_JSON = {
    "laser": lambda c: c["draw"].update(laser_mw=333.0),
    "lamps": lambda c: c["draw"].update(lamps="bright"),
    "table": lambda c: c["draw"].update(table="rubber"),
    "clutter": lambda c: c["draw"]["clutter"][0].update(material="matte_paint"),
    "pose": lambda c: c["draw"]["views"][0]["T_world_cam"][0].__setitem__(3, 0.5),
    "fixed exposure": lambda c: c["draw"].update(exposure_us=99.0),
    "name of a body": lambda c: c["bodies"][0].update(name="table"),
    "no number": lambda c: c["bodies"][0].update(object=10**30),
}


@pytest.mark.parametrize("case", SCENE_JSON)
def test_a_scene_that_the_configuration_does_not_give_is_found(dataset: Path, case: str):
    """The scene is drawn again from seed and number."""
    _edit_json(dataset / "train/000000/scene.json", SCENE_JSON[case])
    assert _found(dataset, "train/000000/scene.json: ")


def _ten_times_larger(info: dict) -> None:
    entry = info["0"][0]
    entry["px_count_all"] *= 10
    entry["visib_fract"] = entry["px_count_visib"] / entry["px_count_all"]


COUNTED = {
    "box": ("scene_gt_info", lambda c: c["0"][0].update(bbox_obj=[0, 0, 5, 5])),
    "pixels": ("scene_gt_info", _ten_times_larger),
    "visible share": ("scene_gt_info", lambda c: c["0"][0].update(visib_fract=0.5)),
    "COCO box": ("scene_gt_coco", lambda c: c["annotations"][0].update(bbox=[1, 1, 2, 2])),
    "COCO category": ("scene_gt_coco", lambda c: c["annotations"][0].update(category_id=9)),
    "COCO file": ("scene_gt_coco", lambda c: c["images"][0].update(file_name="../../x.png")),
    "run lengths": (
        "scene_gt_coco",
        lambda c: c["annotations"][0].update(segmentation={"counts": [0, 10**12], "size": [10**6, 10**6]}),
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", COUNTED)
def test_counts_and_annotations_are_derived_again(dataset: Path, case: str):
    """From the masks, by the functions that wrote them; what they say is never decoded."""
    name, change = COUNTED[case]
    _edit_json(dataset / f"train/000000/{name}.json", change)
    assert _found(dataset, f"train/000000/{name}.json: ")


def _move_a_corner(root: Path) -> None:
    path = root / "models/obj_000001.ply"
    lines = path.read_text().split("\n")
    place = lines.index("end_header") + 3
    lines[place] = " ".join(["0.00000", *lines[place].split()[1:]])
    path.write_text("\n".join(lines))


HEAD = {
    "camera": ("camera.json", lambda c: c.update(fx=999.0)),
    "causes": ("dataset.json", lambda c: c["causes"].update({"4": "reflection_dark", "7": "occlusion"})),
    "materials": ("dataset.json", lambda c: c["materials"].reverse()),
    "objects": ("dataset.json", lambda c: c["objects"][0].update(name="Z")),
    "diameter": ("models/models_info.json", lambda c: c["1"].update(diameter=1.0)),
    "a model's entry": ("models/models_info.json", lambda c: c.pop("2")),
}


@pytest.mark.parametrize("case", HEAD)
def test_tables_camera_and_models_are_derived_again(dataset: Path, case: str):
    """From the configuration."""
    name, change = HEAD[case]
    _edit_json(dataset / name, change)
    assert _found(dataset, "is not as large as" if case == "diameter" else f"{name}: ")


def test_another_model_is_found(dataset: Path):
    """One corner of many, inside the box."""
    _move_a_corner(dataset)
    assert _found(dataset, "obj_000001.ply: is not the object's model")


def test_scenes_of_different_versions_are_found(dataset: Path):
    """Their bytes need not agree with each other."""
    _edit_json(dataset / "train/000001/manifest.json", lambda c: c.update(renderer="another"))
    write_index(dataset, scene_folders(dataset))
    assert any(
        "different renderers or versions: renderer another" in problem for problem in dataset_problems(dataset)[1]
    )


def test_without_cad_files_the_rest_is_checked(dataset: Path, monkeypatch: pytest.MonkeyPatch):
    """No pool, so no draw: a sound dataset stays sound, and what images say is found all the same."""
    monkeypatch.setattr("studies.dataset.check.command.object_pool", lambda _: None)
    assert dataset_problems(dataset)[1] == []
    _edit_json(dataset / "train/000000/scene_gt_info.json", lambda c: c["0"][0].update(px_count_valid=1))
    assert _found(dataset, "px_count_valid is 1, not")
    _edit_json(dataset / "models/models_info.json", lambda c: c["1"].update(diameter=1.0))
    assert _found(dataset, "is not as large as models_info.json says")


def test_far_depth_may_be_off_by_its_noise():
    """At 3 m three standard deviations are 0.17 m, more than the 2 % within which depth near by must agree."""
    rig = d435i_rig("640x360")
    images = {
        "depth": np.full((360, 640), 3150, np.uint16),
        "depth_true": np.full((360, 640), 30000, np.uint16),
        "false_depth": np.zeros((360, 640), np.uint8),
    }
    assert list(depth_faults(images, rig, 1)) == []
    images["depth"] += np.uint16(50)
    assert [what for _, what in depth_faults(images, rig, 1)] == ["calls depth right that is false"]
