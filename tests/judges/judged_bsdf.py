"""Materials as Mitsuba's own BSDFs, for the judge."""

from typing import Any

from materials.bands import in_band
from materials.lights import Band
from materials.material import Material, Matte, RoughConductor
from render.world.bsdf import bsdf_description
from tests.judges.compensated_conductor import conductor_description


def judged_bsdf(material: Material, band: Band = Band.PROJECTOR) -> dict[str, Any]:
    """A BSDF that looks alike from both sides, as all bodies do here, under the light of a band."""
    seen = in_band(material, band)
    one_sided = metal_description(seen) if isinstance(seen, RoughConductor) else bsdf_description(seen, band)
    return {"type": "twosided", "bsdf": one_sided}


def metal_description(metal: RoughConductor) -> dict[str, Any]:
    """`roughconductor`, with the lobe of further bounces, under a share of diffuse oxide."""
    bare = conductor_description(metal)
    if metal.oxide_share == 0:
        return bare
    oxide = bsdf_description(Matte("oxide", metal.oxide_reflectance))
    return {"type": "blendbsdf", "weight": metal.oxide_share, "bare": bare, "oxide": oxide}
