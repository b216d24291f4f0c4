"""What a sensitivity study found, in the few sentences at the head of its report."""

from collections.abc import Sequence
from typing import Any

from render.imager.settings import REFERENCE_LASER_POWER_MW
from studies.base.numbers_as_text import counted, percent
from studies.sensitivity.roughness import RoughnessCurve
from studies.sensitivity.rules import KIND_WORDS, hidden
from studies.sensitivity.shares import Row, leading_kind, unusable_share
from studies.sensitivity.trust import spoken, surface, together

ROUGH_ENOUGH = 0.1
"""Share of unusable surface below which a finish counts as harmless (choice: a tenth, as in the list of distrust)."""


def study_findings(
    figures: dict[str, Any], main: Sequence[Row], views: Sequence[Row], curves: Sequence[RoughnessCurve]
) -> str:
    """One paragraph. views: all rows, main: those under the first light of their case; figures: the study's summary."""
    sentences = [
        _measured(figures, main),
        _finishes(main),
        _metals(main),
        _darkness(views),
        _detector(figures, main),
        _recovery(figures, main),
        roughness_words(curves),
    ]
    return " ".join(sentence for sentence in sentences if sentence)


def _measured(figures: dict[str, Any], main: Sequence[Row]) -> str:
    materials = len({row["material"] for row in main})
    words = (
        f"Over {counted(figures['cases'], 'view')} of {counted(materials, 'material')}, "
        f"{percent(figures['hole_share'])} of the surface has no depth "
        f"and {percent(figures['false_depth_share'])} a false one."
    )
    kind = leading_kind(main)
    if kind is None:
        return words
    return (
        f"{words} Where reflection takes it, the commonest reason ({percent(kind[1])}) is that {KIND_WORDS[kind[0]]}."
    )


def _finishes(main: Sequence[Row]) -> str:
    """Which finishes of the plate break the depth, and which do not."""
    plate = [row for row in main if row["subject"] == "plate" and row["finish"]]
    shares = {name: unusable_share(group) or 0.0 for name, group in together(plate, surface).items()}
    if not shares:
        return ""
    bad = sorted((name for name in shares if shares[name] >= ROUGH_ENOUGH), key=lambda name: -shares[name])
    good = [name for name in shares if shares[name] < ROUGH_ENOUGH]
    parts = []
    if bad:
        parts.append("On the plate these finishes lose or falsify a tenth of their depth or more: "
                     + ", ".join(f"{spoken(name)} ({percent(shares[name])})" for name in bad) + ".")  # fmt: skip
    if good:
        parts.append(
            "These stay below: " + ", ".join(f"{spoken(name)} ({percent(shares[name])})" for name in good) + "."
        )
    return " ".join(parts)


def _metals(main: Sequence[Row]) -> str:
    """How much the metal matters, at equal views: the finish in which metals differ most."""
    plate = [row for row in main if row["subject"] == "plate" and row["finish"] and row["seed"] == 0]
    spreads = []
    for finish, group in together(plate, surface).items():
        shares = {metal: unusable_share(rows) or 0.0 for metal, rows in together(group, lambda r: r["metal"]).items()}
        least, most = min(shares, key=shares.__getitem__), max(shares, key=shares.__getitem__)
        if len(shares) > 1:
            spreads.append((shares[most] - shares[least], finish, least, shares[least], most, shares[most]))
    if not spreads:
        return ""
    spread, finish, least, low, most, high = max(spreads)
    return (
        f"Metals of one finish differ by {100 * spread:.0f} points at the most ({spoken(finish)}: {spoken(least)} "
        f"{percent(low)}, {spoken(most)} {percent(high)})."
    )


def _darkness(views: Sequence[Row]) -> str:
    """What lamps cost: cases that were measured with and without them at the default laser power."""
    cases = together([row for row in views if row["finish"] and row["laser_mw"] == REFERENCE_LASER_POWER_MW], _case)
    pairs = [(_under(rows, "off"), [row for row in rows if row["main_light"]]) for rows in cases.values()]
    dark, lit = ([row for pair in pairs if all(pair) for row in pair[k]] for k in (0, 1))
    if not dark:
        return ""
    without, with_them = unusable_share(dark) or 0.0, unusable_share(lit) or 0.0
    words = (
        f"Without lamps {percent(without)} of the surface is unusable, with them {percent(with_them)} "
        f"({counted(len(dark), 'view')} of each)"
    )
    return words + (": lamps do most of the harm." if with_them > 2 * without else ".")


def _case(row: Row) -> str:
    return row["case"]


def _under(rows: Sequence[Row], lamps: str) -> list[Row]:
    return [row for row in rows if row["lamps"] == lamps]


def _detector(figures: dict[str, Any], main: Sequence[Row]) -> str:
    if figures["detection_recall"] is None:
        return ""
    words = (
        f"Decimation fills {percent(hidden(main))} of the reflective holes before the detector looks; "
        f"of those that are left it reports {percent(figures['detection_recall'])}"
    )
    right = figures["detection_precision"]
    return words + ("." if right is None else f", and {percent(right)} of what it reports is reflective.")


def _recovery(figures: dict[str, Any], main: Sequence[Row]) -> str:
    if figures["recovered_share"] is None:
        return ""
    recovered = [row for row in main if row["missing_mm2"]]
    ahead = sum(row["regained_mm2"] > row["pb_regained_mm2"] for row in recovered)
    behind = sum(row["regained_mm2"] < row["pb_regained_mm2"] for row in recovered)
    return (
        f"The recovery poses regain {percent(figures['recovered_share'])} of the missing surface that the largest "
        f"region signals, as many views of PB-NBV {percent(figures['pb_recovered_share'])}; "
        f"recovery is ahead in {ahead} of {counted(len(recovered), 'case')} and behind in {behind}."
    )


def roughness_words(curves: Sequence[RoughnessCurve]) -> str:
    """Where the bends lie beside the theory."""
    bends = [
        f"{curve.measured:.3f} at {curve.distance_m:g} m (B / 2Z = {curve.theory:.3f})"
        for curve in curves
        if curve.measured is not None
    ]
    return f"The critical roughness lies at alpha = {' and '.join(bends)}." if bends else ""
