"""A second process that stops the arm when the first one falls silent while the arm moves: killed, hung, swapped out.

It holds a connection of its own to the arm, and listens on its standard input: `moving`, then `beat` again and again,
then `resting`. An end of the input or silence while moving means that nobody watches the arm any more.

    python -m franbv.adapters.live.keeper '{"kind": "ros", "settings": {...}}'
"""

import contextlib
import json
import os
import select
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from typing import Any

from franbv.adapters.arms.driver import ArmDriver, ArmError
from franbv.adapters.arms.opening import open_arm

SILENCE_S = 0.5
"""After which the arm is stopped [s] (choice: ten missed beats; at 0.25 m/s the camera goes 13 cm)."""
READY = "ready"
"""What the keeper says once it holds its connection."""
_MOVING, _BEAT, _RESTING = b"moving\n", b"beat\n", b"resting\n"
_START_S = 30.0
"""Within which the keeper must be ready [s] (choice: a connection over a slow network, Python's start)."""
_STOPS = 3
"""Times that the arm is told to stop (choice: a message may be lost)."""


class Keeper:
    """The first process's end: starts the second one, and tells it that all is well."""

    def __init__(self, kind: str, settings: Mapping[str, Any]) -> None:
        """Start it and wait until it holds the arm; ArmError if it does not."""
        said = json.dumps({"kind": kind, "settings": dict(settings)})
        command = [sys.executable, "-m", "franbv.adapters.live.keeper", said]
        # A session of its own: a key or signal that ends the run does not end the keeper before it has done its work.
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True, bufsize=0
        )
        assert self._process.stdout is not None
        answer = b""
        if select.select([self._process.stdout], [], [], _START_S)[0]:
            answer = self._process.stdout.readline()
        if answer.strip() != READY.encode():
            self.close()
            why = answer.decode(errors="replace").strip() or "no answer"
            raise ArmError(f"the second connection to the arm, which stops it if this program dies, failed: {why}")

    def beat(self) -> None:
        """All is well; ArmError if nobody listens any more."""
        self._say(_BEAT)

    @contextlib.contextmanager
    def moving(self) -> Iterator[None]:
        """The arm moves as long as the block lasts; `beat` must be called in it."""
        self._say(_MOVING)
        try:
            yield
        finally:
            with contextlib.suppress(ArmError):
                self._say(_RESTING)

    def _say(self, word: bytes) -> None:
        try:
            assert self._process.stdin is not None
            self._process.stdin.write(word)
        except (OSError, ValueError):
            raise ArmError("the process that stops the arm if this program dies has ended; start again") from None

    def close(self) -> None:
        """End it; may be called twice."""
        if self._process.stdin is not None:
            with contextlib.suppress(OSError):
                self._process.stdin.close()
        try:
            self._process.wait(timeout=SILENCE_S + 2.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()


class NoKeeper:
    """Where nothing of ours moves the arm, so that nobody needs to be told."""

    @contextlib.contextmanager
    def moving(self) -> Iterator[None]:
        """Nothing."""
        yield

    def beat(self) -> None:
        """Nothing."""

    def close(self) -> None:
        """Nothing."""


def keep(driver: ArmDriver, listening: int) -> int:
    """Listen on a file descriptor until it ends; whether the arm had to be stopped, as a count."""
    moving, heard, stopped = False, b"", 0
    while True:
        there = select.select([listening], [], [], SILENCE_S if moving else None)[0]
        said = os.read(listening, 4096) if there else b""
        if not said:
            if moving:
                _stop(driver)
                stopped += 1
            if there:
                return stopped
            moving = False  # stopped once; whoever is silent must say `moving` again
            continue
        heard += said
        words, _, heard = heard.rpartition(b"\n")
        for word in words.split(b"\n"):
            if word + b"\n" in (_MOVING, _RESTING):
                moving = word + b"\n" == _MOVING


def _stop(driver: ArmDriver) -> None:
    """Told from a thread for each try, so that one that hangs does not keep back the next."""
    for _ in range(_STOPS):
        thread = threading.Thread(target=driver.stop, daemon=True)
        thread.start()
        thread.join(timeout=SILENCE_S)


def keep_arm(said: str) -> int:
    """Hold the arm that is described and keep it; exit status 0, or 1 where it cannot be held."""
    stated = json.loads(said)
    try:
        driver = open_arm(stated["kind"], stated["settings"])
    except ArmError as error:
        sys.stdout.write(f"{error}\n")
        return 1
    sys.stdout.write(f"{READY}\n")
    sys.stdout.flush()
    keep(driver, sys.stdin.fileno())
    return 0


if __name__ == "__main__":
    sys.exit(keep_arm(sys.argv[1]))
