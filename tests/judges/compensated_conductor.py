"""For the judge: a rough conductor that keeps its energy, Mitsuba's one-bounce GGX lobe and one of further bounces.

The second lobe is Kulla and Conty's (see `materials.energy_compensation`, which also says how well it agrees with a
random walk on the microsurface). Without it a blasted or oxidised metal is up to a third too dark, and darkness makes
holes.
"""

import functools
from typing import Any

from materials.energy_compensation import albedo_table, multiple_scattering_reflectance
from materials.material import RoughConductor
from render.world import backend

CONDUCTOR_PLUGIN = "compensated_conductor"
NEGLIGIBLE_LOSS = 0.01
"""Mean lost share below which the second lobe is left out (choice: under one grey value at mid grey)."""


def conductor_description(metal: RoughConductor) -> dict[str, Any]:
    """Mitsuba dictionary of the bare metal, without oxide."""
    table = albedo_table(metal.alpha_u, metal.alpha_v)
    bare = {
        "type": "roughconductor",
        "distribution": "ggx",
        "eta": {"type": "spectrum", "value": float(metal.n)},
        "k": {"type": "spectrum", "value": float(metal.k)},
        "alpha_u": float(metal.alpha_u),
        "alpha_v": float(metal.alpha_v),
    }
    if 1.0 - table.mean < NEGLIGIBLE_LOSS:
        return bare
    _register()
    return {
        "type": CONDUCTOR_PLUGIN,
        "n": float(metal.n),
        "k": float(metal.k),
        "alpha_u": float(metal.alpha_u),
        "alpha_v": float(metal.alpha_v),
        "bare": bare,
    }


@functools.cache
def _register() -> None:
    """Make the BSDF known to Mitsuba; its class can only be written once a variant is set."""
    mi = backend.mitsuba()
    import drjit as dr

    class CompensatedConductor(mi.BSDF):
        """Mitsuba BSDF of a bare metal: `roughconductor` plus the lobe of all further bounces.

        f_more = r (1 - E_in) (1 - E_out) / (pi (1 - E_mean)) (Kulla and Conty 2017), with E from an `AlbedoTable` and r
        of `multiple_scattering_reflectance`. One-sided: black from behind. Directions of it are drawn from the cosine
        lobe.
        """

        def __init__(self, props: Any) -> None:
            mi.BSDF.__init__(self, props)
            alphas = props["alpha_u"], props["alpha_v"]
            table = albedo_table(*alphas)
            self.bare = props["bare"]
            # Rows over sqrt(cos), columns over azimuth; the texture's half-texel border is scaled away below.
            lost = (1.0 - table.albedo).astype("float32")
            self.rows, self.columns = lost.shape
            self.lost = mi.Texture2f(mi.TensorXf(lost[..., None]), wrap_mode=dr.WrapMode.Clamp)
            reflectance = multiple_scattering_reflectance(table.mean, props["n"], props["k"])
            self.scale = mi.Float(reflectance / (dr.pi * (1.0 - table.mean)))
            # Samples are split about as the energy is, so that their weights stay near one.
            self.share = mi.Float(min(1.0 - table.mean, 0.5))
            dr.make_opaque(self.scale, self.share)
            self.m_components = [self.bare.flags()]
            self.m_flags = self.bare.flags()

        def _lost(self, w: Any, active: Any) -> Any:
            """1 - E towards the local direction w."""
            row = dr.sqrt(dr.clip(w.z, 0, 1)) * (self.rows - 1)
            azimuth = dr.atan2(dr.abs(w.y), dr.abs(w.x))
            column = azimuth * (2 / dr.pi) * (self.columns - 1)
            at = mi.Point2f((column + 0.5) / self.columns, (row + 0.5) / self.rows)
            return self.lost.eval(at, active)[0]

        def _lobe_cos(self, wi: Any, wo: Any, active: Any) -> Any:
            return self.scale * self._lost(wi, active) * self._lost(wo, active) * wo.z

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            active = active & (si.wi.z > 0)
            further = active & (sample1 < self.share)
            rescaled = dr.select(further, sample1, (sample1 - self.share) / (1 - self.share))
            bs, _ = self.bare.sample(ctx, si, rescaled, sample2, active & ~further)
            bs.wo = dr.select(further, mi.warp.square_to_cosine_hemisphere(sample2), bs.wo)
            bs.eta = 1.0
            bs.sampled_component = mi.UInt32(0)
            bs.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            value, bs.pdf = self.eval_pdf(ctx, si, bs.wo, active)
            active &= bs.pdf > 0
            return bs, dr.select(active, value / dr.select(active, bs.pdf, 1), 0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            active = active & (si.wi.z > 0) & (wo.z > 0)
            value = self.bare.eval(ctx, si, wo, active) + self._lobe_cos(si.wi, wo, active)
            return dr.select(active, value, 0)

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            active = active & (si.wi.z > 0) & (wo.z > 0)
            cosine = mi.warp.square_to_cosine_hemisphere_pdf(wo)
            return dr.select(active, dr.lerp(self.bare.pdf(ctx, si, wo, active), cosine, self.share), 0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            active = active & (si.wi.z > 0) & (wo.z > 0)
            value, pdf = self.bare.eval_pdf(ctx, si, wo, active)
            value += self._lobe_cos(si.wi, wo, active)
            pdf = dr.lerp(pdf, mi.warp.square_to_cosine_hemisphere_pdf(wo), self.share)
            return dr.select(active, value, 0), dr.select(active, pdf, 0)

        def to_string(self) -> str:
            return f"CompensatedConductor[{self.bare}]"

    mi.register_bsdf(CONDUCTOR_PLUGIN, CompensatedConductor)
