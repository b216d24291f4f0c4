"""Stokes vectors on the device: Fresnel's Mueller matrix of a facet, turns of the frame, axes of films seen aslant.

Conventions as in `render.light.polarisation`; source: Born and Wolf, sections 1.5, 10.8 and 14.2.
"""

from typing import Any

from render.world import backend


def fresnel_mueller(cos: Any, n: Any, k: Any) -> tuple[Any, Any, Any, Any]:
    """The Mueller matrix of a facet of n + ik by the cosine of incidence, on the device: R and, relative to R = (R_s +
    R_p) / 2, (R_s - R_p) / 2, and the real and imaginary part of r_s times conjugate r_p.

    It is R ((1, b, 0, 0), (b, 1, 0, 0), (0, 0, c, -d), (0, 0, d, c)) for Stokes vectors with V = 2 Im(E_s E_p*).
    """
    import drjit as dr

    cos2 = cos * cos
    sin2 = 1 - cos2
    real = n * n - k * k - sin2
    a2_plus_b2 = dr.sqrt(real * real + 4 * n * n * k * k)
    a = dr.sqrt(dr.maximum(0.5 * (a2_plus_b2 + real), 0))
    imaginary = dr.sqrt(dr.maximum(0.5 * (a2_plus_b2 - real), 0))
    r_s = (a2_plus_b2 + cos2 - 2 * a * cos) / (a2_plus_b2 + cos2 + 2 * a * cos)
    # r_p / r_s = -(z - sin^2) / (z + sin^2), with z = (a + ib) cos.
    first, second = cos2 * a2_plus_b2 + sin2 * sin2, 2 * a * cos * sin2
    r_p = r_s * (first - second) / (first + second)
    mean = 0.5 * (r_s + r_p)
    scale = r_s / ((first + second) * dr.maximum(mean, 1e-12))
    c, d = -(cos2 * a2_plus_b2 - sin2 * sin2) * scale, 2 * imaginary * cos * sin2 * scale
    return mean, 0.5 * (r_s - r_p) / dr.maximum(mean, 1e-12), c, d


def turned_stokes(row: Any, x: Any, new_x: Any, way: Any) -> Any:
    """Q, U and V that refer to `x` as they refer to `new_x`, both across the light's way (unit vectors, world)."""
    mi = backend.mitsuba()
    import drjit as dr

    cosine, sine = dr.dot(x, new_x), dr.dot(new_x, dr.cross(way, x))
    cos_twice, sin_twice = cosine * cosine - sine * sine, 2 * cosine * sine
    return mi.Vector3f(row.x * cos_twice + row.y * sin_twice, row.y * cos_twice - row.x * sin_twice, row.z)


def passed_axis(line: Any, d: Any) -> Any:
    """Along which the light swings that a film lets pass along or against `d`: across the ray and the blocked line."""
    import drjit as dr

    return dr.normalize(dr.cross(d, line))


def any_across(d: Any) -> Any:
    """Any unit vector across a unit vector."""
    mi = backend.mitsuba()
    return mi.coordinate_system(d)[0]
