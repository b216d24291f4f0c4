"""What reports call the methods of a comparison: the paper's by its capitals, others by their own names."""

from studies.comparison.paper import PAPER_METHODS
from studies.run.ablation import ABLATIONS


def method_name(arm: str) -> str:
    """`FRA`, `fra-robust`, `PB, map of fra-robust`."""
    if arm in ABLATIONS:
        return ABLATIONS[arm].words
    return arm.upper() if arm in PAPER_METHODS else arm
