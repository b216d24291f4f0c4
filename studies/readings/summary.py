"""A study of readings in numbers for machines, and in one paragraph for people."""

from collections.abc import Mapping, Sequence
from typing import Any

from studies.base.numbers_as_text import counted
from studies.readings.analysis import DISTANCE, Analysis, Response
from studies.readings.candidates import Candidate, preset_file
from studies.readings.decisions import DECISIONS, decided
from studies.readings.design import N_CELLS
from studies.readings.distance import READ_FIGURES, distance_term
from studies.readings.preset import ReadingsPreset


def readings_json(preset: ReadingsPreset, analysis: Analysis, candidates: Sequence[Candidate]) -> dict[str, Any]:
    """Cells, effects and candidates; shares as fractions, the distance in what is allowed.

    `terms` of a cell: each figure less the paper's, in what is allowed; their root mean square is the distance. An
    effect is the mean over the cells with the second level less that over the others.
    """
    return {
        "decisions": {
            decision.name: {"first": decision.first, "second": decision.second, "values": list(decision.values)}
            for decision in DECISIONS
        },
        "cells": [
            {
                "cell": cell.number,
                "second": sorted(cell.second),
                "starts": analysis.n_starts(cell.number),
                "distance": analysis.figures(cell.number)[DISTANCE],
                "parts": by_part(analysis.figures(cell.number)),
                "terms": by_part(terms_of(analysis.figures(cell.number))),
            }
            for cell in analysis.cells
        ],
        "effects": {
            part: {figure: effect_rows(analysis, Response(part, figure)) for figure in READ_FIGURES}
            for part in analysis.parts
        }
        | {"distance": effect_rows(analysis, DISTANCE)},
        "sure": analysis.sure,
        "candidates": [
            {
                "name": one.name,
                "second": sorted(one.second),
                "cell": one.cell,
                "predicted": {"distance": one.predicted[DISTANCE], "parts": by_part(one.predicted)},
                "measured": {"distance": one.measured[DISTANCE], "parts": by_part(one.measured)}
                if one.measured
                else None,
                "parameters": decided(preset.parameters, one.second).model_dump(mode="json"),
                "preset": preset_file(one.name),
            }
            for one in candidates
        ],
    }


def effect_rows(analysis: Analysis, response: Response) -> list[dict[str, Any]]:
    """Of all decisions on one response, the largest first."""
    effects = analysis.effects.get(response, {})
    return [
        {
            "decision": name,
            "effect": effect.value,
            "error": effect.error,
            "margin": effect.margin,
            "lenth_margin": effect.lenth_margin,
            "sure": effect.is_sure,
        }
        for name, effect in sorted(effects.items(), key=lambda item: -abs(item[1].value))
    ]


def by_part(figures: Mapping[Response, float]) -> dict[str, dict[str, float]]:
    """Without the distance."""
    found: dict[str, dict[str, float]] = {}
    for response, value in figures.items():
        if response != DISTANCE:
            found.setdefault(response.part, {})[response.figure] = value
    return found


def terms_of(figures: Mapping[Response, float]) -> dict[Response, float]:
    """Each figure less the paper's, in what is allowed."""
    return {r: distance_term(r.figure, r.part, value) for r, value in figures.items() if r != DISTANCE}


def readings_words(analysis: Analysis, candidates: Sequence[Candidate], n_runs: int, planned: int, failed: int) -> str:
    """What was run, and which readings come nearest."""
    rest = ", all that were planned" if n_runs == planned else f" of {planned} that are planned"
    done = f"{counted(n_runs, 'run')}{rest}" + (f"; {counted(failed, 'run')} failed" if failed else "") + "."
    if not candidates:
        lacking = sum(analysis.n_starts(cell.number) == 0 for cell in analysis.cells)
        return (
            f"{done} {counted(lacking, 'reading')} of {N_CELLS} have no whole start yet, so nothing is told from them."
        )
    default, best, measured = candidates
    moved = ", ".join(analysis.sure) or "none of the decisions"
    return (
        f"{done} The method as it comes lies {_distance(default.measured)} from the paper's table (1: each figure as "
        f"far off as is allowed), the nearest reading that was tried {_distance(measured.measured)} (cell "
        f"{measured.cell}). The distance is moved by more than its margin by {moved}. The reading that follows, with "
        f"{', '.join(sorted(best.second)) or 'nothing'} at the second level, is predicted to lie at "
        f"{_distance(best.predicted)}."
    )


def _distance(figures: Mapping[Response, float] | None) -> str:
    return "n/a" if figures is None else f"{figures[DISTANCE]:.2f}"
