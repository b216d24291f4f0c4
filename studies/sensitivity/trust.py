"""Where the method should not be trusted: the combinations of surface, metal and angle that fail, in plain words."""

from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from studies.sensitivity.preset import OWN
from studies.sensitivity.rules import RULES, Rule
from studies.sensitivity.shares import Row

OWN_WORDS = "own materials"
"""Of a part whose bodies keep what the real things are made of."""


@dataclass(frozen=True)
class Distrust:
    """Combinations of one subject and surface that fail in one way."""

    subject: str
    surface: str
    """Finish, or the material where there is none."""
    rule: str
    where: str
    """Metals and angles, in words."""
    failing: int
    measured: int
    """Combinations of metal and angle that fail, and that were measured."""
    why: str


def distrusts(rows: Iterable[Row]) -> list[Distrust]:
    """All reasons for distrust, surface by surface; of each surface those first that hold in most combinations."""
    judged = [row for row in rows if row["main_light"] and surface(row)]
    found: list[Distrust] = []
    for (subject, name), group in together(judged, lambda row: (row["subject"], surface(row))).items():
        cells = list(together(group, lambda row: (row["metal"], row["polar_deg"])).values())
        failures = [_distrust(str(subject), str(name), rule, cells) for rule in RULES]
        found += sorted((failure for failure in failures if failure), key=lambda failure: -failure.failing)
    return found


def trusted(rows: Iterable[Row], found: Iterable[Distrust]) -> list[tuple[str, str]]:
    """Subjects and surfaces that were measured and give no reason for distrust."""
    failing = {(distrust.subject, distrust.surface) for distrust in found}
    judged = [(row["subject"], surface(row)) for row in rows if row["main_light"]]
    return [(subject, name) for subject, name in dict.fromkeys(judged) if name and (subject, name) not in failing]


def surface(row: Row) -> str | None:
    """Finish, or the material where there is none; None where the roughness was given as a number."""
    return row["finish"] if row["metal"] else row["material"]


def together(rows: Iterable[Row], key: Callable[[Row], Hashable]) -> dict:
    """Rows with equal keys together, in the order of their first appearance."""
    groups: dict[Hashable, list[Row]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def _distrust(subject: str, name: str, rule: Rule, cells: Sequence[Sequence[Row]]) -> Distrust | None:
    failing = [cell for cell in cells if rule.holds(cell)]
    if not failing:
        return None
    rows = [row for cell in failing for row in cell]
    where = _where([cell[0] for cell in failing], [cell[0] for cell in cells])
    return Distrust(subject, name, rule.name, where, len(failing), len(cells), rule.why(rows))


def _where(failing: Sequence[Row], measured: Sequence[Row]) -> str:
    metals = metal_words(_distinct(failing, "metal"), _distinct(measured, "metal"))
    angles = angle_words(sorted(_distinct(failing, "polar_deg")), sorted(_distinct(measured, "polar_deg")))
    return f"{metals}, {angles}" if metals else angles


def _distinct(rows: Iterable[Row], column: str) -> list:
    return list(dict.fromkeys(row[column] for row in rows))


def metal_words(failing: Sequence[str | None], measured: Sequence[str | None]) -> str:
    """`all 12 metals`, up to four by name, or how many and which not; empty for materials that are no metals."""
    if measured == [None]:
        return ""
    if len(failing) == len(measured) > 1:
        return f"{every(len(measured))} metals"
    if len(failing) <= 4:
        return ", ".join(map(spoken, failing))
    others = [spoken(metal) for metal in measured if metal not in failing]
    return f"{len(failing)} of {len(measured)} metals (not {', '.join(others)})"


def every(n: int) -> str:
    """`both`, `all 3`."""
    return "both" if n == 2 else f"all {n}"


def spoken(name: str | None) -> str:
    """A name of the catalogue in words."""
    return OWN_WORDS if name == OWN else (name or "").replace("_", " ")


def angle_words(failing: Sequence[float], measured: Sequence[float]) -> str:
    """`all 8 angles`, `20 to 60 deg` for neighbours among the measured angles, `0 and 60 deg` for others."""
    if len(failing) == len(measured) > 1:
        return f"{every(len(measured))} angles"
    places = [measured.index(angle) for angle in failing]
    runs = []
    for _, run in groupby(enumerate(places), key=lambda pair: pair[1] - pair[0]):
        ends = [measured[place] for _, place in run]
        runs.append(f"{ends[0]:g}" if len(ends) == 1 else f"{ends[0]:g} to {ends[-1]:g}")
    return f"{', '.join(runs[:-1])} and {runs[-1]} deg" if len(runs) > 1 else f"{runs[0]} deg"
