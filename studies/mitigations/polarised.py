"""What a polariser has to work with on each material, and what it gained there."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from materials.fresnel import conductor_reflectance_sp, degree_of_polarisation
from materials.non_metals import COAT_INDEX
from materials.optical_constants import METALS
from studies.mitigations.answers import CaseAnswer
from studies.statistics.medians import MedianEstimate, median_interval

TOLD_AT_DEG = 45.0
"""Angle of incidence at which degrees of polarisation are told [deg] (choice: what people's rules of thumb are for)."""
COATED = "clear coat of paint or plastic"
"""Row of the dielectric, beside the metals."""


@dataclass(frozen=True)
class PolarisedMaterial:
    """One metal, or the coat of paints and plastics."""

    name: str
    reflectance_s: float
    """Across the plane of incidence, of a smooth surface at 850 nm [0, 1]."""
    reflectance_p: float
    """In the plane of incidence."""
    degree: float
    """Of polarisation of what it mirrors of unpolarised light [0, 1]."""
    gains: dict[str, MedianEstimate]
    """By way of putting films: right share beyond the camera as it is set, median over the cases of this material."""


def polarised_materials(answers: Sequence[CaseAnswer]) -> list[PolarisedMaterial]:
    """The metals of the study in the table's order, then the coat."""
    present = {answer.case.metal for answer in answers if answer.case.finish}
    metals = [(name, row.n, row.k) for name, row in METALS.items() if name in present]
    return [_row(name, n, k, answers) for name, n, k in [*metals, (COATED, COAT_INDEX, 0.0)]]


def _row(name: str, n: float, k: float, answers: Sequence[CaseAnswer]) -> PolarisedMaterial:
    angle = np.radians([TOLD_AT_DEG])
    reflectance_s, reflectance_p = conductor_reflectance_sp(angle, n, k)
    own = [answer for answer in answers if (answer.case.metal if answer.case.finish else COATED) == name]
    gains: dict[str, list[float]] = {}
    for answer in own:
        for score in answer.advice.remedies:
            if score.name == "polarisers":
                gains.setdefault(score.level, []).append(score.gain)
    return PolarisedMaterial(
        name,
        float(reflectance_s[0]),
        float(reflectance_p[0]),
        float(degree_of_polarisation(angle, n, k)[0]),
        {level: median_interval(values) for level, values in gains.items()},
    )
