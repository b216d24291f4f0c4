"""The readings that a study proposes, and the comparison by which each is confirmed: a preset file beside the runs."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from studies.base.atomic_file import write_atomically
from studies.comparison.paper import PAPER_PARTS, PAPER_RUNS
from studies.comparison.preset import ComparisonPreset
from studies.readings.analysis import Analysis, Response
from studies.readings.decisions import DECIDED_FIELDS
from studies.readings.preset import ReadingsPreset

PROPOSED = {
    "default": "the method as it comes",
    "best": "predicted to come nearest: each decision at its second level whose effect on the distance says so",
    "measured": "the cell that came nearest",
}
"""Readings by the names of their files."""
CONFIRMED_WITH = ("fra", "pb", "re")
"""Planners of the paper's table."""


@dataclass(frozen=True)
class Candidate:
    """One reading to be confirmed."""

    name: str
    """Of PROPOSED."""
    second: frozenset[str]
    """Decisions at their second level."""
    cell: int | None
    """Its cell, where it is one of the design."""
    predicted: Mapping[Response, float]
    """By the linear model of the sure effects."""
    measured: Mapping[Response, float] | None
    """By its cell."""


def candidates_of(analysis: Analysis) -> list[Candidate]:
    """All candidates; none before every cell has its figures."""
    if not analysis.is_complete:
        return []
    readings = {"default": frozenset[str](), "best": analysis.best, "measured": analysis.nearest_cell.second}
    cells = {cell.second: cell.number for cell in analysis.cells}
    return [
        Candidate(
            name,
            second,
            cells.get(second),
            analysis.predicted(second),
            analysis.figures(cells[second]) if second in cells else None,
        )
        for name, second in readings.items()
    ]


def confirmation(preset: ReadingsPreset, candidate: Candidate) -> ComparisonPreset:
    """The paper's whole table by this reading: fifteen starts of three planners on four parts.

    The study's starts are among the fifteen where their number divides it, so that in the study's own folder the
    comparison finds those runs.
    """
    update = {
        "title": f"FRA-NBV against PB-NBV and ray-cast entropy, reading \u201c{candidate.name}\u201d",
        "starts": PAPER_RUNS,
        "runs": PAPER_RUNS,
        "parts": PAPER_PARTS,
        "planners": CONFIRMED_WITH,
    }
    return preset.as_comparison(candidate.second).model_copy(update=update)


def write_confirmations(out: Path, preset: ReadingsPreset, candidates: list[Candidate]) -> None:
    """Put down the comparison of each candidate, for `franbv study comparison --preset FILE`."""
    for candidate in candidates:
        text = (
            f"# Reading \u201c{candidate.name}\u201d: {PROPOSED[candidate.name]}.\n"
            f"# Second level: {', '.join(sorted(candidate.second)) or 'none'}.\n"
            + yaml.safe_dump(preset_keys(confirmation(preset, candidate)), sort_keys=False, allow_unicode=True)
        )
        write_atomically(out / preset_file(candidate.name), text.encode())


def preset_file(name: str) -> str:
    """File of a candidate's comparison."""
    return f"reading_{name}.yaml"


def preset_keys(comparison: ComparisonPreset) -> dict[str, Any]:
    """What differs from a comparison's defaults, and every decision, whatever the defaults will be."""
    keys = comparison.model_dump(mode="json", exclude_defaults=True)
    own = comparison.parameters.model_dump(mode="json", include=set(DECIDED_FIELDS))
    keys["bench"] = comparison.bench
    keys["parameters"] = {**keys.get("parameters", {}), **own}
    return keys
