"""How surfaces pass light on at a vertex of a path; they look alike from both sides, since user meshes may be open or
turned."""

from dataclasses import dataclass
from typing import Any

from render.light.microfacets import MetalLobes
from render.world import backend
from render.world.reflectances import CONDUCTOR, OTHER, Reflectances

PROJECTOR, LAMPS = 0, 1
"""Bands, as pairs count them."""


@dataclass(frozen=True, eq=False)
class Scattered:
    """What vertices do with light, one value a path (Dr.Jit); pairs hold 850 nm and the lamps' band."""

    to_projector: Any
    """Value times cosine towards the projector at 850 nm [1/sr]."""
    to_lamps: list[tuple[Any, Any]]
    """Value times cosine towards a point on each lamp, in the lamps' band, and the density of a sample there [1/sr]."""
    onwards: Any
    """A sampled local direction."""
    pdf: Any
    """Its density over solid angle [1/sr]; 0 = none."""
    weight: tuple[Any, Any]
    """Value times cosine over density."""


def scatter(
    si: Any,
    reflectances: Reflectances,
    body: Any,
    towards: Any,
    lamps: list[Any],
    u: Any,
    v: Any,
    connected: Any,
    scattering: Any,
) -> Scattered:
    """All that a vertex asks of its surface.

    si: interactions. body: theirs. towards, lamps: local directions to the projector and to points on the lamps. u, v:
    uniform in [0, 1) and its square. connected: whether the surface is asked for these directions. scattering: whether
    it is asked for a sample.
    """
    mi = backend.mitsuba()
    import drjit as dr

    asked = connected | scattering
    side = mi.Float(si.wi.z)

    def turned(w):
        return mi.Vector3f(w.x, w.y, dr.mulsign(w.z, side))

    kind = dr.gather(mi.UInt32, reflectances.kind, body, asked)
    upper = mi.SurfaceInteraction3f(si)
    upper.wi = turned(si.wi)
    towards, lamps = turned(towards), [turned(w) for w in lamps]
    found = _of_lambertian(reflectances, body, towards, lamps, v, asked)
    if reflectances.has_conductors:
        metal = asked & (kind == CONDUCTOR)
        found = _chosen(metal, _of_metals(reflectances, body, upper.wi, towards, lamps, u, v, metal), found)
    if reflectances.has_others:
        other = kind == OTHER
        asked_others = _of_others(
            reflectances, body, upper, towards, lamps, u, v, connected & other, scattering & other
        )
        found = _chosen(other, asked_others, found)
    lost = ~scattering | (kind == 0)
    return Scattered(
        dr.select(connected, found.to_projector, 0),
        [(dr.select(connected, value, 0), dr.select(connected, pdf, 0)) for value, pdf in found.to_lamps],
        turned(found.onwards),
        dr.select(lost, 0, found.pdf),
        (dr.select(lost, 0, found.weight[PROJECTOR]), dr.select(lost, 0, found.weight[LAMPS])),
    )


def _chosen(condition: Any, first: Scattered, second: Scattered) -> Scattered:
    """Lane by lane."""
    import drjit as dr

    def choose(a, b):
        return dr.select(condition, a, b)

    return Scattered(
        choose(first.to_projector, second.to_projector),
        [(choose(a, c), choose(b, d)) for (a, b), (c, d) in zip(first.to_lamps, second.to_lamps, strict=True)],
        choose(first.onwards, second.onwards),
        choose(first.pdf, second.pdf),
        (choose(first.weight[0], second.weight[0]), choose(first.weight[1], second.weight[1])),
    )


def _of_lambertian(r: Reflectances, body: Any, towards: Any, lamps: list[Any], v: Any, asked: Any) -> Scattered:
    mi = backend.mitsuba()
    import drjit as dr

    albedo = tuple(dr.gather(mi.Float, lookup, body, asked) for lookup in r.albedo)
    upwards = mi.warp.square_to_cosine_hemisphere(v)

    def lobe(w):
        return dr.inv_pi * dr.maximum(w.z, 0)

    to_lamps = [(albedo[LAMPS] * lobe(w), lobe(w)) for w in lamps]
    return Scattered(albedo[PROJECTOR] * lobe(towards), to_lamps, upwards, lobe(upwards), (albedo[0], albedo[1]))


def _of_metals(
    r: Reflectances, body: Any, wi: Any, towards: Any, lamps: list[Any], u: Any, v: Any, asked: Any
) -> Scattered:
    """In a branch of its own: where no lane of a packet meets metal, nothing is computed."""
    mi = backend.mitsuba()
    import drjit as dr

    def on_metal(body, wi, towards, lamps, u, v):
        lobes = MetalLobes.at(r, body, wi, mi.Bool(True))
        (to_projector,), _ = lobes.towards(towards, mi.Bool(True), (PROJECTOR,))
        to_lamps = []
        for w in lamps:
            (value,), pdf = lobes.towards(w, mi.Bool(True), (LAMPS,))
            to_lamps.append((value, pdf))
        onwards = lobes.sampled(u, v)
        values, pdf = lobes.towards(onwards, mi.Bool(True), (PROJECTOR, LAMPS))
        inverse = dr.select(pdf > 0, dr.rcp(dr.maximum(pdf, 1e-20)), 0)
        return to_projector, to_lamps, onwards, pdf, (values[0] * inverse, values[1] * inverse)

    def elsewhere(body, wi, towards, lamps, u, v):
        n = mi.Float(0)
        return (
            n,
            [(mi.Float(0), mi.Float(0)) for _ in lamps],
            mi.Vector3f(0, 0, 1),
            mi.Float(0),
            (mi.Float(0), mi.Float(0)),
        )

    return Scattered(*dr.if_stmt((body, wi, towards, lamps, u, v), asked, on_metal, elsewhere))


def _of_others(
    r: Reflectances, body: Any, si: Any, towards: Any, lamps: list[Any], u: Any, v: Any, connected: Any, scattering: Any
) -> Scattered:
    """By dynamic calls of Mitsuba's BSDFs: one for 850 nm, one for the lamps' band."""
    mi = backend.mitsuba()
    import drjit as dr

    asked = connected | scattering
    context = mi.BSDFContext()
    first, second = (dr.gather(mi.BSDFPtr, lookup, body, asked) for lookup in r.bsdfs)

    def ask(bsdf, si, towards, lamps, u, v, connected, scattering):
        value = bsdf.eval(context, si, towards, connected).x
        densities = [bsdf.pdf(context, si, w, connected) for w in lamps]
        drawn, weight = bsdf.sample(context, si, u, v, scattering)
        return value, densities, drawn.wo, drawn.pdf, weight.x

    def ask_again(bsdf, si, lamps, onwards, connected, scattering):
        values = [bsdf.eval(context, si, w, connected).x for w in lamps]
        return values, bsdf.eval(context, si, onwards, scattering).x

    value, densities, onwards, pdf, weight = dr.dispatch(first, ask, si, towards, lamps, u, v, connected, scattering)
    values, sampled = dr.dispatch(second, ask_again, si, lamps, onwards, connected, scattering)
    under_lamps = dr.select(pdf > 0, sampled / dr.maximum(pdf, 1e-20), 0)
    return Scattered(value, list(zip(values, densities, strict=True)), onwards, pdf, (weight, under_lamps))
