"""Non-metals at 850 nm: paints, plastics, rubber, oxide scale, and what tables and rooms are made of.

Reflectances are measurements at or next to 850 nm where one was found. Colours mean little there: inks and most dyes
are clear at 850 nm, while carbon black absorbs as it does in the visible.
"""

from dataclasses import dataclass

from materials.coat import base_albedo
from materials.material import Matte, RoughPlastic

_USGS = "USGS Spectral Library 7 (R. F. Kokaly et al., Data Series 1035, 2017), sample"
_SLUM = "SLUM spectral library (S. Kotthaus et al., ISPRS J. Photogramm. Remote Sens. 94, 194, 2014), sample"
_SICK = "remission at 905 nm, SICK LD-LRS operating instructions 8016506, table 3"
_COAT = "coat: n 1.5, alpha 0.13 as Ward's ivory computer plastic (SIGGRAPH 1992, table 1)"

COAT_INDEX = 1.5
"""Refractive index of common plastics in the near infrared (PMMA 1.48, PVC 1.53, PC 1.57) [-]."""
COAT_ALPHA = 0.13
"""Roughness of a moulded housing, G. Ward's fit to ivory computer plastic (SIGGRAPH 1992, table 1) [-]."""


@dataclass(frozen=True)
class NonMetal:
    """A named material at 850 nm and where its numbers come from."""

    material: Matte | RoughPlastic
    source: str


def _matte(name: str, reflectance: float, source: str) -> NonMetal:
    return NonMetal(Matte(name, reflectance), source)


def _plastic(name: str, seen: float, source: str) -> NonMetal:
    """`seen` is the reflectance from outside, without the mirror reflection of the coat, which the model adds."""
    material = RoughPlastic(name, COAT_INDEX, COAT_ALPHA, base_albedo(COAT_INDEX, seen))
    return NonMetal(material, f"{source}; {_COAT}")


_ROWS = (
    _matte("matte_paint", 0.46, f"{_USGS} GDS333, light grey-green paint on aluminium: 0.458"),
    _matte(
        "white_paint", 0.80, f"choice: as white matte paper, 0.80 ({_SICK}); titania is white far into the infrared"
    ),
    _matte("dark_paint", 0.10, f"{_SLUM} Z005, metal sheet painted grey: 0.102"),
    _matte("primer", 0.30, "choice: grey primer, titania and carbon black, between dark_paint and matte_paint"),
    _matte("rubber", 0.02, f"black vulcanised rubber 0.020, black foam rubber 0.024; {_SICK}"),
    _matte("oxide", 0.06, f"{_SLUM} Z008, weathered iron: 0.056"),
    _matte("wood_table", 0.63, f"{_USGS} GDS363, new pine: 0.634"),
    _matte("concrete", 0.31, f"{_USGS} GDS375, light grey concrete: 0.313"),
    _plastic("white_plastic", 0.70, f"{_USGS} GDS338, white PVC: 0.705"),
    # The mirror reflection of a surface of index 1.57 is 0.05.
    _plastic("black_plastic", 0.015, f"carbon black; {_USGS} GDS382, black PET: 0.064 with its mirror reflection"),
    _plastic(
        "dyed_black_plastic", 0.30, "choice: black by dyes that are clear beyond 720 nm, filler scatters; 0.1 to 0.5"
    ),
)

NON_METALS: dict[str, NonMetal] = {row.material.name: row for row in _ROWS}
"""By the name used on the command line."""
