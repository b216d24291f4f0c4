"""Shares of the rows of a sensitivity study, pooled over whatever rows are asked for."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from render.labels.causes import HOLES, Cause, members
from studies.sensitivity.columns import FALSE_DEPTHS, cause_column
from studies.statistics.shares import pooled

Row = Mapping[str, Any]
Counted = Callable[[Row], float | None]


def holes(row: Row) -> int:
    """Pixels of the part without depth."""
    return sum(row[cause_column(cause)] for cause in HOLES)


def false_depth(row: Row) -> int:
    """Pixels of the part with false depth."""
    return sum(row[cause_column(cause)] for cause in FALSE_DEPTHS)


def reflection_holes(row: Row) -> int:
    """Pixels of the part that reflection has cost."""
    return sum(row[cause_column(cause)] for cause in members("reflection"))


def false_by_reflection(row: Row) -> int:
    """Pixels of the part whose depth is false, and right on the matte twin."""
    return row[cause_column(Cause.FALSE_DEPTH_REFLECTION)]


def part_pixels(row: Row) -> int:
    """Pixels of the part."""
    return row["part_pixels"]


def pooled_share(rows: Iterable[Row], part: Counted, whole: Counted) -> float | None:
    """Sum over the rows of the part over that of the whole; None where the whole is nothing."""
    rows = list(rows)
    return pooled(map(part, rows), map(whole, rows))


def leading_kind(rows: Sequence[Row]) -> tuple[Cause, float] | None:
    """The sub-kind of reflection that takes most pixels, and its share of them; None without any."""
    counts = {cause: sum(row[cause_column(cause)] for row in rows) for cause in members("reflection")}
    total = sum(counts.values())
    if total == 0:
        return None
    cause = max(counts, key=lambda c: counts[c])
    return cause, counts[cause] / total


def column_sum(rows: Iterable[Row], column: str) -> float:
    """Sum of a column; empty cells count nothing."""
    return sum(row[column] or 0 for row in rows)


def column_share(rows: Iterable[Row], part: str, whole: str) -> float | None:
    """Sum of one column over that of another; None where that is nothing."""
    return pooled_share(rows, lambda row: row[part], lambda row: row[whole])


def hole_share(rows: Iterable[Row]) -> float | None:
    """Share of the part without depth."""
    return pooled_share(rows, holes, part_pixels)


def false_share(rows: Iterable[Row]) -> float | None:
    """Share of the part with false depth."""
    return pooled_share(rows, false_depth, part_pixels)


def unusable_share(rows: Iterable[Row]) -> float | None:
    """Share of the part without depth or with false depth."""
    return pooled_share(rows, lambda row: holes(row) + false_depth(row), part_pixels)
