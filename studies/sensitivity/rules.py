"""Ways in which the method fails, as rules over pooled rows: when each holds, and what it says in plain words."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from render.labels.causes import Cause
from studies.base.numbers_as_text import percent
from studies.sensitivity.shares import (
    Row,
    column_share,
    column_sum,
    false_by_reflection,
    leading_kind,
    part_pixels,
    pooled_share,
    reflection_holes,
)

MUCH = 0.1
"""Share of the part from which false depth is a reason (choice: a tenth of the surface)."""
FAIR = 0.5
"""Precision and recall below this, and hidden shares above it, are a reason (choice: more wrong than right)."""
RECOVERED = 0.3
"""Recovered share below this is a reason (the paper's tau_rec)."""
FEW_PX = 8
"""Decimated pixels below which the detector is not judged (choice: the smallest regions have five)."""
FEW_FINE_PX = 64 * FEW_PX
"""The same at full resolution: a decimated pixel stands for 8 x 8."""
SMALL_MM2 = 100.0
"""Missing surface below which a recovery is not judged [mm^2] (choice: two voxels of the map)."""

KIND_WORDS = {
    Cause.REFLECTION_DARK: "the surface sends the dots' light elsewhere and stays dark",
    Cause.REFLECTION_SATURATED: "a highlight drowns the dots",
    Cause.REFLECTION_DISAGREEING: "left and right see different highlights or mirror images",
    Cause.REFLECTION_INTERREFLECTION: "light that comes by way of other surfaces covers the dots",
}
"""What each sub-kind of reflection does."""

Rows = Sequence[Row]


@dataclass(frozen=True)
class Rule:
    """One way to fail."""

    name: str
    holds: Callable[[Rows], bool]
    """Whether a combination of surface and angle fails so."""
    why: Callable[[Rows], str]
    """What to say of all combinations that do."""


def recall(rows: Rows) -> float | None:
    """Share of the reflective pixels that lie in regions."""
    return column_share(rows, "right_grouped", "reflective")


def precision(rows: Rows) -> float | None:
    """Share of the regions' pixels that are reflective."""
    return column_share(rows, "right_grouped", "found_grouped")


def hidden(rows: Rows) -> float | None:
    """Share of the reflective holes that decimation fills."""
    return column_share(rows, "hidden_holes", "fine_holes")


def regained(rows: Rows) -> float | None:
    """Share of the missing surface that the diamond poses regain."""
    return column_share(rows, "regained_mm2", "missing_mm2")


def pb_regained(rows: Rows) -> float | None:
    """The same of as many views of PB-NBV."""
    return column_share(rows, "pb_regained_mm2", "missing_mm2")


def _deceived(rows: Rows) -> bool:
    return (pooled_share(rows, false_by_reflection, part_pixels) or 0) >= MUCH


def _deceived_words(rows: Rows) -> str:
    false = percent(pooled_share(rows, false_by_reflection, part_pixels))
    return (
        f"{false} of the surface has a false depth that a matte surface would not have. "
        "The detector looks for missing depth and cannot see it."
    )


def _blind(rows: Rows) -> bool:
    return column_sum(rows, "reflective") >= FEW_PX and (recall(rows) or 0) < FAIR


def _blind_words(rows: Rows) -> str:
    lost = percent(pooled_share(rows, reflection_holes, part_pixels))
    words = (
        f"Reflection takes the depth of {lost} of the surface. Of the holes that decimation leaves the detector "
        f"reports {percent(recall(rows))}."
    )
    kind = leading_kind(rows)
    return words + (f" The commonest reason ({percent(kind[1])}): {KIND_WORDS[kind[0]]}." if kind else "")


def _filled(rows: Rows) -> bool:
    return column_sum(rows, "fine_holes") >= FEW_FINE_PX and (hidden(rows) or 0) > FAIR


def _filled_words(rows: Rows) -> str:
    return (
        f"Decimation fills {percent(hidden(rows))} of the reflective holes with the depth of their rims, true or "
        "false, before the detector looks."
    )


def _crying_wolf(rows: Rows) -> bool:
    return column_sum(rows, "found_grouped") >= FEW_PX and (precision(rows) or 0) < FAIR


def _crying_wolf_words(rows: Rows) -> str:
    return f"Only {percent(precision(rows))} of what the detector reports has lost its depth to reflection."


def _unrecovered(rows: Rows) -> bool:
    return column_sum(rows, "missing_mm2") >= SMALL_MM2 and (regained(rows) or 0) < RECOVERED


def _unrecovered_words(rows: Rows) -> str:
    return (
        f"The recovery poses regain {percent(regained(rows))} of the surface that the largest region signals; "
        f"as many views of PB-NBV regain {percent(pb_regained(rows))}."
    )


def _beaten(rows: Rows) -> bool:
    return column_sum(rows, "missing_mm2") >= SMALL_MM2 and (regained(rows) or 0) < (pb_regained(rows) or 0)


def _beaten_words(rows: Rows) -> str:
    return f"As many views of PB-NBV regain more: {percent(pb_regained(rows))} against {percent(regained(rows))}."


RULES = (
    Rule("false depth", _deceived, _deceived_words),
    Rule("missed holes", _blind, _blind_words),
    Rule("filled holes", _filled, _filled_words),
    Rule("false alarms", _crying_wolf, _crying_wolf_words),
    Rule("failed recovery", _unrecovered, _unrecovered_words),
    Rule("beaten recovery", _beaten, _beaten_words),
)
"""In the order in which depth is made, seen and recovered."""
