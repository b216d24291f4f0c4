"""Materials: a steel plate by roughness, and what the light of further bounces does to its holes.

`python -m docs.figures.materials` prints the table (five minutes).
"""

from dataclasses import dataclass
from unittest.mock import patch

import cv2
import numpy as np

from docs.figures.drawing import panels, show_grey, write
from franbv.frames import look_at
from materials.energy_compensation import albedo_table
from render.d435i import SensorSettings, SimulatedD435i
from scenes.build import coupon_scene
from scenes.coupons import plate_centre_height
from tests.physics.mirror_scenes import steel

ALPHAS = (0.03, 0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.6)
TILTS_DEG = (20, 45, 60)
AXES_DEG = (0, 90)
"""Two directions of tilt, so that the plate turns its back on different parts of the room."""
DISTANCE, SIZE = 0.35, 0.1
"""Of the plate's middle from the camera, and its side [m]."""
FRAMES = 2
BORDER_PX = 4
"""Left out around the plate's outline, where depth is lost on any material."""
ALWAYS, NEVER = 0.0, 2.0
"""Values of `render.world.reflectances.NEGLIGIBLE_LOSS` that give every metal the second lobe, or none."""
FALSE_MM = 5.0


@dataclass(frozen=True)
class Plate:
    """What one plate looks like."""

    holes: float
    false: float
    """Share of all its pixels with a depth more than 5 mm off."""
    grey: float
    image: np.ndarray
    """Around the plate (h, w) [DN]."""


def measure(alpha: float, tilt_deg: float, axis_deg: float, negligible_loss: float) -> Plate:
    """The plate from straight above, in the workshop's light."""
    with patch("render.world.reflectances.NEGLIGIBLE_LOSS", negligible_loss):
        scene = coupon_scene(
            "plate", steel(alpha), "workshop", tilt=np.radians(tilt_deg), axis=np.radians(axis_deg), size=SIZE
        )
        camera = SimulatedD435i(scene, SensorSettings(crop=None), seed=1)
    middle = np.array([0.0, 0.0, plate_centre_height(SIZE)])
    pose = look_at(np.array([0.0, 0.0, middle[2] + DISTANCE]), middle)
    frames, truth = camera.measure(pose, FRAMES), camera.truth(pose)
    seen = truth.body == 0
    inside = cv2.erode(seen.astype(np.uint8), np.ones((2 * BORDER_PX + 1,) * 2), borderValue=0) > 0
    depth, image = frames.depths[:, inside], frames.lefts[0]
    wrong = (depth > 0) & (np.abs(depth - truth.depth[inside]) > FALSE_MM / 1e3)
    around = (slice(120, 240), slice(260, 380))
    return Plate(float(np.mean(depth == 0)), float(np.mean(wrong)), float(image[inside].mean()), image[around])


def main() -> None:
    """Print hole share, false depth and brightness with and without the second lobe; draw both."""
    curves: dict[tuple[int, float], list[float]] = {}
    print("tilt alpha  lost   holes with  without   false with  without   grey with  without")
    for tilt in TILTS_DEG:
        for alpha in ALPHAS:
            pairs = [[measure(alpha, tilt, axis, switch) for axis in AXES_DEG] for switch in (ALWAYS, NEVER)]
            holes, false, grey = (
                [float(np.mean([getattr(plate, name) for plate in plates])) for plates in pairs]
                for name in ("holes", "false", "grey")
            )
            curves.setdefault((tilt, ALWAYS), []).append(holes[0])
            curves.setdefault((tilt, NEVER), []).append(holes[1])
            lost = 1 - albedo_table(alpha, alpha).mean
            print(
                f"{tilt:4d}  {alpha:.2f}  {100 * lost:4.1f} %  {100 * holes[0]:7.1f} % {100 * holes[1]:7.1f} %   "
                f"{100 * false[0]:7.1f} % {100 * false[1]:7.1f} %   {grey[0]:7.0f} {grey[1]:8.0f}",
                flush=True,
            )
    figure, axes = panels(5, height=2.2)
    for panel, alpha in zip(axes, (0.02, 0.07, 0.2, 0.5), strict=False):
        show_grey(panel, measure(alpha, 20, 0, ALWAYS).image, f"steel, alpha {alpha:g}", 200)
    colours: dict[int, str] = dict(zip(TILTS_DEG, ("tab:blue", "tab:orange", "tab:red"), strict=True))
    for (tilt, switch), shares in curves.items():
        line, label = ("-", f"{tilt} deg") if switch == ALWAYS else (":", None)
        axes[4].plot(ALPHAS, 100 * np.array(shares), c=colours[tilt], marker=".", ls=line, label=label)
    axes[4].set(xscale="log", xlabel="alpha [-]", ylabel="plate without depth [%]", title="dotted: one bounce only")
    axes[4].set_xticks((0.03, 0.1, 0.3), labels=("0.03", "0.1", "0.3"))
    axes[4].minorticks_off()
    axes[4].legend(title="tilt")
    write(figure, "materials")


if __name__ == "__main__":
    main()
