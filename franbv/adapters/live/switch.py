"""The stop switch of a run: a key, a signal, or whoever presses it. Once pressed it stays so."""

import contextlib
import select
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

try:
    import termios
    import tty
except ImportError:  # Windows
    termios = tty = None

_LOOK_EVERY_S = 0.05
"""For a key [s] (choice: faster than a finger)."""


class StoppedError(Exception):
    """The run was stopped by a person; the message says how."""


class StopSwitch:
    """Pressed by any key while the arm moves, by Ctrl-C, and by SIGTERM or a closed terminal."""

    def __init__(self) -> None:
        self.why: str | None = None
        """Who pressed it; None while nobody has."""
        self._then: list[Callable[[], None]] = []

    def press(self, why: str) -> None:
        """Press it; from any thread, again and again. What was asked for with `on_press` is done at once."""
        self.why = self.why or why
        for action in tuple(self._then):
            action()

    @contextlib.contextmanager
    def on_press(self, action: Callable[[], None]) -> Iterator[None]:
        """Do this when it is pressed, as long as the block lasts; action may not raise."""
        self._then.append(action)
        try:
            yield
        finally:
            self._then.remove(action)

    def check(self) -> None:
        """StoppedError if it was pressed."""
        if self.why is not None:
            raise StoppedError(self.why)

    @contextlib.contextmanager
    def at_signals(self) -> Iterator[None]:
        """Let signals press it; in the main thread alone."""
        names = [name for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
        before = {name: signal.signal(getattr(signal, name), self._of_signal) for name in names}
        try:
            yield
        finally:
            for name, handler in before.items():
                signal.signal(getattr(signal, name), handler)

    def _of_signal(self, number: int, frame: FrameType | None) -> None:
        self.why = self.why or f"stopped by {signal.Signals(number).name}"
        # In a thread of its own: what the signal interrupts may hold the very lock that telling the arm needs.
        threading.Thread(target=self.press, args=(self.why,), daemon=True).start()

    @contextlib.contextmanager
    def at_keys(self, keys: Any = None) -> Iterator[None]:
        """Let any key press it, where there is a keyboard; keys: a terminal, standard input by default."""
        terminal = sys.stdin if keys is None else keys
        if termios is None or tty is None or not _is_terminal(terminal):  # signals alone
            yield
            return
        number = terminal.fileno()
        saved = termios.tcgetattr(number)
        over = threading.Event()
        watch = threading.Thread(target=self._watch, args=(number, over), daemon=True)
        try:
            tty.setcbreak(number)
            watch.start()
            yield
        finally:
            over.set()
            watch.join()
            termios.tcsetattr(number, termios.TCSADRAIN, saved)

    def _watch(self, number: int, over: threading.Event) -> None:
        while not over.is_set():
            if select.select([number], [], [], _LOOK_EVERY_S)[0]:
                self.press("stopped by a key")
                return


def _is_terminal(file: Any) -> bool:
    try:
        return bool(file.isatty())
    except ValueError:  # closed
        return False
