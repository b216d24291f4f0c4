"""The question before each motion."""

import os
import select
import sys
from collections.abc import Callable
from dataclasses import dataclass

from franbv.adapters.live.guarded_arm import ShownMotion
from franbv.adapters.live.switch import StopSwitch

_LOOK_EVERY_S = 0.1
"""For an answer [s] (choice)."""


@dataclass
class Confirm:
    """Shows a motion, and asks whether it may be made."""

    switch: StopSwitch
    asks: bool
    """Whether a person must say yes; else the motion is shown alone."""
    begin: Callable[[], None]
    """Called when it may."""
    say: Callable[[str], None]
    ask: Callable[[str], None]

    def __call__(self, motion: ShownMotion) -> bool:
        self.say(motion.sentence())
        answer = self._answer() if self.asks else "y"
        if answer == "q":
            self.switch.press("stopped at the question")
            return False
        self.begin()
        return answer == "y"

    def _answer(self) -> str:
        """y, n or q; q where nobody can answer."""
        while self.switch.why is None:
            self.ask("move? [y]es, [n]o: another pose, [q]uit: ")
            said = self._line()
            if said is None:
                return "q"
            if said.strip().lower()[:1] in ("y", "n", "q"):
                return said.strip().lower()[:1]
        return "q"

    def _line(self) -> str | None:
        """What a person types; None at the end of the input, or when the switch is pressed.

        Byte by byte, so that nothing is read ahead into a buffer in which `select` does not look.
        """
        number, said = sys.stdin.fileno(), b""
        while not said.endswith(b"\n"):
            if self.switch.why is not None:
                return None
            if select.select([number], [], [], _LOOK_EVERY_S)[0]:
                byte = os.read(number, 1)
                if not byte:
                    return None
                said += byte
        return said.decode(errors="replace")
