"""Polarised light on paths from the imager: Stokes vectors at the film, Fresnel's r_s and r_p at every facet.

A path is followed against the light. What it carries is therefore the row of weights that turns the Stokes vector of
light that arrives at its vertex into what the imager counts: (1, degree, 0, 0) along a film's axis at the start, (1, 0,
0, 0) without a film, times one Mueller matrix more at every surface. Whole chains of reflections are so polarised, and
where a source is met the row meets its Stokes vector. Sign conventions: frame (x, y, way of the light) right-handed,
Q = I_x - I_y, and s across the plane of incidence is the x of both rays (`materials.fresnel.fresnel_amplitudes`).

- Facets of metals and of clear coats reflect as Fresnel says, at the half vector.
- All other light is depolarised: matte paint, the base below a coat, oxide, and a metal's further bounces between its
  facets. Left out is what diffuse light leaving a coat has of its own (4 % at 45 deg for n = 1.5), and what double
  bounces between facets keep.
- A Lambertian surface forgets, so light seen by way of it is counted in one number (`render.light.smooth`,
  `render.world.radiosity`). What sharp metal throws onto such surfaces (`render.light.caustics`) goes as if it were
  unpolarised.
- Measured files say nothing of polarisation and are refused.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float, Float32
from scipy.spatial.transform import RigidTransform

from materials.bands import in_band
from materials.input_error import InputError
from materials.lights import Band
from materials.material import Material, Measured, RoughConductor, RoughPlastic
from render.imager.polarisers import Polarisers
from render.light.microfacets import facet_lobe
from render.light.projector import ProjectorLight
from render.light.scatter import Scattered
from render.light.stokes import any_across, fresnel_mueller, passed_axis, turned_stokes
from render.world import backend
from render.world.mitsuba_scene import LoadedScene
from render.world.reflectances import LOOKUP_SIZE

FACET_FIELDS = 8
"""Numbers of a body's facets: alpha_u, alpha_v, n, k; n, k under the lamps, share of the surface that has facets, 0."""


@dataclass
class StokesRows:
    """What of the light that arrives the imager counts, relative to unpolarised light; one a path (Dr.Jit)."""

    x: Any
    """Unit vector across the ray to which Q refers (Vector3f, world)."""
    bands: tuple[Any, Any]
    """Weights of Q, U and V at 850 nm and under the lamps (Vector3f); that of I is one."""


@dataclass(frozen=True, eq=False)
class Polarisation:
    """Films at a pose before a scene, on the device; all but the shares opaque, so that other angles run one kernel."""

    imagers_line: Any
    """Line across the axis of the imagers' films, whose light they block (Vector3f, world)."""
    imagers_degree: tuple[Any, Any]
    """Of the imagers' films at 850 nm and under the lamps [-]."""
    projector_line: Any
    """The same of the projector's film, or across the laser's own axis."""
    projector_stokes: tuple[Any, Any]
    """Q and U over I of the dots' light."""
    lamps: tuple[tuple[Any, Any], ...]
    """Blocked line and degree of the film before each lamp; empty without films."""
    facets: Any
    """Float: FACET_FIELDS numbers a body, 0 for those that only depolarise."""
    passed: tuple[float, float]
    """Of the projector's and of the lamps' light, what films leave if nothing else polarises it [0, 1]."""

    @classmethod
    def of(
        cls, polarisers: Polarisers, world: LoadedScene, light: ProjectorLight, T_world_imager: RigidTransform
    ) -> "Polarisation":
        """Of films that look along the axes of an imager and of a projector; InputError for a measured material."""
        mi = backend.mitsuba()
        import drjit as dr

        bands, film = (Band.PROJECTOR, world.source.lamp_band), polarisers.make
        power, q, u = polarisers.projector_stokes()
        degrees, kept = [0.0, 0.0], [power, 1.0]
        if polarisers.imagers_deg is not None:
            degrees = [film.degree(band) for band in bands]
            kept = [left * film.passed(band) for left, band in zip(kept, bands, strict=True)]
        lamps = ()
        if polarisers.lamps_deg is not None:
            lamps = _lamp_films(polarisers.lamps_deg, film.degree(bands[1]), world)
            kept[1] *= film.passed(bands[1])
        line = T_world_imager.rotation.apply(blocked_line(polarisers.imagers_deg or 0.0))
        of_projector = blocked_line(polarisers.projector_axis_deg).tolist()
        films = cls(
            mi.Vector3f(*line.tolist()),
            (mi.Float(degrees[0]), mi.Float(degrees[1])),
            light.world_to_projector.T @ mi.Vector3f(*of_projector),
            (mi.Float(q / max(power, 1e-12)), mi.Float(u / max(power, 1e-12))),
            lamps,
            mi.Float(facet_numbers(world.reflectances.materials, bands[1]).ravel()),
            (kept[0], kept[1]),
        )
        dr.make_opaque(films.imagers_line, films.imagers_degree, films.projector_line, films.projector_stokes)
        return films

    def through_film(self, d: Any) -> StokesRows:
        """Rows of rays that leave the imager along `d`."""
        mi = backend.mitsuba()
        first, second = (mi.Vector3f(degree, 0, 0) for degree in self.imagers_degree)
        return StokesRows(passed_axis(self.imagers_line, d), (first, second))

    def forgotten(self, d: Any) -> StokesRows:
        """Rows of rays that leave a Lambertian surface along `d`."""
        mi = backend.mitsuba()
        return StokesRows(any_across(d), (mi.Vector3f(0) * d.x, mi.Vector3f(0) * d.x))

    def polarised(
        self, rows: StokesRows, si: Any, body: Any, towards: Any, lamps: Sequence[Any], lobes: Scattered
    ) -> tuple[Scattered, StokesRows]:
        """What a vertex does with light, polarised, and the rows of the rays that go on.

        si: interactions. towards, lamps: directions to the projector and to points on the lamps (world). lobes: what
        the surface does with unpolarised light.
        """
        import drjit as dr

        here = _Facets.at(self.facets, si, body)
        share, row, x = here.reflected(rows, 0, towards, lobes.to_projector)
        share += _met(row, x, towards, self.projector_line, *self.projector_stokes)
        to_lamps = []
        for k, ((value, pdf), direction) in enumerate(zip(lobes.to_lamps, lamps, strict=True)):
            of_lamp, row, x = here.reflected(rows, 1, direction, value)
            to_lamps.append((_scaled(value, of_lamp + self.of_lamp(k, row, x, direction)), pdf))
        weight, behind, onwards = [], [], si.to_world(lobes.onwards)
        for band in (0, 1):
            left, row, x = here.reflected(rows, band, onwards, lobes.weight[band] * lobes.pdf)
            weight.append(_scaled(lobes.weight[band], left))
            behind.append(row / dr.maximum(left, 1e-6))
        to_projector = _scaled(lobes.to_projector, share)
        lobes = replace(lobes, to_projector=to_projector, to_lamps=to_lamps, weight=(weight[0], weight[1]))
        return lobes, StokesRows(x, (behind[0], behind[1]))

    def of_lamp(self, k: int, row: Any, x: Any, direction: Any) -> Any:
        """What lamp k's light, from `direction`, counts more or less than unpolarised light; 0 without a film on it."""
        if not self.lamps:
            return 0
        line, degree = self.lamps[k]
        return _met(row, x, direction, line, degree, 0)


@dataclass(frozen=True, eq=False)
class _Facets:
    """Of the surfaces at interactions."""

    si: Any
    view: Any
    """Direction in which the light goes on (world)."""
    alpha: tuple[Any, Any]
    indices: tuple[tuple[Any, Any], tuple[Any, Any]]
    """n and k in either band."""
    share: Any

    @classmethod
    def at(cls, facets: Any, si: Any, body: Any) -> "_Facets":
        """Look the bodies up."""
        mi = backend.mitsuba()
        import drjit as dr

        a, b = (dr.gather(mi.Vector4f, facets, body * (FACET_FIELDS // 4) + i) for i in range(2))
        alpha = dr.maximum(a.x, 1e-4), dr.maximum(a.y, 1e-4)
        return cls(si, si.to_world(si.wi), alpha, ((a.z, a.w), (b.x, b.y)), b.z)

    def reflected(self, rows: StokesRows, band: int, w: Any, value: Any) -> tuple[Any, Any, Any]:
        """What light from direction `w` (world) counts by its I, Q, U and V, relative to what the surface does with
        unpolarised light, and the x that they refer to.

        value: BRDF times cosine that the surface has for unpolarised light [1/sr].
        """
        mi = backend.mitsuba()
        import drjit as dr

        half = dr.normalize(self.view + w)
        across = dr.cross(self.view, half)
        length2 = dr.squared_norm(across)
        s = dr.select(length2 > 1e-12, across * dr.rsqrt(dr.maximum(length2, 1e-12)), any_across(self.view))
        row = turned_stokes(rows.bands[band], rows.x, s, self.view)
        mean, b, c, d = fresnel_mueller(dr.clip(dr.dot(self.view, half), 0, 1), *self.indices[band])
        side, wi, wo = self.si.wi.z, self.si.wi, self.si.to_local(w)
        lobe = facet_lobe(
            mi.Vector3f(wi.x, wi.y, dr.abs(side)), mi.Vector3f(wo.x, wo.y, dr.mulsign(wo.z, side)), self.alpha
        )
        mirrored = dr.select((value > 0) & (self.share > 0), self.share * lobe * mean / value, 0)
        g = dr.clip(mirrored, 0, 1)
        behind = mi.Vector3f(b + row.x, c * row.y + d * row.z, c * row.z - d * row.y)
        # Bodies without facets have no index, whose Fresnel terms mean nothing.
        return dr.select(g > 0, 1 + g * b * row.x, 1), dr.select(g > 0, g * behind, 0), s


def _met(row: Any, x: Any, direction: Any, line: Any, q: Any, u: Any) -> Any:
    """What the polarised part of a source's light counts. direction: to the source; line, q, u: of its film."""
    mi = backend.mitsuba()
    import drjit as dr

    stokes = mi.Vector3f(q, u, 0) + dr.zeros(mi.Vector3f, dr.width(direction))
    return dr.dot(row, turned_stokes(stokes, passed_axis(line, direction), x, -direction))


def _scaled(value: Any, by: Any) -> Any:
    """The product; 0 where there was nothing, whatever `by` is there."""
    import drjit as dr

    return dr.select(value > 0, value * dr.maximum(by, 0), 0)


def blocked_line(axis_deg: float) -> Float[np.ndarray, "3"]:
    """Unit vector across a film's axis, in the frame that looks through it."""
    angle = np.radians(axis_deg)
    return np.array([-np.sin(angle), np.cos(angle), 0.0])


def _lamp_films(axis_deg: float, degree: float, world: LoadedScene) -> tuple[tuple[Any, Any], ...]:
    """Blocked line and degree of each lamp's film, opaque."""
    mi = backend.mitsuba()
    import drjit as dr

    rotations = [lamp.T_world_lamp.rotation for lamp in world.source.lamps]
    films = tuple((mi.Vector3f(*r.apply(blocked_line(axis_deg)).tolist()), mi.Float(degree)) for r in rotations)
    dr.make_opaque(films)
    return films


def facet_numbers(materials: Sequence[Material], band: Band) -> Float32[np.ndarray, "bodies fields"]:
    """FACET_FIELDS of each body. band: of the lamps. InputError for a measured material."""
    numbers = np.zeros((LOOKUP_SIZE, FACET_FIELDS), np.float32)
    for body, material in enumerate(materials):
        match material, in_band(material, band):
            case RoughConductor() as metal, RoughConductor() as lit:
                facets = (metal.alpha_u, metal.alpha_v, metal.n, metal.k, lit.n, lit.k, 1 - metal.oxide_share)
            case RoughPlastic(n=n, alpha=alpha), _:
                facets = (alpha, alpha, n, 0.0, n, 0.0, 1.0)
            case Measured(name=name), _:
                raise InputError(
                    f"{name}: a measured file does not say how it polarises light; "
                    "leave imager.polarisers out, or give the body a material of the catalogue"
                )
            case _:
                continue
        numbers[body, : len(facets)] = facets
    return numbers
