"""`calibrate hand-eye` of both programs: a file of poses in, a file with the result out, one line for every mistake."""

import json
import subprocess
import sys
from datetime import UTC, datetime, timedelta
from functools import cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.__main__ import run
from franbv.adapters.calibration.calibration_error import CalibrationError
from franbv.adapters.calibration.hand_eye_file import read_hand_eye
from franbv.frames import look_at, rolled
from studies.cli.main import main
from tests.conftest import ROOT
from tests.franbv.adapters.calibration.board_images import BOARD, CAMERA, FLAT, board_image

X = RigidTransform.from_components([0.01, -0.06, 0.04], Rotation.from_euler("xyz", [2, -3, 91], degrees=True))
"""T_flange_cam."""


def camera_poses(n: int = 8) -> list[RigidTransform]:
    """T_world_cam around the board, rolled."""
    poses = []
    for k in range(n):
        azimuth = 2 * np.pi * k / n
        eye = np.array([0.16 * np.cos(azimuth), 0.16 * np.sin(azimuth), 0.24 + 0.01 * (k % 3)])
        poses.append(rolled(look_at(eye, np.zeros(3)), 40.0 * (k % 4) - 60.0))
    return poses


def seven(T: RigidTransform) -> list[float]:
    """x y z qx qy qz qw."""
    return [*T.translation.tolist(), *T.rotation.as_quat().tolist()]


def pose_list() -> list[dict[str, Any]]:
    """Without images; matrices and quaternions."""
    pairs = []
    for k, T_world_cam in enumerate(camera_poses()):
        flange, board = T_world_cam * X.inv(), T_world_cam.inv() * FLAT
        written = (seven(flange), seven(board)) if k % 2 else (flange.as_matrix().tolist(), board.as_matrix().tolist())
        pairs.append({"T_base_flange": written[0], "T_cam_board": written[1]})
    return pairs


@cache
def images() -> list[np.ndarray]:
    """Of the board from each pose."""
    return [board_image(T_world_cam.inv() * FLAT, seed=k) for k, T_world_cam in enumerate(camera_poses())]


def with_images(folder: Path) -> dict[str, Any]:
    """The same with images."""
    poses = []
    for k, T_world_cam in enumerate(camera_poses()):
        cv2.imwrite(str(folder / f"{k}.png"), images()[k])
        poses.append({"T_base_flange": seven(T_world_cam * X.inv()), "image": f"{k}.png"})
    numbers = {name: getattr(CAMERA, name) for name in ("width", "height", "fx", "fy", "cx", "cy")}
    return {"board": BOARD.model_dump(), "camera": numbers, "poses": poses}


def written(folder: Path, content: Any) -> str:
    """Its path."""
    path = folder / "poses.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return str(path)


def test_both_programs_write_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """From a bare list of poses, exactly; sentence and JSON for people and machines."""
    poses = written(tmp_path, pose_list())
    assert run(["calibrate", "hand-eye", poses, "--out", str(tmp_path / "a.json"), "--json"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith(f"{tmp_path / 'a.json'}: 8 poses fit within 0.00 mm and 0.000 deg; each is foretold")
    assert main(["calibrate", "hand-eye", poses, "--out", str(tmp_path / "b.json"), "--json"]) == 0
    assert capsys.readouterr().out.splitlines()[0].split(": ")[1] == said[0].split(": ")[1]
    one, other = (json.loads((tmp_path / name).read_text()) for name in ("a.json", "b.json"))
    date = datetime.fromisoformat(one.pop("date"))
    assert abs(datetime.now(UTC) - date) < timedelta(hours=1)
    del other["date"]
    assert one == other
    assert json.loads(said[-1])["poses"] == one["poses"] == len(one["of_each_pose"]) == 8
    assert np.allclose(one["T_flange_cam"], X.as_matrix(), atol=1e-9)
    assert np.allclose(one["T_base_board"], FLAT.as_matrix(), atol=1e-9)
    assert np.allclose(read_hand_eye(tmp_path / "a.json").as_matrix(), X.as_matrix(), atol=1e-9)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.json", "b.json", "poses.json"]


def test_from_images(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """The board is found in each; the camera to a millimetre and a quarter of a degree, and the figures say as much."""
    assert (
        run(["calibrate", "hand-eye", written(tmp_path, with_images(tmp_path)), "--out", str(tmp_path / "x.json")]) == 0
    )
    record = json.loads((tmp_path / "x.json").read_text())
    apart = X.inv() * read_hand_eye(tmp_path / "x.json")
    mm, deg = 1e3 * np.linalg.norm(apart.translation), np.degrees(apart.rotation.magnitude())
    sys.stdout.write(f"\n8 images at 640x360: X to {mm:.2f} mm and {deg:.3f} deg; {capsys.readouterr().out}")
    assert mm < 1.0
    assert deg < 0.25
    assert 0 < record["misfit_rms"]["mm"] < record["left_out_rms"]["mm"] < 2.0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("no file", "cannot be read (No such file or directory); check the path"),
        ("no json", "is no JSON file"),
        ("no pose", "poses"),
        ("both", "poses.0: give either an image or T_cam_board"),
        ("typo", "poses.0.T_base_flangge: Extra inputs are not permitted"),
        ("millimetres", "m away; are the numbers in mm? write metres"),
        ("no rotation", "poses.0.T_base_flange: is no rotation and translation"),
        ("quaternion", "poses.1.T_base_flange: its quaternion is not of length 1; write x y z qx qy qz qw"),
        ("nan", "poses.1.T_base_flange: not all numbers are finite"),
        ("image alone", "images need `board` and `camera` beside `poses`"),
        ("two", "2 flange poses and 2 of the board; give at least 3 pairs"),
    ],
)
def test_bad_files_end_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str], change: str, words: str):
    """With the place and the mend, status 2, and no file."""
    poses: Any = pose_list()
    if change == "both":
        poses[0]["image"] = "0.png"
    elif change == "typo":
        poses[0]["T_base_flangge"] = poses[0]["T_base_flange"]
    elif change == "millimetres":
        for row in poses[0]["T_base_flange"][:3]:
            row[3] *= 1e5
    elif change == "no rotation":
        poses[0]["T_base_flange"][0][0] = 2.0
    elif change == "quaternion":
        poses[1]["T_base_flange"][3:] = [0.0, 0.0, 90.0, 0.0]
    elif change == "nan":
        poses[1]["T_base_flange"][0] = float("nan")
    elif change == "image alone":
        poses[0] = {"T_base_flange": poses[0]["T_base_flange"], "image": "0.png"}
    poses = {"no json": "{", "no pose": {"poses": []}, "two": poses[:2]}.get(change, poses)
    path = written(tmp_path, poses)
    if change == "no file":
        Path(path).unlink()
    for program in (run, main):
        assert program(["calibrate", "hand-eye", path, "--out", str(tmp_path / "x.json")]) == 2
        said = capsys.readouterr()
        assert said.out == ""
        assert words in said.err
        assert said.err.count("\n") == 1
    assert not (tmp_path / "x.json").exists()


@pytest.mark.parametrize(
    ("image", "words"), [("gone", "no such image"), ("text", "is no image"), ("grey", "0 corners")]
)
def test_bad_images_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str], image: str, words: str):
    """Which file, and what is wrong with it."""
    content = with_images(tmp_path)
    if image == "gone":
        (tmp_path / "3.png").unlink()
    elif image == "text":
        (tmp_path / "3.png").write_text("no image")
    else:
        cv2.imwrite(str(tmp_path / "3.png"), np.full((360, 640), 90, np.uint8))
    assert run(["calibrate", "hand-eye", written(tmp_path, content), "--out", str(tmp_path / "x.json")]) == 2
    said = capsys.readouterr().err
    assert f"{tmp_path / '3.png'}: " in said
    assert words in said


def test_nothing_is_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A calibration that is there stays; a folder that is not there is not made."""
    out = tmp_path / "x.json"
    out.write_text("mine")
    poses = written(tmp_path, pose_list())
    assert run(["calibrate", "hand-eye", poses, "--out", str(out)]) == 2
    assert "is there already; take another name" in capsys.readouterr().err
    assert out.read_text() == "mine"
    assert run(["calibrate", "hand-eye", poses, "--out", str(tmp_path / "no" / "x.json")]) == 2
    assert "no such folder" in capsys.readouterr().err


@pytest.mark.parametrize("content", ["{}", "[]", '{"T_flange_cam": "x"}', '{"T_flange_cam": [[1, 0], [0, 1]]}'])
def test_a_file_that_is_no_calibration(tmp_path: Path, content: str):
    """Refused where it is read."""
    path = tmp_path / "x.json"
    path.write_text(content)
    with pytest.raises(
        CalibrationError, match=r"has no T_flange_cam of 4 x 4 numbers; make it with calibrate hand-eye"
    ):
        read_hand_eye(path)


def test_the_program_itself(tmp_path: Path):
    """`python -m franbv.adapters` in a process of its own."""
    command = [sys.executable, "-m", "franbv.adapters", "calibrate", "hand-eye", written(tmp_path, pose_list())]
    done = subprocess.run(
        [*command, "--out", str(tmp_path / "x.json")], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "x.json").exists()
