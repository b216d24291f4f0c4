"""Diffuse base under a clear coat: the albedo of the base against the reflectance that an instrument sees from outside.

Light crosses the coat's surface, is scattered by the base, and partly thrown back by the inside of the surface, again
and again. Source: J. L. Saunderson, J. Opt. Soc. Am. 32, 727 (1942), for light and instrument near the normal, mirror
reflection left out. It is what Mitsuba's `roughplastic` does with `nonlinear` on.
"""

from materials.fresnel import hemispherical_reflectance, normal_reflectance


def seen_reflectance(n: float, base_albedo: float) -> float:
    """Reflectance factor near the normal of a base of that albedo under a coat of index n, but for its mirror image."""
    inside = internal_reflectance(n)
    return _through(n) * base_albedo / (1.0 - inside * base_albedo)


def base_albedo(n: float, seen: float) -> float:
    """Albedo of the base that gives the reflectance factor `seen`; above 1 when no base is that bright."""
    return seen / (_through(n) + internal_reflectance(n) * seen)


def internal_reflectance(n: float) -> float:
    """Reflectance of the coat's surface for diffuse light from within.

    The radiance invariant L / n^2 ties it to the one from outside: (1 - inside) n^2 = 1 - outside.
    """
    return 1.0 - (1.0 - hemispherical_reflectance(n)) / n**2


def _through(n: float) -> float:
    """Radiance kept on the way in and out along the normal, with the spreading by refraction."""
    return (1.0 - normal_reflectance(n)) ** 2 / n**2
