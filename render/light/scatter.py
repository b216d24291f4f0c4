"""How surfaces pass light on at a vertex of a path; they look alike from both sides, since user meshes may be open or
turned."""

from typing import Any

from render.world import backend


def scatter(
    si: Any, bsdf: Any, albedo: Any, directions: list[Any], connected: Any, u: Any, v: Any, scattering: Any
) -> tuple[list[tuple[Any, Any]], Any, Any, Any]:
    """All that a vertex asks of its surface: one dynamic call for the glossy ones, a formula for the Lambertian ones.

    si: interactions. bsdf: theirs (`BSDFPtr`), null on Lambertian surfaces. albedo: of these, 0 on others. directions:
    local ones of light. connected: whether the surface is asked for these. u, v: uniform in [0, 1) and its square.
    scattering: whether the surface is asked for a sample. Returns (value times cosine, density) for each direction, and
    a sampled local direction with its density and its weight.
    """
    mi = backend.mitsuba()
    import drjit as dr

    def turned(w):
        return mi.Vector3f(w.x, w.y, dr.mulsign(w.z, side))

    def ask(bsdf, si, directions, u, v, connected, scattering):
        pairs = [bsdf.eval_pdf(context, si, wo, connected) for wo in directions]
        sampled, weight = bsdf.sample(context, si, u, v, scattering)
        return [(value.x, pdf) for value, pdf in pairs], sampled.wo, sampled.pdf, weight.x

    context, side, matte = mi.BSDFContext(), mi.Float(si.wi.z), albedo > 0
    upper = mi.SurfaceInteraction3f(si)
    upper.wi = turned(si.wi)
    directions = [turned(direction) for direction in directions]
    glossy = dr.dispatch(bsdf, ask, upper, directions, u, v, connected & ~matte, scattering & ~matte)
    lobes = [dr.inv_pi * dr.maximum(direction.z, 0) for direction in directions]
    upwards = mi.warp.square_to_cosine_hemisphere(v)
    values = [
        (dr.select(matte, albedo * lobe, value), dr.select(matte, lobe, pdf))
        for lobe, (value, pdf) in zip(lobes, glossy[0], strict=True)
    ]
    onwards = turned(dr.select(matte, upwards, glossy[1]))
    return values, onwards, dr.select(matte, dr.inv_pi * upwards.z, glossy[2]), dr.select(matte, albedo, glossy[3])
