"""The runs of a study of readings: every cell of the design with PB and FRA, all from the same starts and noise."""

from itertools import chain, zip_longest

from studies.comparison.cases import run_settings
from studies.readings.decisions import read_by
from studies.readings.design import DesignCell, design_cells
from studies.readings.preset import READ_PLANNERS, ReadingsPreset
from studies.run.ablation import Ablation
from studies.run.batch import PlannedRun


def reading_runs(preset: ReadingsPreset) -> list[PlannedRun]:
    """All runs; all cells of the first start before the second start, so that a stopped study is a smaller one.

    Of a start, one planner after the other goes over the cells, each on all parts: neighbours in the list, which are
    made at the same time, look at another part or look first from another height, so that they have no burst in common,
    while FRA finds PB's of the same cell.
    """
    return [
        PlannedRun(part, cell_arm(planner, cell), start, _settings(preset, part, planner, start, cell))
        for start in range(preset.starts)
        for planner in READ_PLANNERS
        for cell in apart(design_cells())
        for part in preset.parts
    ]


def cell_arm(planner: str, cell: DesignCell) -> str:
    """What the runs of a planner in a cell are known by."""
    return f"{planner}, cell {cell.number}"


def apart(cells: tuple[DesignCell, ...]) -> list[DesignCell]:
    """The cells in an order in which those of the higher and of the lower first view take turns."""
    sides = [[cell for cell in cells if ("first_elevation" in cell.second) == is_lower] for is_lower in (False, True)]
    return [cell for cell in chain.from_iterable(zip_longest(*sides)) if cell is not None]


def _settings(preset: ReadingsPreset, part: str, planner: str, start: int, cell: DesignCell):
    reading = preset.as_comparison(read_by(planner, cell.second))
    return run_settings(reading, part, planner, start, Ablation())
