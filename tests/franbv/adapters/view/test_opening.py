"""Files that are there whole or not at all, pages of this computer alone, and one line for what is missing."""

import os
import socket
from pathlib import Path

import psutil
import pytest

from franbv.adapters.__main__ import run as adapters
from franbv.adapters.view.opening import check_rrd, live_page, rrd_file
from franbv.adapters.view.sight import ViewError
from tests.franbv.adapters.recording.recorded_run import PARAMETERS
from tests.franbv.adapters.test_alone import without
from tests.franbv.adapters.view.conftest import run_before

MISSING = "views need the package rerun-sdk; pip install 'franbv[view]'"


def test_importing_loads_no_viewer():
    """Not for the commands, nor for what a run is handed to."""
    done = without(
        ("rerun", "rerun_bindings", "rerun_cli"),
        """
        import franbv.adapters.__main__, franbv.adapters.view.opening, franbv.adapters.view.shapes
        import studies.cli.report, studies.cli.reconstruct, studies.cli.replay
        print("fine")
        """,
    )
    assert done.stdout.strip() == "fine", done.stderr


def test_a_missing_package_is_one_line(recorded_file: Path, tmp_path: Path):
    """The extra is named, and nothing is written."""
    done = without(
        ("rerun", "rerun_bindings", "rerun_cli"),
        f"""
        from franbv.adapters.__main__ import run
        sys.exit(run(["replay", {str(recorded_file)!r}, "--rrd", {str(tmp_path / "a.rrd")!r}]))
        """,
    )
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"franbv.adapters: {MISSING}\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("page", [True, False])
def test_the_same_of_the_library(page: bool):
    """Live and as a file."""
    opened = "live_page('Box', 0.5, print)" if page else "rrd_file(Path('a.rrd'), 'Box', 0.5)"
    done = without(
        ("rerun", "rerun_bindings", "rerun_cli"),
        f"""
        from pathlib import Path
        from franbv.adapters.view.opening import live_page, rrd_file
        from franbv.adapters.view.sight import ViewError
        try:
            with {opened}:
                pass
        except ViewError as error:
            print(error)
        """,
    )
    assert done.stdout == f"{MISSING}\n", done.stderr


class TestFile:
    """`rrd_file`."""

    @pytest.fixture(autouse=True)
    def _needs_the_viewer(self):
        pytest.importorskip("rerun")

    def test_nothing_is_written_over(self, tmp_path: Path):
        """What is there stays, byte for byte, whether it was there before or came while the run lasted."""
        path = tmp_path / "run.rrd"
        with pytest.raises(ViewError, match="is there already, and is never written over"), rrd_file(path, "Box", 0.5):
            path.write_text("mine")
        assert (path.read_text(), list(tmp_path.iterdir())) == ("mine", [path])
        with pytest.raises(ViewError, match="is there already"), rrd_file(path, "Box", 0.5):
            pass
        assert path.read_text() == "mine"

    def test_a_run_that_fails_leaves_nothing(self, tmp_path: Path):
        """Neither a file nor a part of one."""
        with pytest.raises(ZeroDivisionError), rrd_file(tmp_path / "run.rrd", "Box", 0.5):
            raise ZeroDivisionError
        assert list(tmp_path.iterdir()) == []

    def test_a_full_disk_is_one_line(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
        """And leaves nothing."""

        def full(descriptor: int) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(os, "fsync", full)
        with (
            pytest.raises(ViewError, match=r"run\.rrd: cannot be written \(No space left on device\)"),
            rrd_file(tmp_path / "run.rrd", "Box", 0.5),
        ):
            pass
        assert list(tmp_path.iterdir()) == []

    def test_what_could_not_be_written_is_refused_at_once(self, tmp_path: Path):
        """Another kind of file, a folder that is not there."""
        with pytest.raises(ViewError, match=r"a\.mcap: the viewer knows its files by \.rrd"):
            check_rrd(tmp_path / "a.mcap")
        with pytest.raises(ViewError, match="there is no folder"):
            check_rrd(tmp_path / "none" / "a.rrd")

    def test_a_viewer_that_is_turned_off_is_told(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
        """RERUN=off would make an empty file."""
        monkeypatch.setenv("RERUN", "off")
        with pytest.raises(ViewError, match="RERUN in the environment"), rrd_file(tmp_path / "run.rrd", "Box", 0.5):
            pass


class TestPage:
    """`live_page`."""

    @pytest.fixture(autouse=True)
    def _needs_the_viewer(self):
        pytest.importorskip("rerun")

    def test_it_listens_on_this_computer_alone_and_ends_with_the_run(self):
        """Every socket at which the run and its server listen is of 127.0.0.1; afterwards there is none."""
        urls: list[str] = []
        before = {child.pid for child in psutil.Process().children(recursive=True)}
        with live_page("Box", PARAMETERS.invalid_share, urls.append) as view:
            run_before(view.observe)
            family = [psutil.Process(), *psutil.Process().children(recursive=True)]
            own = [one for one in family if one.pid not in before]
            listening = [c.laddr for one in own for c in one.net_connections() if c.status == psutil.CONN_LISTEN]
            assert len(listening) == 2
            assert {address.ip for address in listening} == {"127.0.0.1"}
            assert {urls[0].split("/?url=")[0]} <= {f"http://127.0.0.1:{address.port}" for address in listening}
        assert {child.pid for child in psutil.Process().children(recursive=True)} <= before
        for address in listening:
            with socket.socket() as probe:
                assert probe.connect_ex((address.ip, address.port)) != 0

    def test_a_run_that_fails_ends_it_too(self):
        """No server stays behind."""
        before = {child.pid for child in psutil.Process().children(recursive=True)}
        with pytest.raises(ZeroDivisionError), live_page("Box", 0.5, lambda url: None):
            raise ZeroDivisionError
        assert {child.pid for child in psutil.Process().children(recursive=True)} <= before

    def test_a_server_that_dies_does_not_end_the_run(self):
        """The run is worth more than its picture."""
        with live_page("Box", PARAMETERS.invalid_share, lambda url: None) as view:
            server = next(c for c in psutil.Process().children() if c.name() == "rerun")
            server.kill()
            server.wait()
            run = run_before(view.observe)
        assert len(run.acquisitions) > 1

    def test_a_server_that_does_not_start_says_why(self, monkeypatch: pytest.MonkeyPatch):
        """Its own words, in one line."""
        from franbv.adapters.view import server

        with socket.socket() as taken:
            taken.bind((server.LOOPBACK, 0))
            port = taken.getsockname()[1]
            monkeypatch.setattr(server, "serve_command", lambda *ports: [str(server.program()), "--no-such-flag"])
            monkeypatch.setattr(server, "free_ports", lambda count: (port, port))
            with (
                pytest.raises(ViewError, match=r"the viewer's server did not start \(.*no-such-flag") as error,
                live_page("Box", 0.5, lambda url: None),
            ):
                pass
        assert "\n" not in str(error.value)


def test_the_adapters_replay_writes_a_file(recorded_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """As many points at every step as the replayed run took; a second time it is refused."""
    pytest.importorskip("rerun")
    from tests.franbv.adapters.view.rrd_reading import counts, drawn, verified

    path = tmp_path / "replay.rrd"
    assert adapters(["replay", str(recorded_file), "--rrd", str(path)]) == 0
    run = run_before(lambda acquisition: None)
    found = drawn(path)
    assert verified(path).startswith("0: ")
    assert counts(found, "/world/cloud:Points3D:positions") == [len(a.points) for a in run.acquisitions]
    assert sorted(found["/infrared:Image:buffer"]) == [a.index for a in run.acquisitions if a.index % 2 == 0]
    capsys.readouterr()
    assert adapters(["replay", str(recorded_file), "--rrd", str(path)]) == 2
    assert "is there already, and is never written over" in capsys.readouterr().err
