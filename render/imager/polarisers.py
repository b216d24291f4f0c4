"""Linear polarisers before lenses, dot projector and lamps: which films there are, and how they are turned."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from materials.lights import REFERENCE_NM, SPECTRUM_NM, Band, electron_weights

FilmName = Literal["nir", "sheet", "ideal"]
Turn = Annotated[float, Field(ge=-180.0, le=180.0)]
"""Of an axis [deg]; half a turn changes nothing."""


@dataclass(frozen=True)
class Film:
    """What a linear polariser lets through of light along its axis and across it, below `edge_nm` alone."""

    along: float
    """Share of the light whose field swings along its axis [0, 1]."""
    across: float
    """The same across the axis [0, 1]."""
    edge_nm: float = np.inf
    """Wavelength from which on it lets both pass alike [nm]."""
    beyond: float = 1.0
    """Share of either that it lets pass there [0, 1]."""

    def transmissions(self, band: Band) -> tuple[float, float]:
        """Along and across the axis, means over a light's electrons [0, 1]."""
        polarises = 1.0 if self.edge_nm > REFERENCE_NM else 0.0
        if band is not Band.PROJECTOR:
            polarises = float(np.sum(electron_weights(band)[self.edge_nm > SPECTRUM_NM]))
        rest = (1 - polarises) * self.beyond
        return polarises * self.along + rest, polarises * self.across + rest

    def passed(self, band: Band) -> float:
        """Share of unpolarised light that it lets pass [0, 1]."""
        return sum(self.transmissions(band)) / 2

    def degree(self, band: Band) -> float:
        """(T_along - T_across) / (T_along + T_across) [0, 1]; 0 = does not polarise."""
        along, across = self.transmissions(band)
        return (along - across) / (along + across)


FILMS: Mapping[FilmName, Film] = {
    # Choice: makers sell plastic films for 600 to 1100 nm (Thorlabs LPNIRE); Edmund's guide has extinctions from below
    # 100:1 for cheap sheets to 10^6:1 for crystals, this one 1000:1; glass without a coating and dye take a fifth. The
    # lamps' visible light is treated as 850 nm is.
    "nir": Film(0.80, 0.0008),
    # Sheets for photography and displays, iodine in PVA: active in the visible, with little effect in the near infrared
    # (laserfocusworld.com, optical transmission of Polaroid sheet polarizers). Choices: a common sheet's 0.8 and
    # 1000:1, no polarisation at all from 780 nm, and the reflections of two bare surfaces beyond.
    "sheet": Film(0.80, 0.0008, 780.0, 0.92),
    "ideal": Film(1.0, 0.0),
}
"""By the names that `Polarisers.film` takes."""


class Polarisers(BaseModel):
    """Where polarisers stand and how their axes are turned: parallel at equal angles, crossed 90 deg apart.

    Angles go from the image's +x, along the baseline, towards its +y; None = no film there. A film blocks light whose
    field swings along the line across its axis, as that line is seen from the light's direction; light that meets it
    aslant is let pass by no other share. All films are of one make. What is known of the laser itself: a VCSEL is
    polarised along one of two crystal axes, which of them is left to chance, and may switch with current and
    temperature (Instrument Systems, Spatially-resolved polarization characterization of VCSEL arrays, 2022); Intel says
    nothing of the D400's array. So the default is an even mix. Left out: strain in lens and cover glass, waveplates,
    and polarised light from the sky. Unknown keys and numbers out of range raise pydantic's ValidationError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    imagers_deg: Turn | None = None
    """Axis of the films before both imagers [deg]."""
    projector_deg: Turn | None = None
    """Axis of the film before the projector [deg]."""
    lamps_deg: Turn | None = None
    """Axis of films before all lamps, from each lamp's width towards its height [deg]."""
    film: FilmName = "nir"
    """One for the near infrared; sheet, the cheap one that does next to nothing at 850 nm; or ideal."""
    laser_degree: float = Field(default=0.0, ge=0.0, le=1.0)
    """Degree of polarisation of the laser before its film [-]; 0: the emitters' axes are mixed evenly (choice).
    It counts where a film stands somewhere."""
    laser_deg: Turn = 0.0
    """Axis of its polarised part [deg]; without meaning where that is 0."""

    @property
    def any_film(self) -> bool:
        """Whether a film stands anywhere: without one nothing changes."""
        return not (self.imagers_deg is None and self.projector_deg is None and self.lamps_deg is None)

    @property
    def make(self) -> Film:
        """The film's numbers."""
        return FILMS[self.film]

    def projector_stokes(self) -> tuple[float, float, float]:
        """Of the dots' light as the projector's film leaves it, relative to what the laser emits: power, and what of it
        is polarised along or across and at 45 deg to `projector_axis_deg`."""
        turn = np.radians(2 * (self.laser_deg - self.projector_axis_deg))
        q, u = self.laser_degree * np.cos(turn), self.laser_degree * np.sin(turn)
        along, across = (1.0, 1.0) if self.projector_deg is None else self.make.transmissions(Band.PROJECTOR)
        first, second = along * (1 + q) / 2, across * (1 - q) / 2
        return float(first + second), float(first - second), float(np.sqrt(along * across) * u)

    @property
    def projector_axis_deg(self) -> float:
        """The axis to which `projector_stokes` refers [deg]: its film's, else the laser's own."""
        return self.laser_deg if self.projector_deg is None else self.projector_deg

    @property
    def dots_passed(self) -> float:
        """Share of the laser's light that films leave of what matte surfaces send back [0, 1]."""
        behind = 1.0 if self.imagers_deg is None else self.make.passed(Band.PROJECTOR)
        return behind * self.projector_stokes()[0]

    @property
    def speckle_patterns(self) -> float:
        """Independent patterns of the polarisations that reach the chip: 2 without a film, 1 behind an ideal one.

        Two of means T and T' count as (T + T')^2 / (T^2 + T'^2) (Goodman, chapter 3).
        """
        degree = 0.0 if self.imagers_deg is None else self.make.degree(Band.PROJECTOR)
        return 2 / (1 + degree**2)
