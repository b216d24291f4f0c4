"""Oracle: light that walks over a GGX microsurface, facet to facet, until it leaves.

Written from E. Heitz, J. Hanika, E. d'Eon, C. Dachsbacher, Multiple-scattering microfacet BSDFs with the Smith model,
ACM Trans. Graph. 35(4), 2016: heights uniform in [-1, 1], free paths by the Smith model, facets as they are visible.
Visible facets are found by rejection on the ellipsoid whose normals GGX describes (B. Walter et al., The ellipsoid
normal distribution function, 2014), without the warp that the code under test integrates over.
"""

import numpy as np

UP = 1.0 - 1e-5
"""Cosine above which light can hit nothing more."""


def lambda_ggx(w, alpha):
    """Smith's signed Lambda of directions (n, 3); below -1 for those that go down."""
    slope2 = np.sum((alpha[:2] * w[..., :2]) ** 2, axis=-1) / np.maximum(w[..., 2] ** 2, 1e-12)
    return 0.5 * (np.where(w[..., 2] > 0, 1.0, -1.0) * np.sqrt(1.0 + slope2) - 1.0)


def distribution(m, alpha):
    """GGX D(m) of facet normals (n, 3)."""
    stretch = np.sum((m / alpha) ** 2, axis=-1)
    return np.where(m[..., 2] > 0, 1.0 / (np.pi * alpha[0] * alpha[1] * stretch**2), 0.0)


def projected_area(w, alpha):
    """Area of the facets turned towards w: the integral of <w, m> D(m)."""
    return 0.5 * (np.linalg.norm(alpha * w, axis=-1) + w[..., 2])


def visible_facets(towards, alpha, rng):
    """One facet normal for each direction (n, 3), as likely as it is seen from there."""
    pole = alpha * towards
    pole = pole / np.linalg.norm(pole, axis=-1, keepdims=True)
    normals = np.zeros_like(pole)
    todo = np.arange(len(pole))
    while len(todo):
        points = rng.normal(size=(len(todo), 3))
        points -= np.sum(points * pole[todo], axis=-1, keepdims=True) * pole[todo]
        points *= np.sqrt(rng.random((len(todo), 1))) / np.linalg.norm(points, axis=-1, keepdims=True)
        height = np.sqrt(1.0 - np.sum(points**2, axis=-1, keepdims=True))
        sphere = points + height * pole[todo]  # parallel rays that meet the unit sphere
        upper = sphere[:, 2] > 0
        normals[todo[upper]] = sphere[upper] * alpha
        todo = todo[~upper]
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def walk(incoming, outgoing, alpha, fresnel, n_photons, rng, n_bounces=12):
    """Follow photons that arrive from `incoming` on facets of reflectance `fresnel(cos)`.

    Returns, per number of bounces (n_bounces + 1,), the share of the light that leaves, and the BRDF times cosine
    towards `outgoing`, next-event estimated at every bounce.
    """
    alpha = np.array([*alpha, 1.0])
    w, weight, height = np.tile(-np.asarray(incoming), (n_photons, 1)), np.ones(n_photons), np.ones(n_photons)
    leaving, towards = np.zeros(n_bounces + 1), np.zeros(n_bounces + 1)
    for bounce in range(n_bounces + 1):
        lam, below = lambda_ggx(w, alpha), np.clip(0.5 * (height + 1.0), 1e-12, 1.0)
        draw = rng.random(len(w))
        rising = w[:, 2] > 0
        escapes = rising & ((draw > 1.0 - below ** np.where(rising, lam, 1.0)) | (w[:, 2] > UP))
        if bounce > 0:
            leaving[bounce] = weight[escapes].sum() / n_photons
        w, weight, lam, draw, below = (x[~escapes] for x in (w, weight, lam, draw, below))
        if len(w) == 0 or bounce == n_bounces:
            break
        height = np.clip(2.0 * below / (1.0 - draw) ** (1.0 / lam) - 1.0, -1.0, 1.0)
        half = outgoing - w
        half = half / np.linalg.norm(half, axis=-1, keepdims=True)
        cos = np.clip(np.sum(-w * half, axis=-1), 0.0, 1.0)
        phase = fresnel(cos) * distribution(half, alpha) / (4.0 * projected_area(-w, alpha))
        unshadowed = (0.5 * (height + 1.0)) ** lambda_ggx(np.asarray(outgoing), alpha)
        towards[bounce + 1] = np.sum(weight * phase * unshadowed) / n_photons
        facets = visible_facets(-w, alpha, rng)
        cos = np.sum(-w * facets, axis=-1)
        weight = weight * fresnel(cos)
        w = w + 2.0 * cos[:, None] * facets
    return leaving, towards
