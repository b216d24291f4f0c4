"""What several starts reached together: mean, interval and spread of each figure, for machines and in one paragraph."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from franbv.known_planners import PLANNERS
from studies.base.numbers_as_text import counted, percent
from studies.run.acquisition_table import MAP_COVERAGE, RAW_COVERAGE
from studies.run.starts.runs import FinishedStart
from studies.statistics.intervals import mean_interval

WHY_MANY = (
    "One run says little: a change of 1e-7 in an image lets the views diverge, so that another start, or another "
    "processor, gives another run."
)
"""Said wherever several starts are."""


@dataclass(frozen=True)
class Spread:
    """One figure over the runs that have it."""

    mean: float
    low: float
    """Lower end of the mean's 95 % interval (`studies.statistics.intervals`); the mean itself for one run."""
    high: float
    sd: float | None
    """Standard deviation of single runs, estimated from n - 1; None for one run."""
    min: float
    max: float
    runs: int


def spread_of(values: Sequence[float]) -> Spread:
    """Of at least one value."""
    interval = mean_interval(values)
    sd = float(np.std(values, ddof=1)) if len(values) > 1 else None
    return Spread(interval.mean, interval.low, interval.high, sd, min(values), max(values), len(values))


def figure_spreads(finished: Sequence[FinishedStart]) -> dict[str, Spread]:
    """Of every number in the summaries of the runs; a run that lacks one is left out of that one."""
    found: dict[str, list[float]] = {}
    for one in finished:
        for name, value in one.summary.items():
            if isinstance(value, int | float):
                found.setdefault(name, []).append(float(value))
    return {name: spread_of(values) for name, values in found.items()}


def starts_json(finished: Sequence[FinishedStart], planned: int) -> dict[str, Any]:
    """The object that `--json` prints: shares as fractions, lengths in millimetres; null where no run is finished."""
    figures = figure_spreads(finished)
    headline = figures.get(MAP_COVERAGE)
    return {
        "starts": planned,
        "runs": len(finished),
        MAP_COVERAGE: headline.mean if headline else None,
        "coverage_map_ci95": [headline.low, headline.high] if headline else None,
        "figures": {name: asdict(figure) for name, figure in figures.items()},
        "cases": [
            {
                "case": one.start.digest,
                "azimuth_deg": one.start.config.azimuth_deg,
                "seed": one.start.config.seed,
                **one.summary,
            }
            for one in finished
        ],
        "processor_s": sum(one.stored.timings["processor_s"] for one in finished),
    }


def starts_paragraph(finished: Sequence[FinishedStart], planned: int) -> str:
    """What the starts reached, and why they are many."""
    if not finished:
        return f"None of {counted(planned, 'start')} came to its end."
    figures = figure_spreads(finished)
    mapped, brought = figures[MAP_COVERAGE], figures["recovery_contribution"]
    name = finished[0].start.config.planner
    planner = PLANNERS[name].words if name in PLANNERS else name
    missing = f" of {planned}" if len(finished) < planned else ""
    deviation = "" if mapped.sd is None else f"; single runs have a standard deviation of {100 * mapped.sd:.1f} points"
    activations = figures["recovery_activations"].mean
    sentences = [
        f"Over {counted(len(finished), 'start')}{missing} of {planner} the map holds {percent(mapped.mean)} of the "
        f"visible surface to within 5 mm on average (95 % interval {100 * mapped.low:.1f} to {percent(mapped.high)}"
        f"{deviation} and reach from {100 * mapped.min:.1f} to {percent(mapped.max)}).",
        f"If all points ever seen count it is {percent(figures[RAW_COVERAGE].mean)}.",
        f"A run had {activations:.1f} recoveries on average, whose views changed the map's coverage by "
        f"{100 * brought.mean:+.1f} points."
        if activations
        else "No reflective region started a recovery.",
        WHY_MANY,
    ]
    return " ".join(sentences)
