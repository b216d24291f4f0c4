"""Imager and speckle: noise, defocus, glare, filter, speckle, rows out of line. `python -m docs.figures.imager`."""

import numpy as np

from docs.figures.drawing import panels, write
from franbv.frames import look_at
from materials.finishes import FINISHES
from materials.material import Matte
from render.d435i import SensorSettings, SimulatedD435i
from render.depth.coding import metres_from_z16, z16_from_disparity
from render.imager.band_pass import BandPass
from render.imager.chip import OV9282
from render.imager.defocus import disc_diameter_px
from render.imager.expose import expose_burst
from render.imager.exposure import electrons_per_radiance
from render.imager.glare import with_glare
from render.imager.settings import ImagerSettings
from render.imager.speckle import (
    aperture_degrees,
    bandwidth_degrees,
    contrast_kept,
    degrees_of_freedom,
    speckle_contrast,
)
from render.imager.surface_speckle import coherent_share, surface_height
from render.labels.causes import Cause
from render.labels.geometric import geometry, in_projector_field
from render.labels.outcome import is_false_depth
from render.labels.twin import twin_scene
from render.world.rig import FOCAL_LENGTHS_PX
from scenes.build import part_scene
from scenes.parts import EARLIER_PARTS
from tests.physics.matte_parts import away_from
from tests.physics.simple_scenes import facing_x, wall

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


def print_optics() -> None:
    """Tables of defocus by distance, glare by the size of a black square, and a filter by field angle."""
    print("disc of defocus by distance [m]: um on the chip, px of 1280x720, px of 640x360")
    for z in (0.1, 0.141, 0.2, 0.3, 0.618, 1.0, 3.0, 1e6):
        at = [float(disc_diameter_px(np.full((1, width), 1 / z, np.float32), FLAT)[0, 0]) for width in (1280, 640)]
        print(f"  {z:9.3f} {3 * at[0]:5.2f} {at[0]:5.2f} {at[1]:5.2f}")
    print(f"black square in a white surround, index {FLAT.veiling_glare}: side [px of 1280x720], light in its middle")
    for side in (16, 80, 160, 320):
        image = np.ones((720, 1280), np.float32)
        image[360 - side // 2 : 360 + side // 2, 640 - side // 2 : 640 + side // 2] = 0
        print(f"  {side:4d} {100 * with_glare(image, FLAT)[360, 640]:.2f} %")
    print("share of the projector's light through a filter by field angle [deg]: width 40 nm, 160 nm")
    for angle in (0, 15, 25, 35, 43):
        sine, light = np.sin(np.radians([angle])), np.array([850.0])
        shares = [BandPass(width_nm=width).transmission(light, sine)[0] for width in (40.0, 160.0)]
        print(f"  {angle:3d} {shares[0]:.2f} {shares[1]:.2f}")


def print_finishes() -> None:
    """Heights of the finishes, and what speckle is left where they mirror the projector at normal incidence."""
    print("finish: heights [um], coherent share, speckle contrast there relative to rough surfaces, 640x360")
    for name in ("mirror", "polished", "bright", "ground", "brushed"):
        height = surface_height(np.array([FINISHES[name].alpha_v]))
        share = coherent_share(height, np.ones(1)).astype(np.float32)
        kept = contrast_kept(share, 640, FLAT)[0]
        print(f"  {name:15s} {1e6 * height[0]:.3f} {share[0]:.2f} {kept:.2f}")


def print_rows_out_of_line(distance: float = 0.5) -> None:
    """Depth of a matte wall whose right images lie lower than they ought to, at 640x360."""
    print(f"matte wall at {distance} m, right image lower by [px]: filled, spread of disparity [px] (one frame)")
    camera = SimulatedD435i(wall(distance, Matte("wall", 0.5)), SensorSettings(crop=None), 1)
    layers = camera.render(facing_x())
    for down in (0.0, 0.1, 0.3, 0.5, 1.0):
        settings = SensorSettings(crop=None, row_misalignment_px=down)
        depth = (
            SimulatedD435i(camera.world.source, settings, 1).expose(facing_x(), *layers, 1).depths[0, 90:270, 160:480]
        )
        disparity = camera.rig.focal_baseline / depth[depth > 0]
        print(f"  {down:.1f} {100 * np.mean(depth > 0):6.2f} % {disparity.std():.3f}")


def print_matte_parts(distance: float) -> None:
    """What defocus and glare cost of matte parts whose front is `distance` [m] away; same light with and without."""
    print(f"matte parts {distance} m away, measurable pixels of the part: filled, false; without defocus and glare")
    for name in EARLIER_PARTS:
        scene = twin_scene(part_scene(name, table_material=Matte("table", 0.5)))
        corners = np.concatenate([body.mesh.vertices for body in scene.bodies if body.is_part])
        middle, outward = (corners.min(axis=0) + corners.max(axis=0)) / 2, np.sqrt([0.5, 0.0, 0.5])
        front = middle + outward * np.percentile((corners - middle) @ outward, 90)
        camera, pose = SimulatedD435i(scene, SensorSettings(crop=None), 1), look_at(front + distance * outward, front)
        layers, truth, rig = camera.render(pose), camera.truth(pose), camera.rig
        wholly = camera.expose(pose, *layers, 1)
        ideal = wholly.imager.model_copy(update={"veiling_glare": 0.0})
        pair = [
            expose_burst(layer.projector, layer.ambient, ideal, 1, seed, rig.chip)
            for layer, seed in zip(layers, np.random.SeedSequence(1).spawn(2), strict=True)
        ]
        plainly = camera.settings.stereo_matcher.match_burst(pair[0], pair[1])
        depths = wholly.depths[0], metres_from_z16(z16_from_disparity(plainly, rig.focal_baseline))[0]
        hidden = (geometry(camera, truth).impossible != Cause.MEASURED) | ~in_projector_field(rig, truth.depth)
        chosen = away_from(hidden) & np.isin(truth.body, [i for i, b in enumerate(scene.bodies) if b.is_part])
        words = []
        for depth in depths:
            false = is_false_depth(depth, truth.depth, rig.focal_baseline)[chosen & (depth > 0)]
            words.append(f"{100 * np.mean(depth[chosen] > 0):.1f} % {100 * false.mean():.1f} %")
        print(f"  {name} {'; '.join(words)}", flush=True)


def main() -> None:
    """Print all; draw noise by grey value, contrast of speckle by the stream's width, and defocus by distance."""
    figure, (noise_axes, speckle_axes, focus_axes) = panels(3, height=2.5)
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
    distances = np.geomspace(0.1, 4, 200)
    for width in (1280, 848, 640):
        inverse = np.repeat(1 / distances[:, None], width, axis=1).astype(np.float32)
        focus_axes.plot(distances, disc_diameter_px(inverse, FLAT)[:, 0], label=f"{width} columns")
    focus_axes.set(xscale="log", xlabel="distance [m]", ylabel="disc of defocus [px]", ylim=(0, None))
    focus_axes.set_xticks([0.1, 0.2, 0.5, 1, 2, 4], ["0.1", "0.2", "0.5", "1", "2", "4"])
    focus_axes.legend()
    print_optics()
    print_finishes()
    print_rows_out_of_line()
    for distance in (0.15, 0.3):
        print_matte_parts(distance)
    write(figure, "imager")


if __name__ == "__main__":
    main()
