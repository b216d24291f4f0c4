"""The lobes of metals as formulas on the device: GGX facets, the light of further bounces, and a diffuse oxide.

Facets: B. Walter et al., Microfacet models for refraction through rough surfaces (EGSR 2007), anisotropic as in E.
Heitz, Understanding the masking-shadowing function (JCGT 3, 2014), separable shadowing. Directions are drawn from the
visible normals (J. Dupuy, A. Benyoub, Sampling visible GGX normals with spherical caps, HPG 2023). Further bounces:
`materials.energy_compensation`. Written out instead of asking Mitsuba's `roughconductor`, since the lobes are wanted in
two bands and for several directions at once; that plugin is what tests hold this against.
"""

from dataclasses import dataclass
from typing import Any

from render.world import backend
from render.world.reflectances import CONDUCTOR_FIELDS, LOSS_COLUMNS, LOSS_ROWS, Reflectances


@dataclass(frozen=True, eq=False)
class MetalLobes:
    """Of the metals at interactions, seen from local directions `wi` above them; Dr.Jit values, one a path.

    Values are BRDF times cosine [1/sr], pairs for 850 nm and for the lamps' band; densities are over solid angle.
    """

    wi: Any
    alpha: tuple[Any, Any]
    """Along and across the lay."""
    indices: tuple[tuple[Any, Any], tuple[Any, Any]]
    """n and k in either band."""
    oxide: Any
    """Share of the surface that reflects diffusely."""
    oxide_albedo: tuple[Any, Any]
    """Of that share."""
    cosine_share: Any
    """Chance that a direction is drawn from the cosine lobe, which serves oxide and further bounces."""
    further_scale: tuple[Any, Any] | None
    """Of the lobe of further bounces, 0 where it is left out; None = no metal of the scene has one."""
    lost: Any
    """`Reflectances.lost`."""
    place: Any
    """Which table in `lost`."""
    shadowing: Any
    """Smith's G1 towards `wi`."""

    @classmethod
    def at(cls, reflectances: Reflectances, body: Any, wi: Any, active: Any) -> "MetalLobes":
        """Look the metals of the bodies up; what is not active gets lobes of no meaning."""
        mi = backend.mitsuba()
        import drjit as dr

        first = body * (CONDUCTOR_FIELDS // 4)
        a, b, c = (dr.gather(mi.Vector4f, reflectances.conductors, first + i, active) for i in range(3))
        scale, place = None, mi.Float(0)
        if reflectances.lost is not None:
            d = dr.gather(mi.Vector4f, reflectances.conductors, first + 3, active)
            scale, place = (d.x, d.y), dr.maximum(b.z, 0)
        alpha = dr.maximum(a.x, 1e-4), dr.maximum(a.y, 1e-4)
        shadowing = _shadowing(wi, alpha)
        bands = (a.z, a.w), (b.x, b.y)
        return cls(wi, alpha, bands, c.x, (c.y, c.z), c.w, scale, reflectances.lost, place, shadowing)

    def towards(self, wo: Any, active: Any, bands: tuple[int, ...]) -> tuple[list[Any], Any]:
        """Values in the given bands (0 = 850 nm, 1 = under the lamps), and the density of `sampled`."""
        mi = backend.mitsuba()
        import drjit as dr

        above = active & (self.wi.z > 0) & (wo.z > 0)
        half = dr.normalize(self.wi + wo)
        visible = _visible_facets(self.wi, half, self.alpha, self.shadowing)
        lobe = visible * _shadowing(wo, self.alpha) * (1 - self.oxide)
        cosine = dr.inv_pi * wo.z
        further = None
        if self.further_scale is not None:
            further = self._lost(self.wi, active) * self._lost(wo, active) * wo.z * (1 - self.oxide)
        cos_facet = dr.minimum(dr.dot(self.wi, half), 1)
        values = []
        for band in bands:
            value = lobe * conductor_fresnel(cos_facet, *self.indices[band])
            value += self.oxide * self.oxide_albedo[band] * cosine
            if further is not None and self.further_scale is not None:
                value += self.further_scale[band] * further
            values.append(dr.select(above, value, mi.Float(0)))
        return values, dr.select(above, dr.lerp(visible, cosine, self.cosine_share), 0)

    def sampled(self, u: Any, v: Any) -> Any:
        """Local directions drawn from the lobes. u, v: uniform in [0, 1) and its square."""
        mi = backend.mitsuba()
        import drjit as dr

        wi, (alpha_u, alpha_v) = self.wi, self.alpha
        stretched = dr.normalize(mi.Vector3f(wi.x * alpha_u, wi.y * alpha_v, wi.z))
        z = (1 - v.y) * (1 + stretched.z) - stretched.z
        radius = dr.safe_sqrt(1 - z * z)
        sine, cosine = dr.sincos(2 * dr.pi * v.x)
        normal = mi.Vector3f(radius * cosine, radius * sine, z) + stretched
        normal = dr.normalize(mi.Vector3f(normal.x * alpha_u, normal.y * alpha_v, dr.maximum(normal.z, 1e-7)))
        mirrored = 2 * dr.dot(wi, normal) * normal - wi
        return dr.select(u < self.cosine_share, mi.warp.square_to_cosine_hemisphere(v), mirrored)

    def _lost(self, w: Any, active: Any) -> Any:
        """1 - E towards the local direction w; the textures' half-texel border is scaled away."""
        mi = backend.mitsuba()
        import drjit as dr

        rows = self.lost.shape[0]
        row = dr.sqrt(dr.clip(w.z, 0, 1)) * (LOSS_ROWS - 1) + self.place * LOSS_ROWS
        column = dr.atan2(dr.abs(w.y), dr.abs(w.x)) * (2 / dr.pi) * (LOSS_COLUMNS - 1)
        return self.lost.eval(mi.Point2f((column + 0.5) / LOSS_COLUMNS, (row + 0.5) / rows), active)[0]


def facet_lobe(wi: Any, wo: Any, alpha: tuple[Any, Any]) -> Any:
    """Value times cosine [1/sr] of GGX facets that reflect all light, between local directions above the surface."""
    import drjit as dr

    return _visible_facets(wi, dr.normalize(wi + wo), alpha, _shadowing(wi, alpha)) * _shadowing(wo, alpha)


def _visible_facets(wi: Any, half: Any, alpha: tuple[Any, Any], shadowing: Any) -> Any:
    """Density of the directions that the facets seen from `wi` mirror it to [1/sr]."""
    import drjit as dr

    u, v = half.x / alpha[0], half.y / alpha[1]
    facets = dr.rcp(dr.pi * alpha[0] * alpha[1] * dr.square(u * u + v * v + half.z * half.z))
    return facets * shadowing / (4 * wi.z)


def _shadowing(w: Any, alpha: tuple[Any, Any]) -> Any:
    """Smith's G1 of directions above the surface (Walter et al. 2007, eq. 34)."""
    import drjit as dr

    slope2 = (dr.square(alpha[0] * w.x) + dr.square(alpha[1] * w.y)) / dr.maximum(dr.square(w.z), 1e-12)
    return 2 / (1 + dr.sqrt(1 + slope2))


def conductor_fresnel(cos: Any, n: Any, k: Any) -> Any:
    """Mean of the s and p reflectance of n + ik by the cosine of incidence: `materials.fresnel` on the device."""
    import drjit as dr

    cos2 = cos * cos
    sin2 = 1 - cos2
    real = n * n - k * k - sin2
    a2_plus_b2 = dr.sqrt(real * real + 4 * n * n * k * k)
    a_cos = dr.sqrt(dr.maximum(0.5 * (a2_plus_b2 + real), 0)) * cos
    s = (a2_plus_b2 + cos2 - 2 * a_cos) / (a2_plus_b2 + cos2 + 2 * a_cos)
    first, second = cos2 * a2_plus_b2 + sin2 * sin2, 2 * a_cos * sin2
    return 0.5 * s * (1 + (first - second) / (first + second))
