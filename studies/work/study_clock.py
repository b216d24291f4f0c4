"""Wall time that a study has taken over all the commands that worked on it, those that were killed included."""

import json
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from studies.base.atomic_file import write_atomically

BEGAN = "began.json"
"""Left in the study's folder while a command works on it: when it began, and what earlier ones had taken."""


@dataclass(frozen=True)
class StudyClock:
    """Runs while a command works on a study; it is started before the first job and stopped after the last."""

    out: Path
    """The study's folder."""
    earlier_s: float
    """What earlier commands took [s]."""
    began: float
    """Since the epoch [s]."""

    @classmethod
    def started(cls, out: Path, works: Sequence[Path], stored_s: float) -> "StudyClock":
        """A clock that goes on where the last one stopped, or where the process that it ran in was killed.

        works: folders into which the study's work goes; the last change of one of them, or of one below, is the last
        sign of life of a killed process. stored_s: what the study had taken when a command last came to its end [s].
        """
        earlier_s = stored_s
        if (out / BEGAN).exists():
            killed = json.loads((out / BEGAN).read_text())
            folders = [place for work in works for place, _, _ in os.walk(work)]
            last_seen = max((os.stat(folder).st_mtime for folder in folders), default=0.0)
            earlier_s = killed["earlier_s"] + max(0.0, last_seen - killed["began"])
        clock = cls(out, earlier_s, time.time())
        write_atomically(out / BEGAN, json.dumps({"earlier_s": earlier_s, "began": clock.began}).encode())
        return clock

    def elapsed_s(self) -> float:
        """All commands together, up to now [s]."""
        return self.earlier_s + time.time() - self.began

    def stop(self) -> None:
        """To be called when the time is stored elsewhere."""
        (self.out / BEGAN).unlink(missing_ok=True)
