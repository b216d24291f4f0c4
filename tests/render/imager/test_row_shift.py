"""Sub-pixel shift along the columns: a wave keeps its height and moves by what it is told."""

import numpy as np
import pytest

from render.imager.expose import expose_burst
from render.imager.row_shift import rows_shifted
from render.imager.settings import ImagerSettings

PHASE_PX = 0.005
"""Error of the shift that is left [px]."""


@pytest.mark.parametrize("down", [-0.7, -0.3, 0.1, 0.25, 0.5, 1.3])
@pytest.mark.parametrize("period", [4.0, 6.0, 20.0])
def test_a_wave_moves_by_the_shift(down, period):
    """sin(2 pi v / period) becomes sin(2 pi (v - down) / period): height to 0.5 %, place to 0.005 px."""
    v = np.arange(200)
    wave = np.repeat((5 + np.sin(2 * np.pi * v / period)).astype(np.float32)[:, None], 16, axis=1)
    moved = rows_shifted(wave, down)[20:180, 3]
    basis = np.exp(2j * np.pi * v[20:180] / period)
    both = np.stack([basis.real, basis.imag, np.ones(160)], axis=1)
    cosine, sine, mean = np.linalg.lstsq(both, moved, rcond=None)[0]
    assert np.hypot(cosine, sine) == pytest.approx(1, abs=0.005)
    assert mean == pytest.approx(5, abs=1e-3)
    assert np.arctan2(-cosine, sine) * period / (2 * np.pi) == pytest.approx(down, abs=PHASE_PX)


def test_whole_rows_move_exactly():
    """By a whole pixel the rows are the same, one lower."""
    image = np.random.default_rng(1).random((40, 9)).astype(np.float32)
    np.testing.assert_allclose(rows_shifted(image, 1.0)[11:30], image[10:29], atol=1e-6)
    np.testing.assert_allclose(rows_shifted(image, 0.0)[6:34], image[6:34], atol=1e-6)


def test_light_is_never_negative():
    """Beside a step from darkness to full light a polynomial swings below 0; light does not, and its noise has a
    root."""
    step = np.repeat(np.where(np.arange(60) < 30, 0, 1000).astype(np.float32)[:, None], 8, axis=1)
    assert rows_shifted(step, 0.5).min() == 0


def test_frames_are_shifted_before_noise_and_rounding():
    """A lamp-lit ramp of half a grey value a row comes out 0.3 of it darker when moved down by 0.3 px, in the mean of
    many noisy frames; its noise is the same, which interpolating finished frames would lessen."""
    settings = ImagerSettings(vignetting_exponent=0.0, veiling_glare=0.0, gain=128.0)
    ramp = np.repeat(np.linspace(1e-3, 1e-2, 120, dtype=np.float32)[:, None], 640, axis=1)
    dark = np.zeros_like(ramp)
    straight = expose_burst(dark, ramp, settings, 60, 1).astype(float)
    moved = expose_burst(dark, ramp, settings, 60, 1, rows_down=0.3).astype(float)
    step = np.diff(straight.mean(axis=(0, 2)))[30:90].mean()
    assert step > 0.4
    difference = (moved - straight)[:, 30:90].mean()
    assert difference == pytest.approx(-0.3 * step, rel=0.02)
    assert moved[:, 30:90].std(axis=0).mean() == pytest.approx(straight[:, 30:90].std(axis=0).mean(), rel=0.01)
