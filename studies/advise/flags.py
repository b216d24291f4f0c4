"""The flags of `franbv advise`."""

from dataclasses import dataclass
from pathlib import Path

from studies.advise.settings import AdviseSettings
from studies.base.flags import CaseCommand


@dataclass(frozen=True)
class AdviseCommand(CaseCommand[AdviseSettings]):
    """What is advised on, and how long it may take."""

    out: Path
    """Output folder. What is rendered and counted in it is not done again, so that the same command goes on where it
    was stopped."""
    minutes: float = 5.0
    """Time that all commands on this folder may take together; spray, and what needs no new light, are
    tried at two poses whatever it is."""
