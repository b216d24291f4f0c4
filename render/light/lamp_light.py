"""What lamps bring to a vertex of a path: through a point on one of them, or met by the path's own ray."""

from typing import Any

from render.light.polarisation import Polarisation, StokesRows
from render.world import backend
from render.world.mitsuba_scene import LoadedScene
from render.world.scene_geometry import FIRST_LAMP


def light_met(
    world: LoadedScene,
    si: Any,
    ray: Any,
    body: Any,
    pdf: Any,
    i: Any,
    lamps_known: Any,
    films: tuple[Polarisation, StokesRows] | None = None,
) -> Any:
    """Radiance that a ray brings from a lamp it meets or from outside the scene.

    pdf: density of the ray's direction over solid angle; lamps met behind a glossy vertex are weighted by the power
    heuristic. lamps_known: they count nothing, behind a Lambertian vertex since they were connected there with full
    weight. films: polarisers and the rays' rows, where there are any.
    """
    import drjit as dr

    radiance = dr.select(si.is_valid(), 0, world.ambient)
    for k, lamp in enumerate(world.lamps):
        cosine = -dr.dot(ray.d, lamp.normal)
        density = dr.square(si.t) / dr.maximum(cosine * lamp.area, 1e-9)
        weight = dr.select(i == 0, 1, dr.select(lamps_known, 0, dr.square(pdf) / (dr.square(pdf) + dr.square(density))))
        if films is not None:
            polarisation, rows = films
            weight *= dr.maximum(1 + polarisation.of_lamp(k, rows.bands[1], rows.x, ray.d), 0)
        radiance += dr.select((body == FIRST_LAMP + k) & (cosine > 0), weight * lamp.radiance, 0)
    return radiance


def chosen_lamp(
    world: LoadedScene, links: list[Any], values: list[tuple[Any, Any]], glossy: Any, u: Any
) -> tuple[Any, Any]:
    """A point on one of the lamps and what all of them bring if nothing hides it.

    One is drawn in proportion to what it brings unhidden (resampled importance sampling: Talbot et al. 2005), so that
    one shadow ray serves all lamps and only their visibility is left to chance.
    """
    mi = backend.mitsuba()
    import drjit as dr

    place, total, bounds = mi.Point3f(0), mi.Float(0), []
    for lamp, (_, _, density), (f_cos, f_pdf) in zip(world.lamps, links, values, strict=True):
        weight_over_density = density / (dr.square(density) + dr.select(glossy, dr.square(f_pdf), 0))
        bounds.append(total)
        total = total + dr.select((f_cos > 0) & (density > 0), f_cos * lamp.radiance * weight_over_density, 0)
    for bound, (candidate, _, _) in zip(bounds, links, strict=True):
        place = dr.select(u * total >= bound, candidate, place)
    return place, total
