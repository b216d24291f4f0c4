"""Non-metals: paints, plastics, rubber, oxide scale, and what tables and rooms are made of, at 850 nm and under lamps.

Reflectances at 850 nm are measurements there or next to it where one was found; those under lamps are means of the same
samples' spectra (`materials.measured_spectra`) as the imager weighs the lamp's light. Colours mean little at 850 nm:
inks and most dyes are clear there, while carbon black absorbs as it does in the visible.
"""

from dataclasses import dataclass

from materials.coat import base_albedo
from materials.fresnel import normal_reflectance
from materials.material import Matte, RoughPlastic
from materials.measured_spectra import (
    BLACK_IRON,
    BLACK_PET,
    GREEN_PAINT,
    GREY_CONCRETE,
    GREY_PAINT,
    NEW_PINE,
    WHITE_PVC,
    Spectrum,
    grey,
)

_USGS = "USGS Spectral Library 7 (R. F. Kokaly et al., Data Series 1035, 2017), sample"
_SLUM = "SLUM spectral library (S. Kotthaus et al., ISPRS J. Photogramm. Remote Sens. 94, 194, 2014), sample"
_SICK = "remission at 905 nm, SICK LD-LRS operating instructions 8016506, table 3"
_COAT = "coat: n 1.5, alpha 0.13 as Ward's ivory computer plastic (SIGGRAPH 1992, table 1)"

COAT_INDEX = 1.5
"""Refractive index of common plastics in the near infrared (PMMA 1.48, PVC 1.53, PC 1.57) [-]."""
COAT_ALPHA = 0.13
"""Roughness of a moulded housing, G. Ward's fit to ivory computer plastic (SIGGRAPH 1992, table 1) [-]."""
_PET_MIRROR = normal_reflectance(1.57)
"""Of black PET, which its measurement includes."""
_DYED_VISIBLE, _DYED_INFRARED = 0.03, 0.30
"""A black of dyes as seen from outside, without its mirror reflection. Choices: in the visible as dark as blacks look,
L* 20 (10 to 25 without gloss: 0.01 to 0.045); beyond the dyes what the filler scatters, 0.1 to 0.5."""
_TITANIA_WHITE = Spectrum((380.0, 420.0), (0.15, 0.80))
"""White paint: titania absorbs below 420 nm, as in white PVC (GDS338), and is white from there on."""
_DYED_BLACK = Spectrum((680.0, 760.0), (_DYED_VISIBLE, _DYED_INFRARED))
"""Dyes stop to absorb around 720 nm."""


@dataclass(frozen=True)
class NonMetal:
    """A named material at 850 nm and under lamps, and where its numbers come from."""

    material: Matte | RoughPlastic
    source: str


def _matte(name: str, reflectance: float, spectrum: Spectrum, source: str) -> NonMetal:
    return NonMetal(Matte(name, reflectance, spectrum.under_lamps()), source)


def _plastic(name: str, seen: float, spectrum: Spectrum, source: str) -> NonMetal:
    """`seen`, `spectrum`: reflectance from outside, without the mirror reflection of the coat, which the model adds."""
    lamps = tuple((band, base_albedo(COAT_INDEX, mean)) for band, mean in spectrum.under_lamps())
    material = RoughPlastic(name, COAT_INDEX, COAT_ALPHA, base_albedo(COAT_INDEX, seen), lamps)
    return NonMetal(material, f"{source}; {_COAT}")


_ROWS = (
    _matte("matte_paint", 0.46, GREEN_PAINT, f"{_USGS} GDS333, light grey-green paint on aluminium: 0.458"),
    _matte(
        "white_paint",
        0.80,
        _TITANIA_WHITE,
        f"choice: as white matte paper, 0.80 ({_SICK}); titania is white from 420 nm far into the infrared",
    ),
    _matte("dark_paint", 0.10, GREY_PAINT, f"{_SLUM} Z005, metal sheet painted grey: 0.102"),
    _matte(
        "primer",
        0.30,
        grey(0.30),
        "choice: grey primer, titania and carbon black, between dark_paint and matte_paint, grey under every light",
    ),
    _matte(
        "rubber",
        0.02,
        BLACK_PET.less(_PET_MIRROR).scaled_to(0.02),
        f"black vulcanised rubber 0.020, black foam rubber 0.024; {_SICK}; colour as black_plastic, carbon black too",
    ),
    _matte("oxide", 0.06, BLACK_IRON, f"{_SLUM} Z008, weathered iron: 0.056"),
    _matte("wood_table", 0.63, NEW_PINE, f"{_USGS} GDS363, new pine: 0.634"),
    _matte("concrete", 0.31, GREY_CONCRETE, f"{_USGS} GDS375, light grey concrete: 0.313"),
    _plastic("white_plastic", 0.70, WHITE_PVC, f"{_USGS} GDS338, white PVC: 0.705"),
    # The mirror reflection of a surface of index 1.57 is 0.05.
    _plastic(
        "black_plastic",
        0.015,
        BLACK_PET.less(_PET_MIRROR),
        f"carbon black; {_USGS} GDS382, black PET: 0.064 with its mirror reflection",
    ),
    _plastic(
        "dyed_black_plastic",
        _DYED_INFRARED,
        _DYED_BLACK,
        "choice: black by dyes that are clear beyond 720 nm, filler scatters, 0.1 to 0.5; visible 0.03, 0.01 to 0.045",
    ),
    _matte(
        "black_paint",
        0.04,
        grey(0.04),
        "choice: matt paint of carbon black, grey under every light; such paints absorb 0.95 to 0.96 of sunlight "
        "(NS-7, Catalac, Z306: J. H. Henninger, NASA RP-1121, 1984)",
    ),
    _matte(
        "anodised_aluminium",
        0.69,
        grey(0.69),
        "choice: etched matt and anodised without colour, as profiles are, its sheen left out, grey under every light; "
        "two clear samples absorb 0.27 and 0.35 of sunlight (J. H. Henninger, NASA RP-1121, 1984)",
    ),
)

NON_METALS: dict[str, NonMetal] = {row.material.name: row for row in _ROWS}
"""By the name used on the command line."""
