"""When a reconstruction ends: N_max iterations, or stagnation of the utility (paper, section VI)."""

from collections.abc import Sequence
from enum import StrEnum

import numpy as np

from franbv.parameters import Parameters


class StopReason(StrEnum):
    """The rule that ended a run; its value is what results hold.

    The first two are the paper's (section VI), the third is fra-robust's, the fourth is needed because an arm may reach
    none of the candidates, the last ends replays alone.
    """

    MAX_ITERATIONS = "max_iterations"
    """N_max next-best views were taken."""
    STAGNATION = "stagnation"
    """The best utility has stopped changing."""
    LITTLE_TO_GAIN = "little_to_gain"
    """The best views promise too little of the surface (fra-robust's own rule)."""
    NO_REACHABLE_VIEW = "no_reachable_view"
    """The arm reaches none of the candidates."""
    RECORDING_ENDED = "recording_ended"
    """A replay has used up the recorded bursts."""


def stop_reason(best_utilities: Sequence[float], parameters: Parameters) -> StopReason | None:
    """The rule that ends the run after these NBV iterations (first view and recoveries left out), or None.

    best_utilities: utility of the chosen view of each iteration so far [px^2].
    """
    if stagnates(
        best_utilities,
        parameters.stagnation_change,
        parameters.stagnation_iterations,
        parameters.stagnation_against == "last",
    ):
        return StopReason.STAGNATION
    if len(best_utilities) >= parameters.max_iterations:
        return StopReason.MAX_ITERATIONS
    return None


def stagnates(best_utilities: Sequence[float], change: float, iterations: int, against_last: bool = False) -> bool:
    """Whether each of the last `iterations` changes was below `change` of the largest absolute utility until then.

    Measured against the largest so far, because U crosses zero and a ratio to the last value would not settle.
    against_last: measure against the last one all the same.
    """
    u = np.asarray(best_utilities, float)
    if len(u) <= iterations:
        return False
    size = np.abs(u)[:-1] if against_last else np.maximum.accumulate(np.abs(u))[1:]
    small = np.abs(np.diff(u)) < change * size
    return bool(small[-iterations:].all())
