"""Rows of the table that tells what each change of fra-robust is worth: arms by parts."""

from collections.abc import Mapping
from typing import Any

from markupsafe import Markup

from studies.comparison.method_names import method_name
from studies.comparison.report.headline import short_words
from studies.comparison.robust_arms import RobustTable
from studies.drawing.cells import NO_NUMBER, POINTS, mean, signed
from studies.statistics.intervals import Interval


def robust_section(tables: Mapping[str, RobustTable]) -> dict[str, Any] | None:
    """A block of rows per arm: coverage after each level with the difference to FRA, then wrongly free voxels; None
    where no ablation has runs."""
    if not tables:
        return None
    arms = max((table.arms for table in tables.values()), key=len)
    arms = [*arms, *(arm for table in tables.values() for arm in table.arms if arm not in arms)]
    levels = sorted({level for table in tables.values() for level in table.levels})
    rows = []
    for arm in dict.fromkeys(arms):
        for level in levels:
            cells = [_cell(table, arm, level) for table in tables.values()]
            name = method_name(arm) if level == levels[0] else ""
            rows.append({"first": bool(name), "arm": name, "figure": f"after {level} [%]", "cells": cells})
        free = [_percent(table.wrongly_free(arm)) for table in tables.values()]
        rows.append(
            {"first": not levels, "arm": "" if levels else method_name(arm), "figure": "free [%]", "cells": free}
        )
    return {"parts": [short_words(part) for part in tables], "starts": _starts(tables), "rows": rows}


def _starts(tables: Mapping[str, RobustTable]) -> list[int]:
    """Starts of each part that ablations and FRA have."""
    return [len({run.run for run in table.shared.records if run.part == part}) for part, table in tables.items()]


def _cell(table: RobustTable, arm: str, level: int) -> str:
    """`93.2`, and below it how much more than FRA that is, with its interval."""
    if level not in table.levels:
        return NO_NUMBER
    covers, lead = _percent(table.covers(arm, level)), table.less_fra(arm, level)
    return Markup("{}<small>{}</small>").format(covers, signed(lead)) if lead else covers


def _percent(interval: Interval | None) -> str:
    return NO_NUMBER if interval is None else mean(interval, POINTS, ".1f")
