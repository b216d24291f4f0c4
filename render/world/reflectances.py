"""What the bodies of a scene are made of, as lookups by body on the device, in the two bands that the imagers see.

The projector shines at 850 nm and the lamps with a spectrum of their own (`Scene.lamp_band`), so every material is
looked up twice. Lambertian surfaces and metals, which most scenes are made of, are formulas over these numbers
(`render.light.scatter`); other materials keep Mitsuba's BSDFs, whose calls are dispatched.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32

from materials.bands import in_band
from materials.energy_compensation import albedo_table, multiple_scattering_reflectance
from materials.lights import Band
from materials.material import Material, Matte, Measured, RoughConductor
from render.world import backend
from render.world.bsdf import bsdf_description
from render.world.scene_geometry import registry_number

LOOKUP_SIZE = 256
"""Entries of a lookup: bodies, lamps, and nothing (`render.world.mitsuba_scene.NO_BODY`)."""
LAMBERTIAN, CONDUCTOR, OTHER = 1, 2, 3
"""Kinds of surface; 0 is a lamp or nothing."""
NEGLIGIBLE_LOSS = 0.01
"""Mean lost share below which a metal's lobe of further bounces is left out (choice: under one grey value at mid
grey)."""
SHARP_BRDF = 8.0
"""Peak of a lobe above which it counts as sharp [1/sr]. Choice: that of a perfect mirror's facets of alpha 0.1, 1 / (4
pi alpha^2), below which 128 directions over the hemisphere begin to step over the lobe."""
NEEDLE_BRDF = 4 * SHARP_BRDF
"""Peak above which, where photons are shot at all, a lobe is connected behind no Lambertian surface [1/sr]. Where none
are counted either, this light is left out: rare bright paths would speckle mirrors, and specks are holes. Choice:
alpha below 0.05; with those of 0.01 a mirror ball loses 1 % of its depth."""
SHARP, NEEDLE = 1, 2
"""Values of `Reflectances.sharp`; 0 is neither."""
LOSS_ROWS, LOSS_COLUMNS = 32, 9
"""Nodes of a metal's table of lost light over sqrt(cos) and over a quarter turn of azimuth
(`materials.energy_compensation.AlbedoTable`)."""
CONDUCTOR_FIELDS = 16
"""Numbers of one metal: alpha_u, alpha_v, n, k; n, k under the lamps, place in `lost` or -1, 0; share of oxide, its
albedo, its albedo under the lamps, chance to sample the cosine lobe; scale of the lobe of further bounces, the same
under the lamps, 0, 0."""


@dataclass(frozen=True, eq=False)
class Reflectances:
    """Lookups by body (`LoadedScene.body`), `LOOKUP_SIZE` entries each; a pair holds 850 nm and the lamps' band.

    A metal is `materials.material.RoughConductor` with the lobe of further bounces that
    `materials.energy_compensation` describes, where it loses more than NEGLIGIBLE_LOSS.
    """

    materials: tuple[Material, ...]
    """Of the bodies, in their order."""
    band: Band
    """Of the lamps."""
    kind: Any
    """UInt32: LAMBERTIAN, CONDUCTOR, OTHER, or 0."""
    sharp: Any
    """UInt32: SHARP where the lobe is narrower than what gathered directions resolve, SHARP_BRDF; NEEDLE where it is
    narrower than NEEDLE_BRDF, too; else 0."""
    albedo: tuple[Any, Any]
    """Float: of Lambertian bodies, 0 for all else."""
    conductors: Any
    """Float: `CONDUCTOR_FIELDS` numbers a body, 0 for all but metals."""
    lost: Any
    """Texture2f: 1 - E of the metals that lose light, one table under the other; None if there is no such metal."""

    @classmethod
    def of(cls, materials: Sequence[Material], band: Band) -> "Reflectances":
        """Upload. InputError for a file that cannot be used."""
        mi = backend.mitsuba()
        import drjit as dr

        kind, sharp = np.zeros(LOOKUP_SIZE, np.uint32), np.zeros(LOOKUP_SIZE, np.uint32)
        albedo = np.zeros((2, LOOKUP_SIZE), np.float32)
        conductors, lost = np.zeros((LOOKUP_SIZE, CONDUCTOR_FIELDS), np.float32), []
        for body, material in enumerate(materials):
            kind[body] = _kind(material)
            match material, in_band(material, band):
                case Matte(reflectance=reflectance), Matte(reflectance=under_lamps):
                    albedo[:, body] = reflectance, under_lamps
                case RoughConductor() as metal, RoughConductor() as under_lamps:
                    conductors[body] = _conductor(metal, under_lamps, lost)
                    peak = (1 - metal.oxide_share) / (4 * np.pi * metal.alpha_u * metal.alpha_v)
                    sharp[body] = NEEDLE if peak > NEEDLE_BRDF else SHARP if peak > SHARP_BRDF else 0
        tables = np.concatenate(lost)[..., None] if lost else None
        return cls(
            tuple(materials),
            band,
            mi.UInt32(kind),
            mi.UInt32(sharp),
            (mi.Float(albedo[0]), mi.Float(albedo[1])),
            mi.Float(conductors.ravel()),
            None if tables is None else mi.Texture2f(mi.TensorXf(tables), wrap_mode=dr.WrapMode.Clamp),
        )

    @cached_property
    def is_lambertian(self) -> Bool[np.ndarray, "256"]:
        """By body, on the host."""
        return self.kind.numpy() == LAMBERTIAN

    @property
    def has_conductors(self) -> bool:
        """Whether any body is a metal."""
        return any(_kind(material) == CONDUCTOR for material in self.materials)

    @property
    def has_others(self) -> bool:
        """Whether any body asks a BSDF of Mitsuba's."""
        return any(_kind(material) == OTHER for material in self.materials)

    @property
    def bsdfs(self) -> tuple[Any, Any]:
        """BSDFPtr lookups for 850 nm and for the lamps' band, of the bodies of kind OTHER; null for all others.

        They are made when this is first asked for: ask before a loop is recorded, where errors would lose their text.
        InputError for a file that cannot be used.
        """
        return self._bsdfs[0]

    @cached_property
    def _bsdfs(self) -> tuple[tuple[Any, Any], list[Any]]:
        """Those lookups, and the BSDFs, which live as long as this does."""
        mi = backend.mitsuba()
        import drjit as dr

        made: dict[tuple[Material, Band], Any] = {}
        lookups = []
        for band in (Band.PROJECTOR, self.band):
            numbers = np.zeros(LOOKUP_SIZE, np.uint32)
            for body, material in enumerate(self.materials):
                if _kind(material) == OTHER:
                    seen = in_band(material, band)
                    key = (seen, band if isinstance(seen, Measured) else Band.PROJECTOR)
                    if key not in made:
                        made[key] = mi.load_dict(bsdf_description(*key))
                    numbers[body] = registry_number(mi.BSDFPtr(made[key]))
            lookups.append(dr.reinterpret_array(mi.BSDFPtr, mi.UInt32(numbers)))
        return (lookups[0], lookups[1]), list(made.values())


def _kind(material: Material) -> int:
    match material:
        case Matte():
            return LAMBERTIAN
        case RoughConductor():
            return CONDUCTOR
    return OTHER


def _conductor(metal: RoughConductor, under_lamps: RoughConductor, lost: list[np.ndarray]) -> Float32[np.ndarray, "f"]:
    """The fields of one metal; its table of lost light joins `lost`."""
    table = albedo_table(metal.alpha_u, metal.alpha_v)
    scales, place, further = [0.0, 0.0], -1, 0.0
    if 1.0 - table.mean >= NEGLIGIBLE_LOSS:
        scales = [
            multiple_scattering_reflectance(table.mean, m.n, m.k) / (np.pi * (1.0 - table.mean))
            for m in (metal, under_lamps)
        ]
        # Samples are split about as the energy is, so that their weights stay near one.
        place, further = len(lost), min(1.0 - table.mean, 0.5)
        lost.append(np.broadcast_to(1.0 - table.albedo, (LOSS_ROWS, LOSS_COLUMNS)).astype(np.float32))
    oxide = metal.oxide_share
    return np.array(
        [
            *(metal.alpha_u, metal.alpha_v, metal.n, metal.k),
            *(under_lamps.n, under_lamps.k, place, 0.0),
            *(oxide, metal.oxide_reflectance, under_lamps.oxide_reflectance, oxide + (1.0 - oxide) * further),
            *(*scales, 0.0, 0.0),
        ],
        np.float32,
    )
