"""How far a reading's figures lie from the paper's: each divided by what is allowed, then their root mean square."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from studies.comparison.goals import ACTIVATION_SLACK, LEAD_SLACK, LEVEL_SLACK
from studies.comparison.paper import ACTIVATIONS, CONTRIBUTION, FINAL_COVERAGE, paper_lead


@dataclass(frozen=True)
class ReadFigure:
    """One of the figures by which a reading is held against the paper."""

    words: str
    short: str
    """For heads of columns."""
    allowed: float
    """Distance from the paper that counts as one, in the figure's own unit."""
    paper: Callable[[str], float]
    """The paper's median of a part."""
    scale: float
    """From the figure's own unit to that in which it is told: shares in points, counts as they are."""


READ_FIGURES: Mapping[str, ReadFigure] = {
    "fra": ReadFigure("coverage of FRA", "FRA", LEVEL_SLACK, lambda part: FINAL_COVERAGE[part]["fra"].median, 100.0),
    "pb": ReadFigure("coverage of PB", "PB", LEVEL_SLACK, lambda part: FINAL_COVERAGE[part]["pb"].median, 100.0),
    "lead": ReadFigure("FRA less PB", "FRA less PB", LEAD_SLACK, lambda part: paper_lead(part, "pb"), 100.0),
    "activations": ReadFigure(
        "recoveries a run", "recoveries", ACTIVATION_SLACK, lambda part: ACTIVATIONS[part].median, 1.0
    ),
    "contribution": ReadFigure(
        "brought by recovery", "brought", LEVEL_SLACK, lambda part: CONTRIBUTION[part].median, 100.0
    ),
}
"""Allowed is what the comparison's goals allow; what recovery brought is coverage, too. Medians over the starts,
coverage of the map [-]; the lead is median less median, as the paper tells it."""


def distance_term(figure: str, part: str, value: float) -> float:
    """The figure less the paper's, in what is allowed."""
    read = READ_FIGURES[figure]
    return (value - read.paper(part)) / read.allowed


def distance_of(terms: Iterable[float]) -> float:
    """Root mean square of the terms: 1 where each is as far off as is allowed; NaN where one is not known."""
    return float(np.sqrt(np.mean(np.square(list(terms)))))
