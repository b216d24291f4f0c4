"""Matcher: a flat matte wall as the datasheet measures it, from 0.3 to 2 m. `python -m docs.figures.wall`."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from docs.figures.drawing import panels, write
from render.d435i import SensorSettings, SimulatedD435i
from render.depth.coding import DepthFormat
from render.world.rig import d435i_rig, left_band
from tests.physics.simple_scenes import facing_x
from tests.physics.test_depth_laws import lit_wall, middle

DISTANCES = (0.3, 0.5, 0.75, 1.0, 1.5, 2.0)
"""[m]"""
TURN_DEG = 5.0
"""Of the camera, so that all fractions of a disparity step occur."""
FRAMES = 40
FINE = SensorSettings(crop=None, depth=DepthFormat(unit=1e-4))
"""In steps of 0.1 mm, finer than the noise."""
PUBLISHED_SUBPIXEL = (0.05, 0.10)
"""Root mean square sub-pixel error that Intel states for the D400 series [px]."""


@dataclass(frozen=True)
class WallFigures:
    """Of the middle 80 % of the image, its band without partners left out."""

    fill: float
    z_error: float
    """Median, as share of the distance."""
    rms_m: float
    """Root mean square over the wall of one frame about its true plane [m]."""
    rms_px: float
    """The same in disparity [px]."""
    temporal_m: float
    """Standard deviation over the frames, median of the pixels [m]."""
    temporal_px: float


def measure(distance: float) -> WallFigures:
    """A burst of a wall at this distance."""
    rig, camera = d435i_rig(), SimulatedD435i(lit_wall(distance), FINE, seed=1)
    pose = facing_x() * RigidTransform.from_rotation(Rotation.from_rotvec([0.0, np.radians(TURN_DEG), 0.0]))
    depths, truth = camera.measure(pose, FRAMES).depths, camera.truth(pose).depth
    seen = middle(~left_band(rig, truth))
    z, true = middle(depths)[:, seen].astype(float), middle(truth)[seen]
    valid = z > 0
    error = np.where(valid, z - true, np.nan)
    shift = np.where(valid, rig.focal_baseline / np.where(valid, z, 1) - rig.focal_baseline / true, np.nan)
    always = valid.all(axis=0)
    first, moved = error[0] - np.nanmedian(error[0]), shift[0] - np.nanmedian(shift[0])
    return WallFigures(
        fill=float(valid.mean()),
        z_error=float(np.nanmedian(error / true)),
        rms_m=float(np.sqrt(np.nanmean(first**2))),
        rms_px=float(np.sqrt(np.nanmean(moved**2))),
        temporal_m=float(np.median(z[:, always].std(axis=0, ddof=1))),
        temporal_px=float(np.median(shift[:, always].std(axis=0, ddof=1))),
    )


def main() -> None:
    """Print fill, Z-accuracy and noise by distance; draw the noise beside the law Z^2 s / (f B)."""
    print(f"turned by {TURN_DEG:g} deg, {FRAMES} frames; distance, filled, Z error, RMS, temporal noise")
    walls = [measure(distance) for distance in DISTANCES]
    for distance, wall in zip(DISTANCES, walls, strict=True):
        print(
            f"  {distance:.2f} m  {100 * wall.fill:6.2f} %  {100 * wall.z_error:+.2f} %  "
            f"{1e3 * wall.rms_m:6.2f} mm = {100 * wall.rms_m / distance:.2f} % = {wall.rms_px:.3f} px  "
            f"{1e3 * wall.temporal_m:6.2f} mm = {100 * wall.temporal_m / distance:.2f} % = {wall.temporal_px:.3f} px"
        )
    figure, (axes,) = panels(1, width=4.6, height=2.6)
    z, focal_baseline = np.linspace(min(DISTANCES), max(DISTANCES), 100), d435i_rig().focal_baseline
    low, high = (1e3 * z**2 * s / focal_baseline for s in PUBLISHED_SUBPIXEL)
    axes.fill_between(z, low, high, color="0.85", label=r"$Z^2 s / (f B)$, s = 0.05 to 0.1 px")
    axes.plot(DISTANCES, [1e3 * wall.rms_m for wall in walls], marker="o", label="over the wall, one frame")
    axes.plot(DISTANCES, [1e3 * wall.temporal_m for wall in walls], marker="s", label=f"over {FRAMES} frames")
    axes.set(xlabel="distance of the wall [m]", ylabel="noise of Z, 1 sigma [mm]", xscale="log", yscale="log")
    axes.set_xticks(DISTANCES, labels=[f"{distance:g}" for distance in DISTANCES])
    axes.minorticks_off()
    axes.legend(fontsize=7)
    write(figure, "wall")


if __name__ == "__main__":
    main()
