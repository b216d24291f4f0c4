"""Surface finishes as GGX roughness: nominal values, the ranges that studies sweep, how alpha follows from a profile.

Roughness and slope. GGX and Beckmann share alpha: the cores of the two distributions have the same width. For Beckmann
(Gaussian heights) alpha is the root-mean-square slope over both directions, sqrt(2) times a profile's RMS slope Rdq
(B. Walter et al., Microfacet models for refraction through rough surfaces, EGSR 2007). GGX has a longer tail: its RMS
slope diverges, its *median* slope is alpha exactly. Ra, a height, says nothing about alpha.

Measured anchors are the RMS slopes that G. Ward fitted to real sheets (Measuring and modeling anisotropic reflection,
SIGGRAPH 1992, table 1; the same alpha as Beckmann's): rolled brass 0.05 x 0.16, rolled aluminium 0.04 x 0.09, lightly
brushed aluminium 0.088 x 0.13. What has no anchor is a choice, and says so.
"""

from dataclasses import dataclass

from materials.input_error import InputError
from materials.lights import Band
from materials.measured_spectra import BLACK_IRON, Spectrum, grey


@dataclass(frozen=True)
class Finish:
    """GGX roughness of a finish, nominal and as a range that studies sweep; u runs along the lay.

    alpha is the median slope of the facets, not a height such as Ra; `alpha_from_profile_slope` gives it from a
    profile. A finish is the same all over the surface: single scratches, waviness and feed marks as such are left out.
    """

    alpha_u: float
    """Nominal roughness along the lay [-]."""
    alpha_v: float
    """Nominal roughness across the lay [-]."""
    range_u: tuple[float, float]
    """Lowest and highest roughness along the lay that real parts show [-]."""
    range_v: tuple[float, float]
    """The same across the lay [-]."""
    source: str
    """Where the numbers come from, or `choice` and why."""
    oxide_share: float = 0.0
    """Share of the surface under a diffuse oxide [0, 1]."""

    @property
    def isotropic(self) -> bool:
        """Whether the finish has no lay."""
        return self.alpha_u == self.alpha_v


def _isotropic(alpha: float, low: float, high: float, source: str, oxide_share: float = 0.0) -> Finish:
    return Finish(alpha, alpha, (low, high), (low, high), source, oxide_share)


FINISHES: dict[str, Finish] = {
    "mirror": _isotropic(0.010, 0.005, 0.020, "choice: lapped or electropolished; mirrors edges to 1 deg"),
    "polished": _isotropic(0.030, 0.020, 0.050, "choice: buffed fittings; mirrors edges with a blur of 2-6 deg"),
    "bright": _isotropic(0.070, 0.050, 0.100, "rolled or plated: the mean of Ward's rolled aluminium, 0.04 x 0.09"),
    "ground": Finish(0.05, 0.15, (0.03, 0.08), (0.10, 0.20), "Ward's rolled brass, 0.05 x 0.16, has the same streaks"),
    "brushed": Finish(
        0.05, 0.28, (0.03, 0.09), (0.13, 0.35), "choice: from Ward's lightly brushed aluminium (0.088 x 0.13) to coarse"
    ),
    "milled": Finish(0.08, 0.25, (0.05, 0.12), (0.15, 0.35), "choice: feed marks across, cutter chatter along"),
    "blasted": _isotropic(0.30, 0.20, 0.40, "choice: glass bead, median slope 17 deg"),
    "coarse_blasted": _isotropic(0.50, 0.40, 0.60, "choice: corundum grit, median slope 27 deg"),
    "oxidised": _isotropic(
        0.60, 0.40, 0.80, "choice: as cast or scaled; with it the total reflectance meets emissivity tables", 0.5
    ),
}

OXIDE_REFLECTANCE: dict[str, float] = {
    # Black iron oxide: weathered iron measured 0.056 at 850 nm (SLUM library, sample Z008; S. Kotthaus et al., ISPRS J.
    # Photogramm. Remote Sens. 94, 194 (2014)). Steels grow the same spinels.
    "iron": 0.06,
    "stainless_austenitic": 0.06,
    "stainless_ferritic": 0.06,
    # Choices, so that half oxide and half rough metal together come near 1 - emissivity at 1.0 um of the oxidised
    # metal in Raytek's table for pyrometers: nickel 0.8-0.9, copper 0.2-0.8, brass 0.6, aluminium 0.4; titanium has
    # 0.6-0.8 at 1.6 um.
    "nickel": 0.06,
    "copper": 0.10,
    "brass": 0.10,
    "aluminium": 0.45,
    "titanium": 0.10,
    # Choices: chromium green and the yellow tungsten oxide are pigments, silver tarnishes to a black sulphide.
    "chromium": 0.20,
    "tungsten": 0.40,
    "silver": 0.10,
}
"""Albedo at 850 nm of what grows on each metal. Gold grows nothing."""

_OXIDE_COLOURS: dict[str, Spectrum] = {
    # As measured: weathered iron, SLUM Z008.
    **dict.fromkeys(("iron", "stainless_austenitic", "stainless_ferritic"), BLACK_IRON),
    # Choices, by where the oxides absorb. Brown: tenorite is black up to its gap at 1.4 eV (890 nm), cuprite absorbs to
    # 2 eV (620 nm).
    **dict.fromkeys(("copper", "brass"), Spectrum((450.0, 620.0, 850.0), (0.05, 0.06, 0.10))),
    # Chromium(III) absorbs around 460 and 600 nm, which leaves green, and little beyond 700 nm.
    "chromium": Spectrum((410.0, 460.0, 535.0, 600.0, 650.0, 760.0), (0.07, 0.05, 0.12, 0.06, 0.07, 0.20)),
    # Yellow: the trioxide absorbs below its gap at 2.7 eV (460 nm).
    "tungsten": Spectrum((430.0, 490.0), (0.05, 0.40)),
}
"""Colours of oxides, scaled to the albedo at 850 nm; oxides that are not named are grey (choice: black, or white)."""


def oxide_reflectance(metal: str) -> float:
    """Albedo of a metal's oxide at 850 nm; raises InputError for metals without one."""
    if metal not in OXIDE_REFLECTANCE:
        raise InputError(f"{metal}:oxidised: {metal} has no known oxide layer; take another finish, such as blasted")
    return OXIDE_REFLECTANCE[metal]


def oxide_under_lamps(metal: str) -> dict[Band, float]:
    """Albedo of a metal's oxide under each kind of lamp; raises InputError for metals without one."""
    at_850 = oxide_reflectance(metal)
    return dict(_OXIDE_COLOURS.get(metal, grey(at_850)).scaled_to(at_850).under_lamps())


def alpha_from_profile_slope(rms_slope: float) -> float:
    """GGX alpha of a surface whose profile in one direction has the RMS slope Rdq (ISO 21920-2): sqrt(2) Rdq.

    Isotropic surfaces have one Rdq; with a lay, alpha_u follows from the profile along it, alpha_v from the one across.
    """
    return 2.0**0.5 * rms_slope


def profile_slope_from_alpha(alpha: float) -> float:
    """RMS slope Rdq of a profile along a direction of roughness `alpha`; the inverse of `alpha_from_profile_slope`."""
    return alpha / 2.0**0.5
