"""The command line: help at once, every kind of bad input in one line with exit status 2, signals leave no case."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import trimesh

from studies.cli.main import COMMANDS, main

POLISHED = "stainless_austenitic:polished"


def _one_line(capsys: pytest.CaptureFixture[str], *args: str) -> str:
    """The complaint about these arguments: one line on stderr, exit status 2, nothing on stdout."""
    assert main(args) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "Traceback" not in err
    return err


def _box(folder: Path, name: str = "box.stl", scale: float = 1.0) -> Path:
    """A 60 x 40 x 30 box in millimetres."""
    path = folder / name
    trimesh.creation.box((60 * scale, 40 * scale, 30 * scale)).export(path)
    return path


def test_help_needs_no_scientific_package():
    """`franbv --help` answers at once because it imports nothing that is slow to import."""
    code = (
        "import sys; from studies.cli.main import main; status = main(['--help']); "
        "heavy = {'numpy', 'scipy', 'tyro', 'pydantic', 'mitsuba', 'trimesh'} & sys.modules.keys(); "
        "sys.exit(status or ' '.join(sorted(heavy)) or 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert all(command in done.stdout for command in COMMANDS)


def test_no_command_is_bad_input(capsys: pytest.CaptureFixture[str]):
    """The overview goes to stderr and the status says that nothing was done."""
    assert main([]) == 2
    assert "usage: franbv COMMAND" in capsys.readouterr().err


def test_unknown_command_names_the_nearest(capsys: pytest.CaptureFixture[str]):
    """Thing and mend in one line."""
    assert "unknown command `reconstuct`; did you mean reconstruct" in _one_line(capsys, "reconstuct")


@pytest.mark.parametrize("command", ["frame", "reconstruct"])
def test_bad_flags_and_bad_parts(capsys: pytest.CaptureFixture[str], tmp_path: Path, command: str):
    """Flags, parts, materials, lamps: each complaint names what is wrong and what may stand there."""
    out = str(tmp_path / "out")
    cases = {
        ("--out", out): "give either --part A, B, C, D or another, or --mesh",
        ("--out", out, "--part", "E"): "part E: there is none; choose A, B, C, D, A1, B1, C1, D1, E1",
        ("--out", out, "--part", "A", "--mesh", "x.stl"): "give either",
        ("--part", "A"): "--out",
        ("--out", out, "--part", "A", "--prat", "B"): "--prat",
        ("--out", out, "--part", "A", "--seed", "many"): "'many'",
        ("--out", out, "--part", "A", "--seed", "-1"): "`seed` = -1",
        ("--out", out, "--part", "A", "--lamps", "sun"): "sun",
        ("--out", out, "--part", "A", "--units", "mm"): "--units and --up are for --mesh",
        ("--out", out, "--part", "plate"): "a coupon needs one material",
        ("--out", out, "--part", "A", "--sensor.profile", "100x100"): "100x100",
        ("--out", out, "--part", "A", "--material", "steel:polished"): "unknown material",
        ("--out", out, "--part", "A", "--material", "iron:shiny"): "unknown finish shiny",
        ("--out", out, "--part", "A", "--material", "iron"): "a metal needs a finish",
        ("--out", out, "--part", "A", "--material", "iron:polished@alpha=-0.1"): "alpha",
        ("--out", out, "--part", "A", "--material", "lid=iron:polished"): "no body lid",
        ("--out", out, "--part", "A", "--materials-file", "none.yaml"): "none.yaml",
        ("--out", out, "--part", "A", "--config", "none.yaml"): "none.yaml: no such file",
    }
    for args, expected in cases.items():
        assert expected in _one_line(capsys, command, *args)
    assert not (tmp_path / "out").exists()


def test_bad_meshes(capsys: pytest.CaptureFixture[str], tmp_path: Path):
    """Missing, not a mesh, empty, no faces, NaN, no unit, absurd unit, unknown unit, no material: one line each."""
    good = _box(tmp_path)
    text = tmp_path / "notes.txt"
    text.write_text("not a mesh")
    garbage = tmp_path / "garbage.stl"
    garbage.write_text("not a mesh either")
    empty = tmp_path / "empty.ply"
    empty.write_bytes(b"")
    points = tmp_path / "points.ply"
    trimesh.PointCloud(np.eye(3)).export(points)
    broken = trimesh.creation.box((60, 40, 30))
    broken.vertices[0] = np.nan
    nan = tmp_path / "nan.obj"
    nan.write_text(trimesh.exchange.obj.export_obj(broken))
    out, units, material = ("--out", str(tmp_path / "out")), ("--units", "mm"), ("--material", POLISHED)
    cases = {
        (str(tmp_path / "none.stl"), *units, *material): "none.stl: no such file",
        (str(tmp_path), *units, *material): "is a folder",
        (str(text), *units, *material): "notes.txt: not a mesh file",
        (str(garbage), *units, *material): "garbage.stl",
        (str(empty), *units, *material): "the file is empty",
        (str(points), *units, *material): "no triangles",
        (str(nan), *units, *material): "nan.obj",
        (str(good), *material): "pass --units mm, cm, m or in",
        (str(good), "--units", "m", *material): "--units mm",
        (str(good), "--units", "parsec", *material): "unknown unit parsec",
        (str(good), *units): "pass --material",
        (str(_box(tmp_path, "big.stl", 10.0)), *units, *material): "do not fit into the mapped box",
    }
    for (mesh, *rest), expected in cases.items():
        assert expected in _one_line(capsys, "reconstruct", *out, "--mesh", mesh, *rest)
    assert not (tmp_path / "out").exists()


def test_material_outside_its_validity(capsys: pytest.CaptureFixture[str], tmp_path: Path):
    """Constants measured in the visible are refused at 850 nm, with the range that they hold in."""
    file = tmp_path / "mine.yaml"
    file.write_text(
        "materials: {my_steel: {kind: metal, n: 2.9, k: 4.4, valid_nm: [400, 700], source: visible ellipsometry}}\n"
    )
    args = (
        "--part",
        "A",
        "--material",
        "my_steel:polished",
        "--materials-file",
        str(file),
        "--out",
        str(tmp_path / "o"),
    )
    line = _one_line(capsys, "frame", *args)
    assert "my_steel" in line
    assert "850" in line
    assert "700" in line


def test_bad_poses(capsys: pytest.CaptureFixture[str], tmp_path: Path):
    """Under the table, inside the part, outside the room, not numbers: one line, before any renderer is loaded."""
    cases = {
        "0,-30,0.4": "under the table",
        "eye:0.3,0,-0.1": "under the table",
        "0,0,0.01": "inside the part",
        "eye:0,0,0.01": "inside the part",
        "eye:9,0,1": "outside the room",
        "0,45": "not three numbers",
        "north": "not three numbers",
        "0,45,nan": "not finite",
        "0,45,-0.3": "not positive",
        "0,100,0.3": "beyond straight up",
    }
    for pose, expected in cases.items():
        assert expected in _one_line(capsys, "frame", "--part", "A", "--out", str(tmp_path / "o"), f"--pose={pose}")
    on_paper = ("--part", "A", "--bench", "paper", "--out", str(tmp_path / "o"))
    for pose, expected in {
        "eye:0.3,0,-0.02": "under the table",  # beside the plinth, above the table under it
        "eye:0.511,0.051,0.406": "inside the task lamp",
        "eye:0,9,1": "outside the room",
    }.items():
        assert expected in _one_line(capsys, "frame", *on_paper, f"--pose={pose}")
    assert not (tmp_path / "o").exists()


def test_bad_output_folders(capsys: pytest.CaptureFixture[str], tmp_path: Path):
    """A file in the way, and a place where nobody can write."""
    taken = tmp_path / "taken"
    taken.write_text("mine")
    for out in (taken, taken / "below", Path("/proc/franbv")):
        line = _one_line(capsys, "reconstruct", "--part", "A", "--out", str(out))
        assert str(out) in line
        assert "choose another folder" in line


def test_unknown_key_in_a_file(capsys: pytest.CaptureFixture[str], tmp_path: Path):
    """File, key and nearest key, at the top and inside a group."""
    file = tmp_path / "run.yaml"
    file.write_text("part: A\nparameters: {voxel_sise: 0.01}\n")
    line = _one_line(capsys, "reconstruct", "--config", str(file), "--out", str(tmp_path / "o"))
    assert f"{file}: unknown key `parameters.voxel_sise`; did you mean voxel_size" in line


def test_report_without_a_result(capsys: pytest.CaptureFixture[str], tmp_path: Path):
    """Missing folder, empty folder, a file, a damaged case: one line each."""
    (tmp_path / "case").mkdir()
    (tmp_path / "case" / "run.json").write_text("{")
    (tmp_path / "empty").mkdir()
    assert "no such folder" in _one_line(capsys, "report", str(tmp_path / "none"))
    assert "holds no finished reconstruction" in _one_line(capsys, "report", str(tmp_path / "empty"))
    assert "this is a file" in _one_line(capsys, "report", str(tmp_path / "case" / "run.json"))
    (tmp_path / "case" / "views").mkdir()
    assert "run.json: cannot be read" in _one_line(capsys, "report", str(tmp_path / "case"))


def test_debugging_shows_where_an_error_came_from(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    """The line stays the last one."""
    monkeypatch.setenv("FRANBV_DEBUG", "1")
    assert main(["report", "/no/such/folder"]) == 2
    err = capsys.readouterr().err
    assert err.startswith("Traceback")
    assert err.splitlines()[-1].startswith("franbv report: /no/such/folder: no such folder")


def test_open_mesh_is_a_notice_and_no_refusal(tmp_path: Path):
    """A box without its lid: the notice says that it is open, and the scene stands."""
    from studies.run.scene_settings import SubjectSettings, build_subject

    box = trimesh.creation.box((60, 40, 30))
    lid = box.face_normals[:, 2] < 0.5
    box.update_faces(lid)
    path = tmp_path / "open.stl"
    box.export(path)
    subject = build_subject(SubjectSettings(mesh=path, units="mm", material=(POLISHED,)))
    assert any("open" in notice for notice in subject.notices)
    assert len(subject.scene.part_bodies) == 1


WAIT_FOR_SIGNAL = """
import sys, time
from pathlib import Path
from studies.cli import main as cli
from studies.base.case_folder import writing
class Slow:
    def run(args):
        with writing(Path(args[0]), "abc") as folder:
            (folder / "half.txt").write_text("h")
            Path(args[0], "started").touch()
            time.sleep(60)
sys.modules["slow"] = Slow
cli.COMMANDS["slow"] = ("slow", "")
sys.exit(cli.main(["slow", sys.argv[1]]))
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_leave_no_half_written_case(tmp_path: Path, number: signal.Signals):
    """Ctrl-C and kill unwind the program: one line, the shells' exit status, nothing in the output folder."""
    deaf = ("sh", "-c", "trap '' INT; exec \"$@\"", "sh")  # as shells start background jobs
    command = [*deaf, sys.executable, "-c", WAIT_FOR_SIGNAL, str(tmp_path)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / "started").exists() and process.poll() is None:
        time.sleep(0.01)
    os.kill(process.pid, number)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 128 + number
    assert "takes the work up again" in err
    assert err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["started"]
