"""Rows of the tables about decisions, cells, effects and candidates."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from studies.drawing.cells import NO_NUMBER, signs
from studies.readings.analysis import DISTANCE, Analysis, Response, responses_of
from studies.readings.candidates import PROPOSED, Candidate, preset_file
from studies.readings.decisions import DECISIONS
from studies.readings.design import COLUMN, FIVE, mixed_with
from studies.readings.distance import READ_FIGURES


def decision_rows() -> list[dict[str, Any]]:
    """What the paper leaves open, its two levels, who reads it and what its effect is mixed with."""
    return [
        {
            "name": decision.name,
            "question": decision.question,
            "first": decision.first,
            "second": decision.second,
            "silent": decision.silent,
            "reads": "FRA" if decision.of_recovery else "all",
            "column": COLUMN[decision.name],
            "mixed": "" if decision.name in FIVE else " with ".join(mixed_with(decision.name)[0]),
        }
        for decision in DECISIONS
    ]


def cell_rows(analysis: Analysis) -> list[dict[str, Any]]:
    """The paper's figures, then every cell, the nearest first; cells without figures last."""
    responses = responses_of(analysis.parts)
    paper = {r: READ_FIGURES[r.figure].paper(r.part) for r in responses if r != DISTANCE} | {DISTANCE: 0.0}
    order = sorted(analysis.cells, key=lambda cell: _nan_last(analysis.measured[cell.number, -1]))
    return [
        {"cell": "paper", "second": "", "starts": "15", "figures": figure_cells(paper, responses), "paper": True},
        *(
            {
                "cell": str(cell.number),
                "second": listed(cell.second),
                "starts": str(analysis.n_starts(cell.number)),
                "figures": figure_cells(analysis.figures(cell.number), responses),
                "paper": False,
            }
            for cell in order
        ),
    ]


def effect_table(analysis: Analysis) -> list[dict[str, Any]]:
    """A row per decision, the one that moves the distance most first: its effect on each response."""
    if not analysis.effects:
        return []
    on_distance = analysis.effects[DISTANCE]
    order = sorted(on_distance, key=lambda name: -abs(on_distance[name].value))
    rows = []
    for name in order:
        told = []
        for response in analysis.responses:
            effect = analysis.effects[response][name]
            scale, form = telling(response, "+")
            told.append((signs(f"{scale * effect.value:{form}}"), effect.is_sure, effect.stands_out))
        rows.append({"name": name, "effects": told})
    return rows


def margin_rows(analysis: Analysis) -> list[tuple[str, list[str]]]:
    """Below the effects: the margins of each response, which are the same for all decisions."""
    rows: dict[str, list[str]] = {"margin": [], "Lenth\u2019s margin": []}
    for response, effects in analysis.effects.items():
        scale, form = telling(response)
        effect = next(iter(effects.values()))
        for told, margin in zip(rows.values(), (effect.margin, effect.lenth_margin), strict=True):
            told.append(NO_NUMBER if margin is None else f"{scale * margin:{form}}")
    return list(rows.items())


def candidate_rows(candidates: Sequence[Candidate], parts: Sequence[str]) -> list[dict[str, Any]]:
    """Each reading, what is predicted of it and, where it was a cell, what it measured."""
    responses = responses_of(parts)
    return [
        {
            "name": one.name,
            "words": PROPOSED[one.name],
            "second": listed(one.second),
            "cell": NO_NUMBER if one.cell is None else str(one.cell),
            "predicted": figure_cells(one.predicted, responses),
            "measured": figure_cells(one.measured, responses) if one.measured else [NO_NUMBER] * len(responses),
            "file": preset_file(one.name),
        }
        for one in candidates
    ]


def figure_cells(figures: Mapping[Response, float], responses: Sequence[Response]) -> list[str]:
    """The figures as the tables write them."""
    told = []
    for response in responses:
        scale, form = telling(response)
        value = scale * figures[response]
        told.append(signs(format(value, form)) if math.isfinite(value) else NO_NUMBER)
    return told


def telling(response: Response, sign: str = "") -> tuple[float, str]:
    """Scale and form in which a response is written."""
    if response == DISTANCE:
        return 1.0, f"{sign}z.2f"
    return READ_FIGURES[response.figure].scale, f"{sign}z.1f"


def listed(second: frozenset[str]) -> str:
    """In the order of the decisions."""
    return ", ".join(decision.name for decision in DECISIONS if decision.name in second) or "none"


def _nan_last(value: float) -> float:
    return math.inf if math.isnan(value) else value
