"""What every file of the corpus holds, or why it is refused: sizes, volumes, bodies and places from closed forms."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from tests.corpus.solids import Solid


@dataclass(frozen=True, eq=False)
class Truth:
    """One body."""

    low: np.ndarray
    """Lowest corner of its box, in the file's axes [mm]."""
    high: np.ndarray
    """Highest corner [mm]."""
    volume: float
    """[mm^3]."""
    slack: float = 0.0
    """Volume that the format leaves open [mm^3]: bent polygons may be cut either way, integers round."""


def truth(solid: Solid, slack: float = 0.0) -> Truth:
    """Of a solid as it stands."""
    return Truth(solid.low, solid.high, solid.volume, slack)


@dataclass(frozen=True, eq=False)
class Case:
    """A file of the corpus."""

    file: str
    trouble: str
    """What readers stumble over."""
    make: Callable[[], bytes]
    bodies: dict[str, Truth] = field(default_factory=dict)
    """By name; empty for a file that is refused."""
    refusal: str = ""
    """Words of the message."""
    notices: tuple[str, ...] = ()
    """Words of each notice, in order."""
    units: str | None = None
    """What a user states."""
    position_tolerance: float = 2e-5
    """[mm]; 32-bit metres and integers round."""
