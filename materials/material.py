"""Materials as plain data at 850 nm and under the lamps' light; `render.world.bsdf` turns them into Mitsuba BSDFs.

Every one checks its own numbers when it is made, so that no invalid material exists anywhere. What a number is under a
lamp is its mean over the lamp's spectrum as the imager weighs it (`materials.lights`); `materials.bands.in_band` puts
it in the place of the one at 850 nm. A lamp that a material does not name counts as light at 850 nm does.
"""

import math
from dataclasses import dataclass
from pathlib import Path

from materials.input_error import InputError
from materials.lights import Band

ALPHA_MIN = 0.001
"""Smallest GGX roughness [-]. Choice: a tenth of a good mirror; in smaller lobes paths miss the projector."""
ALPHA_MAX = 1.0
"""Largest GGX roughness [-]: above it half of all facets are steeper than 45 deg and no height field is left."""
ALPHA_RANGE = (ALPHA_MIN, ALPHA_MAX)
INDEX_RANGE = (0.01, 20.0)
"""n and k that a metal can have from the visible to the near infrared [-]; outside it a table has been misread."""
COAT_INDEX_RANGE = (1.3, 1.8)
"""Refractive indices of clear coats [-]: polymers have 1.34 (fluorinated) to 1.65 (polysulfone), and some room."""
SHARE_RANGE = (0.0, 1.0)


def _check(material: str, field: str, value: float, limits: tuple[float, float]) -> None:
    """Raise InputError unless `value` is a finite number inside `limits`."""
    low, high = limits
    if not (math.isfinite(value) and low <= value <= high):
        raise InputError(f"{material}: {field} is {value:g}; give a number from {low:g} to {high:g}")


def _check_lamps(material: str, lamps: tuple[tuple[Band, object], ...]) -> None:
    """Raise InputError unless every lamp is named once, and none of them is the projector."""
    bands = [band for band, _ in lamps]
    if Band.PROJECTOR in bands or len(set(bands)) < len(bands):
        names = ", ".join(band.value for band in bands)
        raise InputError(f"{material}: has numbers for {names}; give each kind of lamp once, the projector apart")


def _check_lamp_reflectances(material: str, lamps: tuple[tuple[Band, float], ...]) -> None:
    _check_lamps(material, lamps)
    for band, reflectance in lamps:
        _check(material, f"reflectance under {band.value}", reflectance, SHARE_RANGE)


@dataclass(frozen=True)
class ConductorNumbers:
    """What depends on the light in a `RoughConductor`; checked there."""

    n: float
    """Real part of the refractive index [-]."""
    k: float
    """Extinction coefficient [-]."""
    oxide_reflectance: float = 0.0
    """Albedo of the oxide [0, 1]."""


@dataclass(frozen=True)
class RoughConductor:
    """A metal: GGX microfacets with complex index n + ik (Walter et al. 2007), and an optional diffuse oxide share.

    BRDF = (1 - s) (F D G / (4 cos_i cos_o) + f_more) + s rho / pi, with s the oxide's share, rho its albedo, F for
    unpolarised light, and f_more the light of further bounces (`materials.energy_compensation`). Light goes by rays: no
    diffraction, and no film of oil or clear oxide. Raises InputError for a number out of `INDEX_RANGE`, `ALPHA_RANGE`
    or [0, 1].
    """

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
    lamps: tuple[tuple[Band, ConductorNumbers], ...] = ()
    """n, k and `oxide_reflectance` under the lamps' light; n, k as `materials.effective_constants` has them."""

    def __post_init__(self) -> None:
        _check_lamps(self.name, self.lamps)
        for band, numbers in self.lamps:
            _check(self.name, f"n under {band.value}", numbers.n, INDEX_RANGE)
            _check(self.name, f"k under {band.value}", numbers.k, INDEX_RANGE)
            _check(self.name, f"oxide_reflectance under {band.value}", numbers.oxide_reflectance, SHARE_RANGE)
        _check(self.name, "n", self.n, INDEX_RANGE)
        _check(self.name, "k", self.k, INDEX_RANGE)
        _check(self.name, "alpha_u", self.alpha_u, ALPHA_RANGE)
        _check(self.name, "alpha_v", self.alpha_v, ALPHA_RANGE)
        _check(self.name, "oxide_share", self.oxide_share, SHARE_RANGE)
        _check(self.name, "oxide_reflectance", self.oxide_reflectance, SHARE_RANGE)


@dataclass(frozen=True)
class RoughPlastic:
    """A dielectric coat over a diffuse base.

    Model: GGX facets of a clear coat and a Lambertian base below, which the inside of the coat lights again and again
    (Saunderson 1942, see `materials.coat`; Mitsuba's `roughplastic`, `nonlinear`). The coat absorbs nothing. Raises
    InputError for a number out of `COAT_INDEX_RANGE`, `ALPHA_RANGE` or [0, 1].
    """

    name: str
    n: float
    """Refractive index of the coat at 850 nm [-]."""
    alpha: float
    """GGX roughness of the coat [-]."""
    reflectance: float
    """Albedo of the base at 850 nm [0, 1], under the coat; `materials.coat` relates it to what is seen from outside."""
    lamps: tuple[tuple[Band, float], ...] = ()
    """`reflectance` under the lamps' light; the coat's index, larger by 0.01 in the visible, is taken as fixed."""

    def __post_init__(self) -> None:
        _check_lamp_reflectances(self.name, self.lamps)
        _check(self.name, "n", self.n, COAT_INDEX_RANGE)
        _check(self.name, "alpha", self.alpha, ALPHA_RANGE)
        _check(self.name, "reflectance", self.reflectance, SHARE_RANGE)


@dataclass(frozen=True)
class Matte:
    """A Lambertian surface: BRDF = reflectance / pi [1/sr], whatever the directions.

    The renderer interpolates light on such surfaces alone (`render.light.smooth`), and matte twins are made of it
    (`materials.catalog.matte_twin`). Raises InputError for a reflectance outside [0, 1].
    """

    name: str
    reflectance: float
    """Albedo at 850 nm [0, 1]."""
    lamps: tuple[tuple[Band, float], ...] = ()
    """`reflectance` under the lamps' light."""

    def __post_init__(self) -> None:
        _check_lamp_reflectances(self.name, self.lamps)
        _check(self.name, "reflectance", self.reflectance, SHARE_RANGE)


@dataclass(frozen=True)
class Measured:
    """A measured spectral RGL `.bsdf` file (Dupuy and Jakob 2018), interpolated to 850 nm, or averaged
    over a lamp's light with `materials.bands.band_weights`.

    It holds the file's name alone; `materials.measured_file` checks the file where it is named and before it is
    rendered.
    """

    name: str
    path: Path


Material = RoughConductor | RoughPlastic | Matte | Measured
