"""Case folders: one name per configuration, complete or absent whatever ends the process."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from materials.input_error import InputError
from studies.base.atomic_file import file_digest, write_atomically
from studies.base.case_folder import PARTIAL_PREFIX, PROGRESS, case_digest, finished_case, writing
from studies.base.config import Config
from studies.base.output_errors import prepare_output


class Shape(Config):
    side: float = 0.1
    name: str = "cube"


def test_equal_configurations_have_one_name_and_any_change_has_another():
    """A hash names content: independent of how the model was built, different for every field and command."""
    names = {
        case_digest("frame", Shape()),
        case_digest("frame", Shape(side=0.1, name="cube")),
        case_digest("frame", Shape(side=0.2)),
        case_digest("frame", Shape(name="ball")),
        case_digest("reconstruct", Shape()),
    }
    assert len(names) == 4


def test_name_does_not_change_between_processes():
    """Python's own hash is salted per process, ours must not be: the name was made by an independent b2sum run."""
    # printf '{"command": "frame", "format": 1}{"name":"cube","side":0.1}' | b2sum -l 64
    assert case_digest("frame", Shape()) == "53cdcf038be545d7"


def test_finished_case_appears_whole(tmp_path: Path):
    """Nothing has the final name while the block runs; afterwards everything written is there."""
    with writing(tmp_path, "abc") as folder:
        (folder / "sub").mkdir()
        (folder / "sub" / "a.txt").write_text("a")
        assert finished_case(tmp_path, "abc") is None
    case = finished_case(tmp_path, "abc")
    assert case is not None
    assert (case / "sub" / "a.txt").read_text() == "a"
    assert [path.name for path in tmp_path.iterdir()] == ["abc"]


def _write_until(stop: type[BaseException], out: Path, *names: str) -> None:
    with writing(out, "abc") as folder:
        for name in names:
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_text(name)
        raise stop


@pytest.mark.parametrize("stop", [RuntimeError, KeyboardInterrupt, SystemExit])
def test_interrupted_case_leaves_nothing(tmp_path: Path, stop: type[BaseException]):
    """An exception of any kind, Ctrl-C included, removes what was begun."""
    with pytest.raises(stop):
        _write_until(stop, tmp_path, "half.txt")
    assert list(tmp_path.iterdir()) == []


def test_interrupted_case_keeps_complete_captures_for_the_next_process(tmp_path: Path):
    """Files in the progress folder are complete in themselves; they survive, the rest and temporary files do not."""
    with pytest.raises(KeyboardInterrupt):
        _write_until(
            KeyboardInterrupt, tmp_path, f"{PROGRESS}/000.npz", f"{PROGRESS}/.001.npz.tmp", "half.txt", "views/000.npz"
        )
    assert finished_case(tmp_path, "abc") is None
    with writing(tmp_path, "abc") as folder:
        assert [path.relative_to(folder).as_posix() for path in folder.rglob("*")] == [PROGRESS, f"{PROGRESS}/000.npz"]


WRITE_FOREVER = """
import sys, time
from pathlib import Path
from studies.base.case_folder import PROGRESS, writing
out = Path(sys.argv[1])
with writing(out, "abc") as folder:
    (folder / "half.txt").write_text("h")
    if sys.argv[2] == "progress":
        (folder / PROGRESS).mkdir()
        (folder / PROGRESS / "000.npz").write_bytes(b"complete")
    (out / "started").touch()
    time.sleep(60)
"""


def _kill_while_writing(out: Path, progress: bool) -> None:
    process = subprocess.Popen([sys.executable, "-c", WRITE_FOREVER, str(out), "progress" if progress else "none"])
    while not (out / "started").exists() and process.poll() is None:
        time.sleep(0.01)
    process.kill()
    process.wait()
    (out / "started").unlink()


def test_killed_case_has_no_final_name_and_can_be_written_again(tmp_path: Path):
    """After kill -9 only a dotted temporary folder is left; the same case starts clean in it."""
    _kill_while_writing(tmp_path, progress=False)
    assert [path.name for path in tmp_path.iterdir()] == [f"{PARTIAL_PREFIX}abc"]
    with writing(tmp_path, "abc") as folder:
        assert list(folder.iterdir()) == []
    assert [path.name for path in tmp_path.iterdir()] == ["abc"]


def test_another_case_clears_what_a_killed_one_left_unless_it_can_go_on(tmp_path: Path):
    """Abandoned folders do not pile up; the ones with progress wait for their own command."""
    _kill_while_writing(tmp_path, progress=False)
    with writing(tmp_path, "other"):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["other"]
    _kill_while_writing(tmp_path, progress=True)
    with writing(tmp_path, "third"):
        pass
    assert (tmp_path / f"{PARTIAL_PREFIX}abc" / PROGRESS / "000.npz").exists()


def test_two_processes_do_not_write_one_case(tmp_path: Path):
    """The second gets one line that says so, and disturbs nothing."""
    with writing(tmp_path, "abc") as folder:
        (folder / "a.txt").write_text("a")
        with pytest.raises(InputError, match="another process"), writing(tmp_path, "abc"):
            pass
        assert (folder / "a.txt").exists()


def test_output_that_is_a_file_is_refused(tmp_path: Path):
    """`--out` naming a file, or a folder below a file: thing, place, mend."""
    file = tmp_path / "taken"
    file.write_text("mine")
    for out in (file, file / "below"):
        with pytest.raises(InputError, match=r"taken.*not a folder; choose another folder"):
            prepare_output(out)
    assert file.read_text() == "mine"


def test_output_that_cannot_be_written_is_refused():
    """/proc takes no folders, whoever asks: even root, for whom permission bits do not count."""
    with pytest.raises(InputError, match=r"/proc/franbv: cannot write the output folder: .*choose another folder"):
        prepare_output(Path("/proc/franbv"))


def test_full_disk_is_one_line(tmp_path: Path):
    """The system's own error for a full disk, raised by /dev/full on every write."""

    def fill() -> None:
        with writing(tmp_path, "abc"), open("/dev/full", "wb", buffering=0) as file:
            file.write(b"x")

    with pytest.raises(InputError, match="disk is full; free some space"):
        fill()
    assert list(tmp_path.iterdir()) == []


def test_missing_input_file_is_not_blamed_on_the_output(tmp_path: Path):
    """Errors about other places pass through untouched."""
    with pytest.raises(FileNotFoundError), writing(tmp_path, "abc"):
        (tmp_path.parent / "no-such-file").read_bytes()


def test_interrupted_file_write_keeps_the_old_file(tmp_path: Path):
    """A file is replaced whole: a write that fails leaves the earlier content and no litter."""
    path = tmp_path / "run.json"
    write_atomically(path, b"old")
    with pytest.raises(TypeError):
        write_atomically(path, "text is not bytes")  # type: ignore[arg-type]
    assert path.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.json"]


def test_file_digest_follows_content(tmp_path: Path):
    """Two names with the same bytes give the same digest, one other byte gives another."""
    for name, content in (("a", b"mesh"), ("b", b"mesh"), ("c", b"mesh!")):
        (tmp_path / name).write_bytes(content)
    assert file_digest(tmp_path / "a") == file_digest(tmp_path / "b") != file_digest(tmp_path / "c")
