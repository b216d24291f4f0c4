"""Measured BSDFs in the one-channel variant against Mitsuba's own plugin in the spectral one."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from materials.input_error import InputError
from materials.material import Measured
from render.world import backend
from render.world.bsdf import bsdf_description
from render.world.measured_bsdf import measured_description, values_at
from tests.materials.rgl_file import spectral_measurement, write_tensor_file

SINGLE_PRECISION = 2e-5
"""Relative agreement of two chains of float32 operations."""
N = 2000


def smooth(rng, *shape):
    """Positive values that vary slowly over the last two axes, as measured lobes do."""
    return gaussian_filter(rng.random(shape), [0] * (len(shape) - 2) + [2, 2]).astype(np.float32) + np.float32(0.05)


def measurement(n_phi, jacobian):
    """A made-up measurement: one azimuth = isotropic; 5 cover half a turn; 9 a whole one."""
    rng = np.random.default_rng(n_phi)
    wavelengths = np.linspace(360, 1000, 9, dtype=np.float32)
    end = 0.0 if n_phi == 5 else np.pi
    return {
        "theta_i": np.linspace(0, 1.5, 6, dtype=np.float32),
        "phi_i": np.linspace(-np.pi, end, n_phi, dtype=np.float32) if n_phi > 1 else np.zeros(1, np.float32),
        "ndf": smooth(rng, 16, 16),
        "sigma": smooth(rng, 16, 16) if n_phi > 1 else np.tile(smooth(rng, 1, 16), (16, 1)),
        "vndf": smooth(rng, n_phi, 6, 16, 16),
        "luminance": smooth(rng, n_phi, 6, 12, 12),
        "spectra": smooth(rng, n_phi, 6, 9, 12, 12),
        "wavelengths": wavelengths,
        "description": np.frombuffer(b"made up", np.uint8),
        "jacobian": np.array([jacobian], np.uint8),
    }


def directions(rng):
    """(3, N) directions above the surface, away from grazing."""
    z, phi = rng.uniform(0.1, 1.0, N), rng.uniform(-np.pi, np.pi, N)
    s = np.sqrt(1 - z**2)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z]).astype(np.float32)


def evaluated(mi, description, wi, wo, uniform):
    """Value, density, and a sample's direction, density and weight in the variant in use."""
    import drjit as dr

    bsdf, context = mi.load_dict(description), mi.BSDFContext()
    si = dr.zeros(mi.SurfaceInteraction3f, N)
    si.wi = mi.Vector3f(wi)
    if mi.is_spectral:
        si.wavelengths = dr.full(type(si.wavelengths), 850.0, N)
    value, density = bsdf.eval(context, si, mi.Vector3f(wo), True), bsdf.pdf(context, si, mi.Vector3f(wo), True)
    drawn, weight = bsdf.sample(context, si, mi.Float(uniform[0]), mi.Point2f(uniform), True)
    found = (value[0], density, drawn.wo.x, drawn.wo.y, drawn.wo.z, drawn.pdf, weight[0])
    return [np.asarray(x) for x in found]


@pytest.mark.parametrize(("n_phi", "jacobian"), [(1, 1), (1, 0), (5, 1), (9, 1)])
def test_it_gives_the_numbers_of_mitsubas_plugin_at_850_nm(tmp_path, n_phi, jacobian):
    """Mitsuba evaluates the same file spectrally; at 850 nm value, density and samples must be the same. A few samples
    at seams, where single precision decides on which side one falls, are left out (99.5 % quantile)."""
    path = write_tensor_file(tmp_path / "a.bsdf", measurement(n_phi, jacobian))
    rng = np.random.default_rng(1)
    wi, wo, uniform = directions(rng), directions(rng), rng.random((2, N)).astype(np.float32)
    mi = backend.mitsuba()
    ours = evaluated(mi, measured_description(path), wi, wo, uniform)
    try:
        mi.set_variant(backend.mitsuba_variant().replace("mono", "spectral"))
        theirs = evaluated(mi, {"type": "measured", "filename": str(path)}, wi, wo, uniform)
    finally:
        mi.set_variant(backend.mitsuba_variant())
    above = (ours[4] > 1e-3) & (theirs[4] > 1e-3)
    for k, (one, other) in enumerate(zip(ours, theirs, strict=True)):
        chosen = above if k >= 2 else slice(None)
        error = np.abs(one - other)[chosen] / (np.abs(other)[chosen] + 1e-2)
        assert np.quantile(error, 0.995) < SINGLE_PRECISION
    assert above.mean() > 0.3


def test_values_are_interpolated_between_stored_wavelengths():
    """Spectra that equal their wavelength must give the wavelength asked for, stored or not."""
    wavelengths = np.array([360, 700, 900, 1000], np.float32)
    spectra = np.broadcast_to(wavelengths[:, None, None], (1, 2, 4, 3, 3)).astype(np.float32)
    for wavelength in (360.0, 850.0, 900.0, 1000.0):
        assert values_at(spectra, wavelengths, wavelength) == pytest.approx(wavelength, rel=1e-6)


def test_a_measured_material_renders(tmp_path):
    """The material goes the whole way into Mitsuba, and a bad file stops at the boundary with one line."""
    mi = backend.mitsuba()
    path = write_tensor_file(tmp_path / "a.bsdf", spectral_measurement(np.linspace(360, 1000, 9)))
    assert mi.load_dict(bsdf_description(Measured("a", path))) is not None
    path.write_bytes(b"nothing")
    with pytest.raises(InputError, match="is not an RGL tensor file"):
        bsdf_description(Measured("a", path))
