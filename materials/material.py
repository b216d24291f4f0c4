"""Materials as plain data at 850 nm; `render.bsdf` turns them into Mitsuba BSDFs."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class RoughConductor:
    """A metal: GGX microfacets with complex index n + ik (Walter et al. 2007), and an optional diffuse oxide share."""

    name: str
    """`metal:finish`."""
    n: float
    """Real part of the refractive index at 850 nm [-]."""
    k: float
    """Extinction coefficient at 850 nm [-]."""
    alpha_u: float
    """GGX roughness along the mesh's u direction (the lay runs along u) [-]."""
    alpha_v: float
    """GGX roughness along v, across the lay [-]."""
    oxide_share: float = 0.0
    """Share of the surface that reflects diffusely [0, 1]."""
    oxide_reflectance: float = 0.0
    """Albedo of that share at 850 nm [0, 1]."""


@dataclass(frozen=True)
class RoughPlastic:
    """A dielectric coat over a diffuse base."""

    name: str
    n: float
    """Refractive index of the coat at 850 nm [-]."""
    alpha: float
    """GGX roughness of the coat [-]."""
    reflectance: float
    """Albedo of the base at 850 nm [0, 1]."""


@dataclass(frozen=True)
class Matte:
    """A Lambertian surface."""

    name: str
    reflectance: float
    """Albedo at 850 nm [0, 1]."""


@dataclass(frozen=True)
class Measured:
    """A measured RGL `.bsdf` file (Dupuy and Jakob 2018), sampled at 850 nm or its nearest stored wavelength."""

    name: str
    path: Path


Material = RoughConductor | RoughPlastic | Matte | Measured
