"""Remedies that a preset names, factor by factor, out of the one table of `studies.advise.factors`."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from materials.suggestion import suggest
from studies.advise.factors import REMEDY_FACTORS, Remedy, RemedyFactor, remedies_for
from studies.advise.search import NEED_LAMPS
from studies.advise.setup import Setup

DeclaredLevels = Mapping[str, Sequence[str]]
"""Names of levels by the name of their factor."""


def declared_factors(levels: DeclaredLevels) -> tuple[RemedyFactor, ...]:
    """The table's factors with the named levels alone, in the table's order; ValueError for a name that it lacks."""
    known = {factor.name: factor for factor in REMEDY_FACTORS}
    for name, wanted in levels.items():
        if name not in known:
            raise ValueError(f"remedies: there is no factor {name}; {suggest(name, known)}")
        names = [level.name for level in known[name].levels]
        for one in wanted:
            if one not in names:
                raise ValueError(f"remedies: {name} has no level {one}; {suggest(one, names)}")
    return tuple(
        replace(factor, levels=tuple(level for level in factor.levels if level.name in levels[factor.name]))
        for factor in REMEDY_FACTORS
        if factor.name in levels
    )


def declared_remedies(base: Setup, levels: DeclaredLevels, has_lamps: bool) -> tuple[Remedy, ...]:
    """The named ones that change anything about a camera as it is set; none about lamps where no lamp is."""
    return tuple(
        remedy
        for remedy in remedies_for(base, declared_factors(levels))
        if has_lamps or remedy.factor.name not in NEED_LAMPS
    )
