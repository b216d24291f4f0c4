"""What the counts of a case say: which honest remedy wins, by how much, and how near to spray that comes."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.advise.advice import Advice, RemedyScore, advice_from
from studies.advise.factors import REMEDY_FACTORS, Remedy
from studies.advise.paired_shares import SurfaceShares
from studies.advise.scoring import SurfaceCount
from studies.advise.search import Tried
from studies.base.case_folder import finished_case
from studies.base.reading import reading
from studies.mitigations.cases import MitigationCase
from studies.sensitivity.measurement import CASES, RESULT


@dataclass(frozen=True, eq=False)
class CaseAnswer:
    """A finished case."""

    case: MitigationCase
    tried: tuple[Tried, ...]
    """The camera as it is set first, then every remedy by itself."""
    advice: Advice
    """As `franbv advise` would give it."""

    @property
    def winner(self) -> RemedyScore | None:
        """The honest remedy with most right depth of those that are told apart and worth it; None without any."""
        return self.advice.best if self.advice.kind == "remedy" else None

    @property
    def needs_help(self) -> bool:
        """Whether shine is in the way or a remedy adds much: elsewhere no remedy can show itself."""
        return self.advice.kind in ("remedy", "only spray")

    @property
    def scores(self) -> dict[str, RemedyScore]:
        """Of every remedy, by `factor: level`."""
        return {f"{one.name}: {one.level}": one for one in self.advice.remedies}


def answer_of(case: MitigationCase, tried: Sequence[Tried]) -> CaseAnswer:
    """From what was measured, the camera as it is set first."""
    advice, _ = advice_from(tried, len(case.settings.pose), len(case.seeds))
    return CaseAnswer(case, tuple(tried), advice)


def stored_answers(out: Path, cases: Iterable[MitigationCase]) -> list[CaseAnswer]:
    """Of the cases that are finished, in their order."""
    return [answer_of(case, stored_tried(folder, case)) for case in cases if (folder := _folder(out, case))]


def _folder(out: Path, case: MitigationCase) -> Path | None:
    return finished_case(out / CASES, case.digest)


def stored_tried(folder: Path, case: MitigationCase) -> list[Tried]:
    """What a finished case measured."""
    with reading(folder / RESULT, "copy the study whole, or give its command again with another --out"):
        rows = json.loads((folder / RESULT).read_text(encoding="utf-8"))["counts"]
        return [_tried(case, row["remedy"], row["views"]) for row in rows]


def _tried(case: MitigationCase, name: Sequence[str], views: list[list[dict[str, Any]]]) -> Tried:
    shares = SurfaceShares.of([tuple(SurfaceCount(**one) for one in view) for view in views])
    remedies = (known_remedy(*name),) if name else ()
    setup = case.base
    for remedy in remedies:
        setup = remedy.level.change(setup)
    return Tried(remedies, setup, shares)


def known_remedy(factor: str, level: str) -> Remedy:
    """A row of the table by its two names; ValueError where it has none, as of an older study."""
    for row in REMEDY_FACTORS:
        for one in row.levels:
            if (row.name, one.name) == (factor, level):
                return Remedy(row, one)
    raise ValueError(f"there is no remedy {factor}: {level}")
