"""What a material is made of, in numbers and sources, for the command line and for reports."""

from dataclasses import dataclass, replace

from materials.bands import in_band, knows_band
from materials.catalog import material, material_names, metal_names
from materials.coat import seen_reflectance
from materials.finishes import FINISHES
from materials.fresnel import normal_reflectance
from materials.lights import LAMP_BANDS, Band
from materials.material import Material, Matte, Measured, RoughConductor, RoughPlastic
from materials.non_metals import NON_METALS
from materials.optical_constants import METALS
from materials.user_materials import NO_USER_MATERIALS, UserMaterials


@dataclass(frozen=True)
class Description:
    """One material; what does not apply to it is None.

    For people and reports: what the renderer needs is in `materials.material`. A measured file has its path in `source`
    and no numbers here.
    """

    name: str
    kind: str
    """`metal`, `plastic`, `matte` or `measured`."""
    source: str
    """Where its numbers come from."""
    n: float | None = None
    """Refractive index of the metal or the coat at 850 nm [-]."""
    k: float | None = None
    """Extinction coefficient at 850 nm [-]."""
    normal_reflectance: float | None = None
    """Fresnel reflectance of a facet at normal incidence [0, 1]."""
    alpha_u: float | None = None
    """GGX roughness along the lay [-]."""
    alpha_v: float | None = None
    """GGX roughness across it [-]."""
    diffuse_reflectance: float | None = None
    """What is reflected diffusely: by a paint, by a plastic as seen from outside, by a metal's oxide [0, 1]."""
    under_lamps: tuple[tuple[Band, float], ...] = ()
    """Under the lamps of which the material has numbers of its own: `normal_reflectance` of a metal, otherwise
    `diffuse_reflectance` [0, 1]. Under others the numbers at 850 nm stand for it."""

    def line(self) -> str:
        """One line for people, such as `iron:polished  metal  n 2.948 ... R0 0.57  alpha 0.03  under ... (...)`."""
        parts = [self.name, self.kind]
        if self.n is not None:
            parts.append(f"n {self.n:.3f}")
        if self.k is not None:
            parts.append(f"k {self.k:.3f}")
        if self.normal_reflectance is not None:
            parts.append(f"R0 {self.normal_reflectance:.2f}")
        if self.alpha_u is not None and self.alpha_v is not None:
            lay = "" if self.alpha_u == self.alpha_v else f" x {self.alpha_v:.3g}"
            parts.append(f"alpha {self.alpha_u:.3g}{lay}")
        if self.diffuse_reflectance is not None:
            parts.append(f"diffuse {self.diffuse_reflectance:.2g}")
        if self.kind != "measured":  # a file is evaluated at the lamps' wavelengths
            parts.append(_lamp_words(dict(self.under_lamps)))
        return "  ".join([*parts, f"({self.source})"])


def describe(spec: str, user: UserMaterials = NO_USER_MATERIALS) -> Description:
    """Numbers and sources of a material; raises InputError as `materials.catalog.material` does."""
    found = material(spec, user)
    row = _at_850(found, user)
    lit = ((band, _at_850(in_band(found, band), user)) for band in LAMP_BANDS if knows_band(found, band))
    numbers = (
        (band, other.normal_reflectance if row.kind == "metal" else other.diffuse_reflectance) for band, other in lit
    )
    return replace(row, under_lamps=tuple((band, number) for band, number in numbers if number is not None))


def _lamp_words(under_lamps: dict[Band, float]) -> str:
    """`under white_led 0.63, halogen 0.89`, and where a lamp counts as 850 nm does."""
    known = [f"{band.value} {under_lamps[band]:.2g}" for band in LAMP_BANDS if band in under_lamps]
    unknown = [band.value for band in LAMP_BANDS if band not in under_lamps]
    words = [f"under {', '.join(known)}"] if known else []
    if unknown:
        words.append(f"under {', '.join(unknown)} as at 850 nm")
    return ", ".join(words)


def _at_850(found: Material, user: UserMaterials) -> Description:
    """The row without lamps."""
    match found:
        case RoughConductor(n=n, k=k, alpha_u=alpha_u, alpha_v=alpha_v):
            diffuse = found.oxide_share * found.oxide_reflectance if found.oxide_share else None
            source = _metal_source(found.name, user)
            return Description(found.name, "metal", source, n, k, normal_reflectance(n, k), alpha_u, alpha_v, diffuse)
        case RoughPlastic(n=n, alpha=alpha, reflectance=base):
            source, seen = _source(found.name, user), seen_reflectance(n, base)
            return Description(found.name, "plastic", source, n, None, normal_reflectance(n), alpha, alpha, seen)
        case Matte(reflectance=reflectance):
            return Description(found.name, "matte", _source(found.name, user), diffuse_reflectance=reflectance)
        case Measured(path=path):
            return Description(found.name, "measured", f"{_source(found.name, user)}; {path}")


def describe_all(user: UserMaterials = NO_USER_MATERIALS) -> tuple[Description, ...]:
    """Every metal, polished, and every other material: the list that the command line shows."""
    metals = metal_names(user)
    return tuple(describe(f"{n}:polished" if n in metals else n, user) for n in material_names(user))


def _metal_source(name: str, user: UserMaterials) -> str:
    """Sources of the constants and of the roughness."""
    metal, _, rest = name.partition(":")
    finish, _, override = rest.partition("@")
    constants = METALS[metal].citation if metal in METALS else _source(metal, user)
    return f"n, k: {constants}; roughness: {'given by hand' if override else FINISHES[finish].source}"


def _source(name: str, user: UserMaterials) -> str:
    return NON_METALS[name].source if name in NON_METALS else user.materials[name].source
