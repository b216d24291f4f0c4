"""Measured BSDFs of the RGL database under one light. Mitsuba's own `measured` plugin loads no file in one-channel
variants: it wants a spectral variant for spectral files and an RGB variant for RGB files.

Same model and same numbers as that plugin: J. Dupuy, W. Jakob, An adaptive parameterization for efficient material
acquisition and rendering, SIGGRAPH Asia 2018. A uniform sample is warped by the luminance of the lobe, then by the
visible normals, and becomes a half vector; the measured values are stored over those samples. The spectra are
summed up once, at load time.
"""

import functools
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32

from materials.bands import band_weights
from materials.lights import Band
from materials.measured_file import check_measured_file, read_tensor, tensor_fields
from materials.optical_constants import WAVELENGTH_NM
from render.world import backend

MEASURED_PLUGIN = "measured_under_light"


def measured_description(path: Path, band: Band = Band.PROJECTOR) -> dict[str, Any]:
    """Mitsuba dictionary of a spectral `.bsdf` file under a light; InputError when it is none or does not cover 850 nm.

    Of a lamp's spectrum, what the file does not cover counts as the rest (`materials.bands.band_weights`).
    """
    check_measured_file(path, WAVELENGTH_NM)
    _register()
    return {"type": MEASURED_PLUGIN, "filename": str(path), "band": band.name}


def values_at(
    spectra: Float32[np.ndarray, "phi theta n h w"], wavelengths: Float32[np.ndarray, "n"], wavelength_nm: float
) -> Float32[np.ndarray, "phi theta h w"]:
    """The measured values at one wavelength [nm], linear between the stored ones."""
    upper = int(np.clip(np.searchsorted(wavelengths, wavelength_nm), 1, len(wavelengths) - 1))
    low, high = wavelengths[upper - 1], wavelengths[upper]
    share = np.float32((wavelength_nm - low) / (high - low))
    return (1 - share) * spectra[:, :, upper - 1] + share * spectra[:, :, upper]


def values_under(
    spectra: Float32[np.ndarray, "phi theta n h w"], wavelengths: Float32[np.ndarray, "n"], band: Band
) -> Float32[np.ndarray, "phi theta h w"]:
    """The measured values as the imager weighs them under a light."""
    places, weights = band_weights(band, (float(wavelengths[0]), float(wavelengths[-1])))
    total = np.zeros_like(spectra[:, :, 0])
    for wavelength_nm, weight in zip(places, weights, strict=True):
        total += np.float32(weight) * values_at(spectra, wavelengths, float(wavelength_nm))
    return total


@functools.cache
def _register() -> None:
    """Make the plugin known to the Mitsuba variant in use."""
    backend.mitsuba().register_bsdf(MEASURED_PLUGIN, _plugin_class())


def _elevation(w: Any) -> Any:
    """Angle to the normal, exact near it."""
    import drjit as dr

    return 2 * dr.safe_asin(0.5 * dr.sqrt(dr.square(w.x) + dr.square(w.y) + dr.square(w.z - 1)))


def _unit_coordinates(theta: Any, phi: Any) -> Any:
    """Spherical angles as stored: u = sqrt(2 theta / pi), v = (phi + pi) / (2 pi), wrapped."""
    import drjit as dr

    v = (phi + dr.pi) * dr.inv_two_pi
    return backend.mitsuba().Point2f(dr.sqrt(theta * (2 / dr.pi)), v - dr.floor(v))


def _plugin_class() -> Any:
    """The BSDF; a class of its variant, so it cannot be defined before the variant is chosen."""
    mi = backend.mitsuba()
    import drjit as dr

    class MeasuredUnderLight(mi.BSDF):
        """Mitsuba BSDF of a spectral RGL file under one light, as the head of the module tells.

        The values in the file are linear in wavelength between those stored. One-sided: black from behind.
        """

        def __init__(self, props: Any) -> None:
            mi.BSDF.__init__(self, props)
            path = Path(str(props["filename"]))
            arrays = {name: read_tensor(path, field) for name, field in tensor_fields(path).items()}
            phi, theta = arrays["phi_i"], arrays["theta_i"]
            self.isotropic = len(phi) <= 2
            self.jacobian = bool(arrays["jacobian"][0])
            # Files of symmetric surfaces store a half or a quarter turn.
            self.turns = 1 if self.isotropic else round(2 * np.pi / float(phi[-1] - phi[0]))
            angles = [phi.tolist(), theta.tolist()]
            values = values_under(arrays["spectra"], arrays["wavelengths"], Band[str(props["band"])])
            self.ndf = mi.MarginalContinuous2D0(arrays["ndf"], [], False, False)
            self.sigma = mi.MarginalContinuous2D0(arrays["sigma"], [], False, False)
            self.vndf = mi.MarginalContinuous2D2(arrays["vndf"], angles, True, True)
            self.luminance = mi.MarginalContinuous2D2(arrays["luminance"], angles, True, True)
            self.values = mi.MarginalContinuous2D2(values, angles, False, False)
            self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide | mi.BSDFFlags.Anisotropic]
            self.m_flags = self.m_components[0]

        def folded(self, wi: Any, w: Any) -> Any:
            """`w` mirrored into the stored part of the turn that `wi` falls into."""
            if self.turns < 2:
                return mi.Vector3f(w)
            sign_x = wi.x if self.turns == 4 else wi.y
            return mi.Vector3f(dr.mulsign(w.x, -sign_x), dr.mulsign(w.y, -wi.y), w.z)

        def weighed(self, point: Any, u_m: Any, m: Any, wi: Any, angles: Any, densities: Any, active: Any) -> Any:
            """Value and density of a sample point with its half vector; `densities`: product of the two warps."""
            value = self.values.eval(point, angles, active)
            if self.jacobian:
                u_wi = _unit_coordinates(angles[1], angles[0])
                value *= self.ndf.eval(u_m, [], active) / (4 * self.sigma.eval(u_wi, [], active))
            sin_m = dr.hypot(m.x, m.y)
            solid_angle = dr.maximum(2 * dr.square(dr.pi) * u_m.x * sin_m, 1e-6) * 4 * dr.dot(wi, m)
            return value, densities / solid_angle

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any) -> tuple[Any, Any]:
            active = active & (si.wi.z > 0) & (wo.z > 0)
            wi, wo = self.folded(si.wi, si.wi), self.folded(si.wi, wo)
            m = dr.normalize(wi + wo)
            angles = [dr.atan2(wi.y, wi.x), _elevation(wi)]
            phi_m = dr.atan2(m.y, m.x)
            u_m = _unit_coordinates(_elevation(m), phi_m - angles[0] if self.isotropic else phi_m)
            point, density = self.vndf.invert(u_m, angles, active)
            density *= self.luminance.eval(point, angles, active)
            value, pdf = self.weighed(point, u_m, m, wi, angles, density, active)
            return dr.select(active, mi.Color1f(value), 0), dr.select(active, pdf, 0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[1]

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any) -> tuple[Any, Any]:
            active = active & (si.wi.z > 0)
            wi = self.folded(si.wi, si.wi)
            angles = [dr.atan2(wi.y, wi.x), _elevation(wi)]
            point, first = self.luminance.sample(mi.Point2f(sample2.y, sample2.x), angles, active)
            u_m, second = self.vndf.sample(point, angles, active)
            theta_m, phi_m = dr.square(u_m.x) * (dr.pi / 2), (2 * u_m.y - 1) * dr.pi
            m = _direction(theta_m, phi_m + angles[0] if self.isotropic else phi_m)
            drawn = dr.zeros(mi.BSDFSample3f)
            value, drawn.pdf = self.weighed(point, u_m, m, wi, angles, first * second, active)
            drawn.wo = self.folded(si.wi, 2 * dr.dot(m, wi) * m - wi)  # mirroring twice is no mirroring
            drawn.eta = 1.0
            drawn.sampled_type = mi.UInt32(int(mi.BSDFFlags.GlossyReflection))
            active &= (drawn.wo.z > 0) & (drawn.pdf > 0)
            drawn.pdf = dr.select(active, drawn.pdf, 0)
            return drawn, dr.select(active, mi.Color1f(value / drawn.pdf), 0)

        def traverse(self, callback: Any) -> None:
            """Nothing can be changed after loading."""

        def to_string(self) -> str:
            return "MeasuredUnderLight[]"

    return MeasuredUnderLight


def _direction(theta: Any, phi: Any) -> Any:
    """Unit vector from spherical angles."""
    import drjit as dr

    sin, cos = dr.sincos(theta)
    sin_phi, cos_phi = dr.sincos(phi)
    return backend.mitsuba().Vector3f(cos_phi * sin, sin_phi * sin, cos)
