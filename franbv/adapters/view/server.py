"""The viewer as a web page of this computer alone, served by a process of its own. Needs the extra `view`.

The package's functions `serve_grpc` and `serve_web_viewer` listen at every address of the computer (0.41); its program
can be told to listen at one.
"""

import contextlib
import os
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO
from urllib.parse import quote

import rerun as rr
import rerun_cli

from franbv.adapters.view.sight import ViewError

LOOPBACK = "127.0.0.1"
"""The only address at which the page can be had."""
START_S = 20.0
"""How long the server may take to listen [s] (choice: it takes half a second on an idle computer)."""
HAND_OVER_S = 5.0
"""How long the run waits at its end until the server has all of it [s]: a choice."""
STEP_S = 0.05
"""Between two looks whether it listens [s]: a choice."""
QUIET = {"CI": "true", "RERUN_APP_ONLY": "true", "RUST_LOG": "warn"}
"""Environment that keeps the program from counting its uses over the network (it does not where CI is set)."""


@dataclass(frozen=True)
class Page:
    """A page that is being served."""

    url: str
    """What to open in a browser."""
    data_url: str
    """Where the run's data go."""

    def hand_over(self, stream: rr.RecordingStream) -> None:
        """Wait until the server has what was drawn; a server that is gone is no reason to fail."""
        with contextlib.suppress(Exception):
            stream.flush(timeout_sec=HAND_OVER_S)
        stream.disconnect()


@contextlib.contextmanager
def serving() -> Iterator[Page]:
    """Serve as long as the block lasts; ViewError where the server does not start."""
    ports = free_ports(2)
    with tempfile.TemporaryFile() as said:
        server = subprocess.Popen(
            serve_command(*ports), env=os.environ | QUIET, stdin=subprocess.DEVNULL, stdout=said, stderr=said
        )
        try:
            _wait_until_it_listens(server, ports, said)
            data_url = f"rerun+http://{LOOPBACK}:{ports[0]}/proxy"
            yield Page(f"http://{LOOPBACK}:{ports[1]}/?url={quote(data_url, safe='')}", data_url)
        finally:
            server.terminate()
            server.wait()


def serve_command(data_port: int, page_port: int) -> list[str]:
    """What serves data and page."""
    ports = ["--port", str(data_port), "--web-viewer-port", str(page_port)]
    return [str(program()), "--serve-web", "--bind", LOOPBACK, *ports]


def program() -> Path:
    """The viewer's program in its package. Its Python command would start it and stay between it and us."""
    folder = Path(rerun_cli.__file__).parent
    places = (folder / "rerun", folder / "rerun.exe", folder / "Rerun.app" / "Contents" / "MacOS" / "Rerun")
    there = [place for place in places if place.is_file()]
    if not there:
        raise ViewError(f"{folder}: the viewer's program is missing; pip install --force-reinstall 'franbv[view]'")
    return there[0]


def free_ports(count: int) -> tuple[int, ...]:
    """Ports of LOOPBACK at which nobody listens."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind((LOOPBACK, 0))
        return tuple(one.getsockname()[1] for one in sockets)


def _wait_until_it_listens(server: subprocess.Popen, ports: tuple[int, ...], said: IO[bytes]) -> None:
    end = time.monotonic() + START_S
    while not all(map(listens, ports)):
        if server.poll() is not None or time.monotonic() > end:
            said.seek(0)
            words = " ".join(said.read().decode(errors="replace").split()) or "it says nothing"
            raise ViewError(f"the viewer's server did not start ({words}); leave out --view, or mend what it says")
        time.sleep(STEP_S)


def listens(port: int) -> bool:
    """Whether somebody does at this port of LOOPBACK."""
    with socket.socket() as probe:
        return probe.connect_ex((LOOPBACK, port)) == 0
