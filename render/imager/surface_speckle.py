"""Which surfaces speckle: the share of the projector's light that a smooth one reflects coherently, and unspeckled.

A surface whose heights vary by sigma_h in a resolved spot throws exp(-(4 pi sigma_h cos(theta) / lambda)^2) of what it
reflects into one coherent beam, its mirror image of the source, and scatters the rest (J. W. Goodman, Dependence of
image speckle contrast on surface roughness, Opt. Commun. 14, 324 (1975)). The beam is the mirror image of a point and
carries no speckle; the scattered light is fully speckled however little there is of it. So a surface loses speckle only
where it mirrors the projector itself, within its lobe: the renderer has one GGX lobe for both, of which the coherent
share is taken to be as wide as the core, exp(-(tan(half angle) / alpha)^2).

- Off that highlight a polished surface speckles as a rough one, whatever its roughness.
- Dots mirrored from another surface carry *its* speckle: a mirror adds none and takes none away.
- Left and right imager see independent patterns on either. A pixel's spot, p z / f wide, makes grains of lambda z /
  (p z / f) = lambda f / p in the plane of the lenses: 0.27 mm for 6 um pixels at any distance, and the pupils, 0.96 mm
  wide, are 50 mm apart. A flat mirror only unfolds the way. The coherent share has no pattern that could agree.

Microfacets are slopes, speckle asks for heights. They are related here by the finishes of `HEIGHTS`: on a straight line
between them in logarithms, and in proportion beyond (heights of one correlation length).
"""

import numpy as np
from jaxtyping import Float, Float32

from render.imager.settings import WAVELENGTH

RQ_PER_RA = float(np.sqrt(np.pi / 2))
"""Standard deviation over mean deviation of Gaussian heights."""
HEIGHTS = (
    # GGX alpha across the lay (`materials.finishes`), Ra [um]
    (0.010, 0.025),  # mirror: N1 of ISO 1302, the finest that superfinishing and lapping reach
    (
        0.030,
        0.050,
    ),  # polished: EN 10088-2 finish 2P, typically below 0.1 um (Stainless International); choice: half of it
    (0.070, 0.100),  # bright: 2R, bright annealed, 0.05-0.1 um; 2B, cold rolled, from 0.1 um (Alumeco)
    (0.150, 0.400),  # ground: 0.1-1.6 um (ASME B46.1, production methods), its geometric mean
    (0.280, 0.450),  # brushed: 2J, 0.2-1.0 um (Stainless International), its geometric mean
)
"""Roughness Ra of finishes of known alpha. Above 0.15 um nothing coherent is left: the first three decide, and what is
rougher than brushed (blasted: some micrometres, more than the proportion gives) matters no more."""


def surface_height(alpha: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Standard deviation of a surface's heights [m] by its GGX roughness across the lay."""
    known, ra = np.log(np.array(HEIGHTS)).T
    low, high = np.minimum(np.log(alpha) - known[0], 0), np.maximum(np.log(alpha) - known[-1], 0)
    return RQ_PER_RA * 1e-6 * np.exp(np.interp(np.log(alpha), known, ra) + low + high)


def coherent_share(height: Float[np.ndarray, "*n"], cosine: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Share of the reflected light in the mirror beam [0, 1]. height: standard deviation [m]; cosine: of incidence."""
    return np.exp(-((4 * np.pi * height * cosine / WAVELENGTH) ** 2))


def specular_share(
    to_projector: Float32[np.ndarray, "p 3"],
    to_imager: Float32[np.ndarray, "p 3"],
    normal: Float32[np.ndarray, "p 3"],
    alpha: Float32[np.ndarray, "p"],
    height: Float32[np.ndarray, "p"],
) -> Float32[np.ndarray, "p"]:
    """Share of the projector's light that reaches the imager coherently from points of glossy surfaces [0, 1].

    to_projector, to_imager, normal: unit vectors at the points; alpha: GGX roughness across the lay; height: what
    `surface_height` makes of it [m].
    """
    half = to_projector + to_imager
    length = np.linalg.norm(half, axis=1)
    cosine = np.einsum("pk,pk->p", to_projector, half) / length
    across = np.clip(np.einsum("pk,pk->p", normal, half) / length, 1e-3, 1)
    core = np.exp(-(1 / across**2 - 1) / alpha**2)
    return (coherent_share(height, cosine) * core).astype(np.float32)
