"""Imager and speckle: noise by grey value, speckle contrast by profile. `python -m docs.figures.imager`."""

import numpy as np

from docs.figures.drawing import panels, write
from render.imager.chip import OV9282
from render.imager.expose import expose_burst
from render.imager.exposure import electrons_per_radiance
from render.imager.settings import ImagerSettings
from render.imager.speckle import aperture_degrees, bandwidth_degrees, degrees_of_freedom, speckle_contrast
from render.world.rig import FOCAL_LENGTHS_PX

ROWS, FRAMES = 120, 24
FLAT = ImagerSettings(vignetting_exponent=0.0)
GREYS = (20, 30, 50, 75, 100, 140, 180, 220)
REAL_SECOND_DIFFERENCE = {42: 0.5, 105: 0.7}
"""Noise of the quietest patches of a real D435 frame at 848x480 [DN], by second differences along a row."""


def lit(grey: float, width: int) -> np.ndarray:
    """Radiance (ROWS, width) that gives this mean grey value at the default exposure [W m^-2 sr^-1]."""
    electrons = (grey - FLAT.pedestal) / FLAT.dn_per_electron
    radiance = electrons / electrons_per_radiance(FLAT.exposure_us, FLAT)
    return np.full((ROWS, width), radiance, np.float32)


def second_difference_noise(frames: np.ndarray) -> float:
    """Root mean square of a - 2 b + c along rows over sqrt(6) [DN]: noise, blind to gradients."""
    rows = frames.astype(float)
    return float(np.sqrt(np.mean((rows[..., 2:] - 2 * rows[..., 1:-1] + rows[..., :-2]) ** 2) / 6))


def main() -> None:
    """Print both; draw noise against grey value and the contrast of speckle against the width of the stream."""
    figure, (noise_axes, speckle_axes) = panels(2, height=2.5)
    dark = np.zeros((ROWS, 1280), np.float32)
    print("temporal noise [DN] by mean grey value [DN], gain 16")
    for width in (1280, 848, 640):
        frames = [expose_burst(dark[:, :width], lit(grey, width), FLAT, FRAMES, 1) for grey in GREYS]
        noise = [float(np.sqrt(burst.astype(float).var(axis=0, ddof=1).mean())) for burst in frames]
        print(f"{width:5d}", " ".join(f"{grey}: {value:.2f}" for grey, value in zip(GREYS, noise, strict=True)))
        noise_axes.plot(GREYS, noise, marker=".", label=f"{width} columns")
    print("second differences at 848 columns, of the rendered and of a real frame [DN]")
    for grey, real in REAL_SECOND_DIFFERENCE.items():
        burst = expose_burst(dark[:, :848], lit(grey, 848), FLAT, FRAMES, 2)
        print(f"  at {grey} DN: {second_difference_noise(burst):.2f}, real {real}")
    noise_axes.set(xlabel="mean grey value [DN]", ylabel="temporal noise, 1 sigma [DN]", ylim=(0, None))
    noise_axes.set_title(f"{FRAMES} frames, exposure 8.5 ms, gain 16")
    noise_axes.legend()

    print("speckle contrast by stream: formula, drawn; grains a pixel, patterns by bandwidth")
    widths = list(dict.fromkeys(width for width, _ in FOCAL_LENGTHS_PX))
    for width in widths:
        wall = lit(120, width)
        mean = expose_burst(wall, np.zeros_like(wall), FLAT, FRAMES, 3).mean(axis=0) - FLAT.pedestal
        pitch = OV9282.pitch(width)
        print(
            f"{width:5d} {speckle_contrast(width, FLAT):.3f} {mean.std() / mean.mean():.3f}; "
            f"{aperture_degrees(pitch, FLAT.f_number):.1f}, "
            f"{bandwidth_degrees(FLAT.laser_linewidth_nm * 1e-9, FLAT.surface_height_um * 1e-6):.3f}, "
            f"in all {degrees_of_freedom(width, FLAT):.0f}"
        )
    for modes in (3.0, 10.0, 30.0):
        contrasts = [speckle_contrast(width, FLAT.model_copy(update={"laser_modes": modes})) for width in widths]
        speckle_axes.plot(widths, contrasts, marker=".", label=f"{modes:.0f} modes")
    speckle_axes.axhspan(0.04, 0.06, xmin=0, xmax=1, color="0.9", label="real, 848 columns")
    speckle_axes.set(xlabel="columns of the stream", ylabel="speckle contrast [-]", ylim=(0, None))
    speckle_axes.legend()
    write(figure, "imager")


if __name__ == "__main__":
    main()
