"""Cases and counts that were never measured, so that verdicts, tables and pages can be checked by hand."""

from collections.abc import Mapping

from studies.advise.search import Tried
from studies.mitigations.answers import CaseAnswer, answer_of, known_remedy
from studies.mitigations.cases import MitigationCase, mitigation_cases
from studies.mitigations.preset import MitigationsPreset
from tests.studies.advise.made_up import shares

POSES = 6
WIGGLE = (0.01, -0.01, 0.02, -0.02, 0.005, -0.005)
"""What poses differ by, the same for all remedies: differences have none."""
Change = float | tuple[float, float]
"""Gain of right depth; or that, and of false depth."""


def preset(**settings: object) -> MitigationsPreset:
    """Two metals in two finishes, six poses."""
    asked = {"title": "Made up", "metals": ("aluminium", "brass"), "finishes": ("polished", "blasted"), "poses": POSES}
    return MitigationsPreset.model_validate({**asked, **settings})


def cases(**settings: object) -> list[MitigationCase]:
    """Of that preset."""
    return mitigation_cases(preset(**settings))


def measured(base: float, remedy: Mapping[tuple[str, str], Change], false: float = 0.1) -> list[Tried]:
    """A base share of right depth, and what remedies change it by, the same at every pose."""

    def one(right: float, wrong: float, *remedies: tuple[str, str]) -> Tried:
        found = tuple(known_remedy(*name) for name in remedies)
        setup = CASE.base
        for each in found:
            setup = each.level.change(setup)
        return Tried(found, setup, shares([right + w for w in WIGGLE], wrong))

    changed = [
        one(base + gain, false + more, name)
        for name, (gain, more) in ((name, x if isinstance(x, tuple) else (x, 0.0)) for name, x in remedy.items())
    ]
    return [one(base, false), *changed]


CASE = cases()[0]
"""Any."""


def answer(case: MitigationCase, base: float, remedy: Mapping[tuple[str, str], Change]) -> CaseAnswer:
    """Of one case."""
    return answer_of(case, measured(base, remedy))
