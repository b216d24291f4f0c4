"""What the cells of a study of readings measured, what each decision moves by it, and which readings come out of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from studies.comparison.records import CONTRIBUTED, MAP_COVERAGE, Record
from studies.comparison.statistics import Comparison
from studies.readings.decisions import DECISIONS
from studies.readings.design import DesignCell, design_cells, level_signs
from studies.readings.distance import READ_FIGURES, distance_of, distance_term
from studies.readings.effects import Effect, effects_of
from studies.readings.runs import cell_arm


class Response(NamedTuple):
    """What a cell gives: a figure of a part, or the distance from the paper over all parts."""

    part: str
    """Empty: all."""
    figure: str


DISTANCE = Response("", "distance")
"""The last response of every analysis."""


@dataclass(frozen=True, eq=False)
class Analysis:
    """Figures of all cells, and what follows from them."""

    parts: tuple[str, ...]
    single: Float[np.ndarray, "cells starts responses"]
    """Of each start alone; NaN where a run is missing."""
    measured: Float[np.ndarray, "cells responses"]
    """Of each cell: medians over its starts, and the distance of these medians; NaN where there is none."""

    @property
    def responses(self) -> list[Response]:
        """The last axis."""
        return responses_of(self.parts)

    @cached_property
    def cells(self) -> tuple[DesignCell, ...]:
        """The first axis."""
        return design_cells()

    @property
    def is_complete(self) -> bool:
        """Whether every cell has every figure, so that effects can be told."""
        return bool(np.isfinite(self.measured).all())

    @cached_property
    def effects(self) -> dict[Response, dict[str, Effect]]:
        """By decision; none before every cell has all its figures."""
        if not self.is_complete:
            return {}
        names = [decision.name for decision in DECISIONS]
        return {
            response: dict(
                zip(names, effects_of(level_signs(), self.measured[:, k], self.single[:, :, k]), strict=True)
            )
            for k, response in enumerate(self.responses)
        }

    def figures(self, cell: int) -> dict[Response, float]:
        """What one cell measured."""
        return dict(zip(self.responses, self.measured[cell].tolist(), strict=True))

    def n_starts(self, cell: int) -> int:
        """Starts of which the cell has all figures."""
        return int(np.isfinite(self.single[cell]).all(axis=1).sum())

    @property
    def sure(self) -> list[str]:
        """Decisions whose effect on the distance exceeds its margin, the largest first."""
        effects = self.effects.get(DISTANCE, {})
        found = [name for name, effect in effects.items() if effect.is_sure]
        return sorted(found, key=lambda name: -abs(effects[name].value))

    @property
    def best(self) -> frozenset[str]:
        """Decisions at their second level in the reading that is predicted to come nearest: those alone whose second
        level lowers the distance by more than its margin."""
        effects = self.effects[DISTANCE]
        return frozenset(name for name in self.sure if effects[name].value < 0)

    def predicted(self, second: frozenset[str]) -> dict[Response, float]:
        """What a linear model of the decisions that are sure says of a reading; the others count as without effect."""
        means = self.measured.mean(axis=0)
        return {
            response: float(
                means[k]
                + sum((0.5 if name in second else -0.5) * self.effects[response][name].value for name in self.sure)
            )
            for k, response in enumerate(self.responses)
        }

    @property
    def nearest_cell(self) -> DesignCell:
        """The cell that measured the smallest distance."""
        return self.cells[int(np.argmin(self.measured[:, -1]))]


def responses_of(parts: Sequence[str]) -> list[Response]:
    """All figures of all parts, then the distance."""
    return [*(Response(part, figure) for part in parts for figure in READ_FIGURES), DISTANCE]


def analysed(comparison: Comparison, parts: Sequence[str], n_starts: int) -> Analysis:
    """The runs of all cells, by the arms of `studies.readings.runs`."""
    cells = design_cells()
    single = np.full((len(cells), n_starts, len(responses_of(parts))), np.nan)
    for cell in cells:
        for k, response in enumerate(responses_of(parts)[:-1]):
            for start, value in _of_starts(comparison, cell, response).items():
                single[cell.number, start, k] = value
    single[:, :, -1] = _distances(single[:, :, :-1], parts)
    measured = np.array([_medians(rows, parts) for rows in single])
    return Analysis(tuple(parts), single, measured)


def _of_starts(comparison: Comparison, cell: DesignCell, response: Response) -> dict[int, float]:
    """One figure of each start that has it."""
    arms = {planner: cell_arm(planner, cell) for planner in ("fra", "pb")}

    def of_runs(planner: str, name: str) -> dict[int, float]:
        return {run.run: _figure(run, name) for run in comparison.runs(response.part, arms[planner])}

    match response.figure:
        case "fra" | "pb" as planner:
            return of_runs(planner, MAP_COVERAGE)
        case "activations":
            return of_runs("fra", "recovery_activations")
        case "contribution":
            return of_runs("fra", CONTRIBUTED)
    return {
        a.run: _figure(a, MAP_COVERAGE) - _figure(b, MAP_COVERAGE)
        for a, b in comparison.pairs(response.part, arms["fra"], arms["pb"])
    }


def _figure(run: Record, name: str) -> float:
    return float(run.summary[name])


def _distances(figures: Float[np.ndarray, "cells starts figures"], parts: Sequence[str]) -> np.ndarray:
    """Of each start alone."""
    of_paper = responses_of(parts)[:-1]
    return np.array(
        [
            [
                distance_of(distance_term(r.figure, r.part, value) for r, value in zip(of_paper, row, strict=True))
                for row in rows
            ]
            for rows in figures
        ]
    )


def _medians(rows: Float[np.ndarray, "starts responses"], parts: Sequence[str]) -> list[float]:
    """Of one cell: medians over the starts that a figure has, the lead of those that both planners have."""
    found: dict[Response, float] = {}
    columns = dict(zip(responses_of(parts), rows.T, strict=True))
    for response, column in columns.items():
        if response == DISTANCE:
            terms = [distance_term(r.figure, r.part, value) for r, value in found.items()]
            found[response] = distance_of(terms)
        elif response.figure == "lead":
            both = np.isfinite(column)
            medians = [np.median(columns[Response(response.part, arm)][both]) if both.any() else np.nan
                       for arm in ("fra", "pb")]  # fmt: skip
            found[response] = float(medians[0] - medians[1])
        else:
            known = column[np.isfinite(column)]
            found[response] = float(np.median(known)) if len(known) else np.nan
    return list(found.values())
