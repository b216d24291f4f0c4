"""The question before each motion."""

import select
import sys
from collections.abc import Callable
from dataclasses import dataclass

from franbv.adapters.live.guarded_arm import Motion
from franbv.adapters.live.switch import StopSwitch


@dataclass
class Confirm:
    """Shows a motion, and asks whether it may be made."""

    switch: StopSwitch
    asks: bool
    """Whether a person must say yes; else the motion is shown alone."""
    begin: Callable[[], None]
    """Called when it may."""
    say: Callable[[str], None]

    def __call__(self, motion: Motion) -> bool:
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
            sys.stdout.write("move? [y]es, [n]o: another pose, [q]uit: ")
            sys.stdout.flush()
            while self.switch.why is None and not select.select([sys.stdin], [], [], 0.1)[0]:
                pass
            said = "q" if self.switch.why is not None else sys.stdin.readline()
            if not said:
                return "q"
            if said.strip().lower()[:1] in ("y", "n", "q"):
                return said.strip().lower()[:1]
        return "q"
