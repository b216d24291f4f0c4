"""Materials as Mitsuba BSDF descriptions. Numbers are passed, never Mitsuba's presets: in one-channel variants those
collapse to visible luminance."""

from typing import Any

from materials.material import Material, Matte, Measured, RoughConductor, RoughPlastic
from render.world.conductor import conductor_description
from render.world.measured_bsdf import measured_description


def is_diffuse(material: Material) -> bool:
    """Whether the surface is Lambertian, so that its indirect light is smooth across the surface."""
    return isinstance(material, Matte)


def bsdf_description(material: Material) -> dict[str, Any]:
    """Mitsuba dictionary of the material as seen from its upper side."""
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
        case RoughConductor():
            return _conductor(material)
        case Measured(path=path):
            return measured_description(path)


def _conductor(metal: RoughConductor) -> dict[str, Any]:
    bare = conductor_description(metal)
    if metal.oxide_share == 0:
        return bare
    oxide = bsdf_description(Matte("oxide", metal.oxide_reflectance))
    return {"type": "blendbsdf", "weight": metal.oxide_share, "bare": bare, "oxide": oxide}


def _constant(value: float) -> dict[str, Any]:
    return {"type": "spectrum", "value": float(value)}
