"""False depth on mirrors: balls, plate, corner. `python -m docs.figures.mirrors` prints the tables (ten minutes)."""

from collections.abc import Iterator

import cv2
import numpy as np

from docs.figures.drawing import panels, show_error, show_grey, write
from render.d435i import SensorSettings, SimulatedD435i
from tests.physics.ball_bias import (
    PUBLISHED_BASELINE,
    PUBLISHED_FOCAL,
    PUBLISHED_HEIGHT,
    BallBias,
    bias_by_ring,
    camera_near,
    camera_of_published_frame,
    outline_share,
)
from tests.physics.mirror_optics import mirrored_stereo_depth, virtual_image_depth
from tests.physics.mirror_scenes import (
    PLATE_DISTANCE,
    WALL_OFFSET,
    MirrorView,
    ball_from_above,
    corner_with_mirror,
    floor_behind_mirror,
    pixel_rays,
    plate_before_wall,
    steel,
)

RADIUS = 0.0435
RADII = (0.015, 0.025, 0.035, 0.0435, 0.060)
NEAR = 0.02
CEILING = 1.95
HIGHLIGHT_SHARE = 0.75
"""The brightest quarter of the table counts as its highlights."""


def words(bias: BallBias) -> str:
    """Fill, median and rings in one line."""
    rings = " ".join(f"{ring:5.1f}" for ring in bias.rings_mm)
    return (
        f"filled {100 * bias.filled:5.1f} %  median {bias.median_mm:5.1f} mm  "
        f"middle {bias.middle_mm:5.1f}  rings {rings}"
    )


def flat_mirrors() -> None:
    """Print what plate and corner show."""
    settings = SensorSettings(crop=None, auto_exposure=False)
    print("flat mirrors: filled, within 2 % of the mirrored thing, median of measured / expected")
    for alpha in (0.005, 0.01, 0.02, 0.03, 0.05):
        for name, view in (("plate", plate_before_wall(alpha)), ("corner", corner_with_mirror(alpha))):
            camera = SimulatedD435i(view.scene, settings, seed=1)
            depth = camera.measure(view.T_world_cam, 1).depths[0]
            expected = np.full(depth.shape, PLATE_DISTANCE + WALL_OFFSET)
            if name == "corner":
                expected = floor_behind_mirror(camera, view)
            seen = view.mirror_pixels(camera) & np.isfinite(expected)
            valid = seen & (depth > 0)
            ratio = depth[valid] / expected[valid]
            print(
                f"  {name:6s} alpha {alpha:5.3f}: {100 * valid.sum() / seen.sum():5.1f} %  "
                f"{100 * np.mean(np.abs(ratio - 1) < NEAR):5.1f} %  {np.median(ratio):.4f}"
            )


def five_radii() -> None:
    """Print the bias of mirror balls 0.5 m below the camera."""
    print("balls on a wooden table, pole at 0.5 m: s R / (2 s + R) of the ceiling, and the measurement")
    for lamps in ("workshop", "off"):
        for alpha in (0.01, 0.03):
            for radius in RADII:
                view = ball_from_above(steel(alpha), radius, 0.5 + 2 * radius, lamps=lamps)
                bias = measured(camera_near(view), view, radius)[0]
                expected = 1e3 * virtual_image_depth(CEILING - 2 * radius, radius)
                print(
                    f"  {lamps:8s} alpha {alpha:.2f} R {1e3 * radius:4.1f} mm: {expected:5.1f} mm; {words(bias)}",
                    flush=True,
                )


def measured(camera: SimulatedD435i, view: MirrorView, radius: float) -> tuple[BallBias, np.ndarray, np.ndarray]:
    """Bias, infrared image and depth error [mm], NaN without depth."""
    frame, truth = camera.measure(view.T_world_cam, 1), camera.truth(view.T_world_cam)
    depth, share = frame.depths[0], outline_share(camera, view, radius)
    error = np.where((depth > 0) & (truth.depth > 0), 1e3 * (depth - truth.depth), np.nan)
    return bias_by_ring(depth, truth.depth, truth.body == view.mirror, share), frame.lefts[0], error


def published() -> Iterator[tuple[float, float, BallBias, np.ndarray, np.ndarray]]:
    """Balls like those of the published frame: radius, alpha, bias, image, error."""
    for radius, alpha in ((RADIUS, 0.02), (RADIUS, 0.01), (RADIUS, 0.03), (RADIUS, 0.05), (RADIUS, 0.1), (0.025, 0.02)):
        view = ball_from_above(steel(alpha), radius, PUBLISHED_HEIGHT, steel(0.2))
        camera = camera_of_published_frame(view)
        bias, image, error = measured(camera, view, radius)
        yield radius, alpha, bias, image, error


def specks(image: np.ndarray, error: np.ndarray) -> str:
    """Holes in the brightest quarter of the table between the columns that the dots light."""
    table = np.zeros(image.shape, bool)
    table[:, 300:980] = True
    table[150:270, 570:710] = False
    bright = table & (image >= np.quantile(image[table], HIGHLIGHT_SHARE))
    count, _, boxes, _ = cv2.connectedComponentsWithStats((np.isnan(error) & table).astype(np.uint8))
    areas = boxes[1:, cv2.CC_STAT_AREA]
    return (
        f"table: {100 * np.mean(np.isnan(error[table])):.1f} % holes, "
        f"{100 * np.mean(np.isnan(error[bright])):.1f} % in its brightest quarter; "
        f"{count - 1} specks of median {np.median(areas):.0f} px; "
        f"error p10/p50/p90 {np.round(np.nanpercentile(error[table], [10, 50, 90]), 1)} mm"
    )


def ring_centres(view: MirrorView) -> tuple[np.ndarray, np.ndarray]:
    """Expected bias of things 2 m away by exact rays: median and spread over each ring [mm]."""
    camera = camera_of_published_frame(view)
    rays = pixel_rays(camera).reshape(-1, 3)
    share = outline_share(camera, view, RADIUS).ravel()
    near = share < 1
    rays = rays[near] / np.linalg.norm(rays[near], axis=1, keepdims=True)
    centre = np.array([0.0, 0.0, PUBLISHED_HEIGHT - RADIUS])
    surface, seen = mirrored_stereo_depth(rays, centre, RADIUS, 2.0, PUBLISHED_BASELINE)
    ring = (share[near] * 5).astype(int)
    bias = 1e3 * (seen - surface)
    return np.array([np.nanmedian(bias[ring == k]) for k in range(5)]), np.array(
        [np.nanpercentile(bias[ring == k], [10, 90]) for k in range(5)]
    )


def main() -> None:
    """Print all tables; draw the published ball."""
    flat_mirrors()
    print(
        f"ball on a metal table, 0.93 m, f {PUBLISHED_FOCAL:.0f} px, B {1e3 * PUBLISHED_BASELINE:.1f} mm; "
        "real: filled 98 %, +17 mm"
    )
    view = ball_from_above(steel(0.02), RADIUS, PUBLISHED_HEIGHT, steel(0.2))
    exact, spread = ring_centres(view)
    print("  exact rays, things 2 m away: rings", np.round(exact, 1), "p10 and p90", np.round(spread, 1).tolist())
    figure, axes = panels(3, height=2.4)
    middle = (np.arange(5) + 0.5) / 5
    axes[2].fill_between(middle, *spread.T, color="0.9", label="exact rays, p10 to p90")
    axes[2].plot(middle, exact, c="0.5", label="exact rays, median")
    for radius, alpha, bias, image, error in published():
        print(f"  R {1e3 * radius:.1f} mm alpha {alpha:.2f}: {words(bias)}; {specks(image, error)}", flush=True)
        if radius == RADIUS and alpha == 0.02:
            show_grey(axes[0], image[90:330, 500:780], "steel ball on a metal table", 255)
            show_error(figure, axes[1], error[90:330, 500:780], "depth error", 40)
        if radius == RADIUS and alpha in (0.01, 0.03, 0.1):
            axes[2].plot(middle, bias.rings_mm, marker=".", label=f"rendered, alpha {alpha:g}")
    axes[2].plot([0.1, 0.9], [18, 12], "k+", label="real")
    axes[2].set(xlabel="distance from the middle / outline", ylabel="too far [mm]", ylim=(0, 45))
    axes[2].legend(fontsize=6)
    write(figure, "mirrors")
    five_radii()


if __name__ == "__main__":
    main()
