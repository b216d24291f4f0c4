"""Complex refractive index n + ik of metals at 850 nm and under lamps: one table, each row with its source.

Values are linear interpolations of the tables in the refractiveindex.info database (M. N. Polyanskiy, Sci. Data 11, 94
(2024), public domain) at the wavelength of the D400 infrared projector, and the pairs that reflect as the whole table
does under a lamp (`materials.effective_constants`); `python -m docs.figures.bands PAGE` prints both for a page of it.
Entries named Werner are left out (they disagree with every other source), and so is zinc, whose only table is suspect.
"""

from dataclasses import dataclass

from materials.input_error import InputError
from materials.lights import REFERENCE_NM
from materials.suggestion import suggest

WAVELENGTH_NM = REFERENCE_NM
"""Of the projector's light [nm]."""
BAND_NM = (840.0, 860.0)
"""The datasheet's tolerance on it, +-10 nm. Across this band the normal reflectance of every row moves by less than
0.004, so that one n, k serves; outside it they are not valid [nm]."""

_JOHNSON_1972 = "P. B. Johnson, R. W. Christy, Phys. Rev. B 6, 4370 (1972)"
_JOHNSON_1974 = "P. B. Johnson, R. W. Christy, Phys. Rev. B 9, 5056 (1974)"
_KARLSSON = "B. Karlsson, C. G. Ribbing, J. Appl. Phys. 53, 6340 (1982)"
_QUERRY = "M. R. Querry, Contractor Report CRDC-CR-85034 (1985)"
_RAKIC = "A. D. Rakic, Appl. Opt. 34, 4755 (1995)"
_WEAVER = "J. H. Weaver, C. G. Olson, D. W. Lynch, Phys. Rev. B 12, 1293 (1975)"


@dataclass(frozen=True)
class OpticalConstants:
    """One metal: n + ik of the bare metal at 850 nm, linear between the rows of the source's table, and under lamps.

    `n` and `k` are valid in `BAND_NM`; `optical_constants` refuses other wavelengths. Oxide and the alloy's exact make
    are left out: plain carbon steel is taken as iron.
    """

    n: float
    """Real part of the refractive index [-]."""
    k: float
    """Extinction coefficient [-]."""
    citation: str
    """Who measured it, and on what where that matters."""
    page: str
    """shelf/book/page in refractiveindex.info."""
    measured_nm: tuple[float, float]
    """Wavelengths that the source covers [nm]; they hold those of the lamps, 360 to 1100."""
    white_led: tuple[float, float]
    """n and k under white LEDs [-], as `materials.effective_constants` defines them."""
    halogen: tuple[float, float]
    """The same under halogen lamps [-]."""


METALS: dict[str, OpticalConstants] = {
    # Avesta 832 MV, 18.5 % Cr, 9.3 % Ni: the 304/316 family of fittings and sheet.
    "stainless_austenitic": OpticalConstants(
        3.249,
        4.905,
        _KARLSSON,
        "other/stainless_steel/Karlsson-austenitic",
        (200.0, 2500.0),
        (2.125, 3.795),
        (2.684, 4.417),
    ),
    # Avesta 393 M, 13.5 % Cr: the 400 family of blades and screws.
    "stainless_ferritic": OpticalConstants(
        2.568,
        4.019,
        _KARLSSON,
        "other/stainless_steel/Karlsson-ferritic",
        (200.0, 2500.0),
        (1.951, 3.243),
        (2.286, 3.679),
    ),
    # Stands for plain carbon steel as well: the database has no table of it.
    "iron": OpticalConstants(
        2.948, 3.459, _JOHNSON_1974, "main/Fe/Johnson", (188.0, 1937.0), (2.859, 2.989), (2.881, 3.267)
    ),
    "chromium": OpticalConstants(
        3.241, 3.496, _JOHNSON_1974, "main/Cr/Johnson", (188.0, 1937.0), (3.012, 3.312), (3.133, 3.414)
    ),
    "nickel": OpticalConstants(
        2.317, 5.076, _JOHNSON_1974, "main/Ni/Johnson", (188.0, 1937.0), (1.888, 3.721), (2.046, 4.432)
    ),
    "aluminium": OpticalConstants(
        2.588, 8.169, _RAKIC, "main/Al/Rakic", (0.12399, 200000.0), (1.165, 6.925), (1.802, 7.849)
    ),
    "copper": OpticalConstants(
        0.276, 5.420, _JOHNSON_1972, "main/Cu/Johnson", (187.9, 1937.0), (0.601, 2.705), (0.275, 3.123)
    ),
    # 70 % Cu, 30 % Zn.
    "brass": OpticalConstants(
        0.490, 5.269, _QUERRY, "other/Cu-Zn/Querry-Cu70Zn30", (210.0, 55555.6), (0.494, 2.678), (0.398, 3.488)
    ),
    "titanium": OpticalConstants(
        3.243, 3.990, _JOHNSON_1974, "main/Ti/Johnson", (188.0, 1937.0), (2.563, 3.534), (2.915, 3.841)
    ),
    "gold": OpticalConstants(
        0.164, 5.319, _JOHNSON_1972, "main/Au/Johnson", (187.9, 1937.0), (0.367, 2.393), (0.164, 2.763)
    ),
    "silver": OpticalConstants(
        0.040, 5.965, _JOHNSON_1972, "main/Ag/Johnson", (187.9, 1937.0), (0.049, 3.602), (0.037, 4.269)
    ),
    "tungsten": OpticalConstants(
        3.395, 2.861, _WEAVER, "main/W/Weaver", (44.29, 4110.0), (3.547, 2.793), (3.532, 2.909)
    ),
}


def optical_constants(metal: str, wavelength_nm: float = WAVELENGTH_NM) -> OpticalConstants:
    """Constants of a metal of the table; raises InputError for an unknown metal or a wavelength outside `BAND_NM`."""
    if metal not in METALS:
        raise InputError(f"{metal}: unknown metal; {suggest(metal, METALS)}")
    low, high = BAND_NM
    if not low <= wavelength_nm <= high:
        raise InputError(
            f"{metal}: its n, k hold from {low:g} to {high:g} nm, not at {wavelength_nm:g} nm; "
            "give n, k for that wavelength in a material file"
        )
    return METALS[metal]
