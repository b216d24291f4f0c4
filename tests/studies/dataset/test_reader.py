"""The reader gives SI units and NaN for nothing, and what it gives fits together."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import studies.dataset
from franbv.frames import Intrinsics
from materials.input_error import InputError


def test_views_have_all_layers(small_dataset: Path):
    """Two scenes of two views; every image of a view by name."""
    dataset = studies.dataset.open(small_dataset)
    assert len(dataset) == len(list(dataset)) == 4
    arrays = dataset[1].arrays()
    assert arrays["depth"].shape == arrays["cause"].shape == (240, 424)
    assert arrays["depth_decimated"].shape == (30, 53)
    assert arrays["normal"].shape == (240, 424, 3)
    assert dataset[-1].frames.shape == (2, 240, 424)
    assert dataset[0].masks().shape == dataset[0].masks(visible=False).shape == (len(dataset[0].objects), 240, 424)


def test_units(small_dataset: Path):
    """Metres, radians, unit normals; the truth is near the depth where it is called right."""
    for view in studies.dataset.open(small_dataset):
        depth, true = view.depth, view.depth_true
        right = (depth > 0) & (view.false_depth == 0)
        assert np.median(np.abs(depth - true)[right]) < 0.01
        assert 0 <= np.nanmin(view.incidence) <= np.nanmax(view.incidence) <= np.pi / 2 + 1e-3
        assert np.nanmax(np.abs(np.linalg.norm(view.normal, axis=-1) - 1)) < 1e-3
        assert 0.005 <= np.nanmin(view.roughness_u) <= np.nanmax(view.roughness_v) <= 1


def test_true_depth_and_pose_put_the_table_at_height_zero(small_dataset: Path):
    """Pixels of the table, back-projected with K and turned into the world, lie in the plane z = 0."""
    view = studies.dataset.open(small_dataset)[0]
    names = [body["name"] for body in view.bodies]
    table = view.body == names.index("table") + 1
    K, pose = view.intrinsics, view.T_world_cam
    rays = Intrinsics(424, 240, K[0, 0], K[1, 1], K[0, 2], K[1, 2]).pixel_directions()[table]
    points = rays * view.depth_true[table][:, None] @ pose[:3, :3].T + pose[:3, 3]
    top = points[np.abs(points[:, 2]) < 0.01]
    assert len(top) > 0.9 * len(points)  # the rest is the table's edge
    assert np.abs(top[:, 2]).max() < 2e-4  # true depth is stored to 0.05 mm


def test_a_slice_is_refused(small_dataset: Path):
    """Rather than giving something that is no view."""
    with pytest.raises(TypeError, match="one view at a time"):
        studies.dataset.open(small_dataset)[0:2]  # type: ignore[index]


def test_a_linked_scene_is_refused(small_dataset: Path, tmp_path: Path):
    """It may lead anywhere."""
    copy = Path(shutil.copytree(small_dataset, tmp_path / "copy"))
    (copy / "train/000001").rename(tmp_path / "elsewhere")
    (copy / "train/000001").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="000001: is a link"):
        studies.dataset.open(copy)


def test_there_is_no_such_layer(small_dataset: Path):
    """The message names those that there are."""
    with pytest.raises(AttributeError, match="colour; its images are gray"):
        _ = studies.dataset.open(small_dataset)[0].colour


def test_a_folder_without_a_dataset_is_refused(tmp_path: Path):
    """One line that says what is missing."""
    with pytest.raises(InputError, match=r"holds no dataset\.json"):
        studies.dataset.open(tmp_path)
    with pytest.raises(InputError, match="no such folder"):
        studies.dataset.open(tmp_path / "nowhere")
