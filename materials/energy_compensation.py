"""Light that a one-bounce microfacet metal loses between its facets, and the lobe that gives it back.

Renderers follow light to one facet only; what that facet sends to another is lost. E(mu) of the light is kept, a third
of it gone at roughness 0.5. Here E is integrated for GGX with separable Smith shadowing, the model of Mitsuba's
`roughconductor`, over the facets that are visible (E. Heitz, Sampling the GGX distribution of visible normals, JCGT 7,
2018): weight 1 at the facet, then the shadowing G1 on the way out. No Fresnel factor: E is that of a perfect mirror.

The lost light leaves in all directions. C. Kulla and A. Conty (Revisiting physically based shading at Imageworks,
SIGGRAPH course 2017) give it the reciprocal `lobe` below. Held against a random walk on the same microsurface (E.
Heitz et al., SIGGRAPH 2016), the reflectance back towards the light is then right to 5 % up to 30 deg of tilt, where
one bounce alone is 6 to 45 % too dark; scaling the highlight instead (E. Turquin, 2019) leaves it 5 to 12 % too dark
and makes the highlight up to 14 % too bright. Tilted further the lobe gives too much back, 16 % at 45 deg and up to
50 % at 60 deg where alpha is small, against 19 to 48 % and 33 to 46 % too little by one bounce alone.
"""

import functools
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy.polynomial.legendre import leggauss

from materials.fresnel import hemispherical_reflectance

_N_RADIUS, _N_AZIMUTH = 48, 96
"""Nodes on the disc of visible facets; E is then exact to 0.002, far inside what a microfacet model is worth."""
_N_COS, _N_SECTOR = 32, 9
"""Table size. Between its nodes, linear interpolation is exact to 0.002."""
_nodes, _weights = leggauss(24)
_MEAN_COS, _MEAN_WEIGHTS = 0.5 * (_nodes + 1.0), 0.5 * (_nodes + 1.0) * _weights
"""Nodes of the cosine-weighted mean, 2 * integral of E(mu) mu dmu."""


@dataclass(frozen=True, eq=False)
class AlbedoTable:
    """E of one roughness over directions: nodes at mu = (i / (n - 1))^2, denser at grazing, and even azimuths.

    Model: GGX facets with separable Smith shadowing, one bounce, no Fresnel factor (Heitz 2018); further bounces are
    what it tells the lack of. Exact to 0.002 at the nodes, and as near between them. Without a lay there is one column.
    """

    albedo: Float[np.ndarray, "n_cos n_sector"]
    """E(mu, azimuth) of a perfect mirror's facets [0, 1]; azimuth runs from u (first column) to v (last column)."""
    mean: float
    """Cosine-weighted mean of E over the hemisphere."""

    def at(self, cos_theta: Float[np.ndarray, "*s"], azimuth: Float[np.ndarray, "*s"] | float = 0.0) -> np.ndarray:
        """E by bilinear interpolation; azimuth from the lay u [rad], any quadrant (the four are alike)."""
        n_cos, n_sector = self.albedo.shape
        folded = np.arctan2(np.abs(np.sin(azimuth)), np.abs(np.cos(azimuth)))
        row = np.sqrt(np.clip(cos_theta, 0.0, 1.0)) * (n_cos - 1)
        column = np.broadcast_to(folded / (np.pi / 2) * (n_sector - 1), np.shape(row))
        i = np.minimum(row.astype(int), n_cos - 2)
        j = np.minimum(column.astype(int), max(n_sector - 2, 0))
        right = np.minimum(j + 1, n_sector - 1)
        a, b = row - i, column - j
        low = (1 - b) * self.albedo[i, j] + b * self.albedo[i, right]
        high = (1 - b) * self.albedo[i + 1, j] + b * self.albedo[i + 1, right]
        return (1 - a) * low + a * high


def directional_albedo(
    cos_theta: Float[np.ndarray, "n"], alpha_u: float, alpha_v: float, azimuth: float = 0.0
) -> Float[np.ndarray, "n"]:
    """E(mu): share of the light from one direction that facets without absorption send out after one bounce.

    cos_theta: cosine to the surface normal, above 0; azimuth: angle from the lay u [rad].
    """
    alpha = np.array([alpha_u, alpha_v, 1.0])
    sin_theta = np.sqrt(np.clip(1.0 - cos_theta**2, 0.0, 1.0))
    view = np.stack([sin_theta * np.cos(azimuth), sin_theta * np.sin(azimuth), cos_theta], axis=-1)
    view = view[:, None]  # (n, 1, 3)
    normals = _visible_normals(view, alpha)  # (n, m, 3)
    outgoing = 2.0 * np.sum(view * normals, axis=-1, keepdims=True) * normals - view
    return _shadowing(outgoing, alpha) @ _disc_nodes()[2]


def albedo_table(alpha_u: float, alpha_v: float) -> AlbedoTable:
    """The table of E for one roughness; made once per process (about 0.05 s without a lay, 0.4 s with one)."""
    return _cached_table(round(alpha_u, 6), round(alpha_v, 6))


@functools.lru_cache(maxsize=128)
def _cached_table(alpha_u: float, alpha_v: float) -> AlbedoTable:
    sectors = np.linspace(0.0, np.pi / 2, 1 if alpha_u == alpha_v else _N_SECTOR)
    cos_nodes = np.maximum(np.linspace(0.0, 1.0, _N_COS) ** 2, 1e-4)
    albedo = np.stack([directional_albedo(cos_nodes, alpha_u, alpha_v, phi) for phi in sectors], axis=-1)
    unweighted = AlbedoTable(albedo, 0.0)
    means = np.array([np.sum(_MEAN_WEIGHTS * unweighted.at(_MEAN_COS, phi)) for phi in sectors])
    trapezoids = 0.5 * (means[:-1] + means[1:]) if len(means) > 1 else means
    return AlbedoTable(albedo, float(np.mean(trapezoids)))


def multiple_scattering_reflectance(mean_albedo: float, n: float, k: float) -> float:
    """Share of the lost light that a metal n + ik gives back: F^2 E / (1 - F (1 - E)), F and E hemispherical means.

    Source: Kulla and Conty 2017, slide `Fresnel`: one reflection before, one after, and a geometric series between.
    """
    fresnel = hemispherical_reflectance(n, k)
    return fresnel**2 * mean_albedo / (1.0 - fresnel * (1.0 - mean_albedo))


def lobe(
    albedo_in: Float[np.ndarray, "*s"], albedo_out: Float[np.ndarray, "*s"], mean_albedo: float, reflectance: float
) -> Float[np.ndarray, "*s"]:
    """BRDF [1/sr] to add to the one-bounce metal: r (1 - E_in) (1 - E_out) / (pi (1 - E_mean)) (Kulla and Conty 2017).

    reflectance: `multiple_scattering_reflectance`. With 1 the whole surface reflects exactly what arrives.
    """
    lost = max(1.0 - mean_albedo, 1e-9)  # a mirror loses nothing, and both factors above are 0 as well
    return reflectance * (1.0 - albedo_in) * (1.0 - albedo_out) / (np.pi * lost)


def highlight_factor(albedo: Float[np.ndarray, "*s"], normal_reflectance: float) -> Float[np.ndarray, "*s"]:
    """Turquin's alternative: scale the one-bounce lobe by 1 + F0 (1 - E) / E, E towards the viewer.

    Source: E. Turquin, Practical multiple scattering compensation for microfacet models, 2019, eq. 16. Simpler, a
    factor on `specular_reflectance`; right in total, not reciprocal, and wrong in direction as told above.
    """
    return 1.0 + normal_reflectance * (1.0 - albedo) / albedo


@functools.cache
def _disc_nodes() -> tuple[Float[np.ndarray, "m"], Float[np.ndarray, "m"], Float[np.ndarray, "m"]]:
    """Coordinates and weights of nodes on the unit disc; radius = sin(psi) is smooth at the rim of the hemisphere."""
    nodes, weights = leggauss(_N_RADIUS)
    psi = (nodes + 1.0) * np.pi / 4
    phi = (np.arange(_N_AZIMUTH) + 0.5) * 2 * np.pi / _N_AZIMUTH
    radius = np.sin(psi)[:, None]
    ring = weights * np.pi / 4 * 2 * np.sin(psi) * np.cos(psi) / _N_AZIMUTH
    return (radius * np.cos(phi)).ravel(), (radius * np.sin(phi)).ravel(), np.repeat(ring, _N_AZIMUTH)


def _visible_normals(view: Float[np.ndarray, "n 1 3"], alpha: Float[np.ndarray, "3"]) -> Float[np.ndarray, "n m 3"]:
    """Facet normals as seen from `view`, one per disc node (Heitz 2018, listing 1)."""
    first, second, _ = _disc_nodes()
    stretched = view * alpha
    stretched = stretched / np.linalg.norm(stretched, axis=-1, keepdims=True)
    across = np.stack([-stretched[..., 1], stretched[..., 0], np.zeros(stretched.shape[:-1])], axis=-1)
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    across = np.where(length > 1e-12, across / np.maximum(length, 1e-12), [1.0, 0.0, 0.0])
    along = np.cross(stretched, across)
    share = 0.5 * (1.0 + stretched[..., 2])
    second = (1.0 - share) * np.sqrt(1.0 - first**2) + share * second
    third = np.sqrt(np.clip(1.0 - first**2 - second**2, 0.0, 1.0))
    hemisphere = first[:, None] * across + second[..., None] * along + third[..., None] * stretched
    normals = np.concatenate([hemisphere[..., :2], np.maximum(hemisphere[..., 2:], 1e-12)], axis=-1) * alpha
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def _shadowing(direction: Float[np.ndarray, "*s 3"], alpha: Float[np.ndarray, "3"]) -> Float[np.ndarray, "*s"]:
    """Smith's G1 of GGX, 0 below the surface (Walter et al. 2007, eq. 34)."""
    cos = direction[..., 2]
    slope2 = np.sum((direction[..., :2] * alpha[:2]) ** 2, axis=-1) / np.maximum(cos, 1e-12) ** 2
    return np.where(cos > 0.0, 2.0 / (1.0 + np.sqrt(1.0 + slope2)), 0.0)
