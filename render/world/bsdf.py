"""Materials as Mitsuba BSDF descriptions. Numbers are passed, never Mitsuba's presets: in one-channel variants those
collapse to visible luminance."""

from typing import Any

from materials.lights import Band
from materials.material import Material, Matte, Measured, RoughPlastic
from render.world.measured_bsdf import measured_description


def is_diffuse(material: Material) -> bool:
    """Whether the surface is Lambertian, so that its indirect light is smooth across the surface."""
    return isinstance(material, Matte)


def bsdf_description(material: Material, band: Band = Band.PROJECTOR) -> dict[str, Any]:
    """Mitsuba dictionary of a non-metal as seen from its upper side; metals are `render.light.microfacets`.

    band: the light under which a measured file is seen; other materials come with their numbers for it
    (`materials.bands.in_band`). ValueError for a metal.
    """
    match material:
        case Matte(reflectance=reflectance):
            return {"type": "diffuse", "reflectance": _constant(reflectance)}
        case RoughPlastic(n=n, alpha=alpha, reflectance=reflectance):
            return {
                "type": "roughplastic",
                "distribution": "ggx",
                "int_ior": n,
                "alpha": alpha,
                "diffuse_reflectance": _constant(reflectance),
                "nonlinear": True,
            }
        case Measured(path=path):
            return measured_description(path, band)
    raise ValueError(f"{material.name}: metals are formulas of render.light.microfacets, not BSDFs of Mitsuba's")


def _constant(value: float) -> dict[str, Any]:
    return {"type": "spectrum", "value": float(value)}
