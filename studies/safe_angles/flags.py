"""The flags of `franbv safe-angles`."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from studies.base.flags import CaseCommand
from studies.safe_angles.settings import SafeAnglesSettings
from studies.work.executor import WorkFlags


@dataclass(frozen=True)
class SafeAnglesCommand(CaseCommand[SafeAnglesSettings]):
    """What is measured, what is asked of it, and who does it."""

    out: Path
    """Output folder. Views that are measured in it are not measured again."""
    share: float = 0.95
    """Of the surface that must have right depth, above 0 and below 1."""
    confidence: float = 0.9
    """Of each lower bound, above 0 and below 1."""
    work: Annotated[WorkFlags, tyro.conf.arg(name="")] = field(default_factory=WorkFlags)
