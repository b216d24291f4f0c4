"""Mount: one view of part D1 with the baseline horizontal and on end. `python -m docs.figures.mount`."""

import numpy as np

from docs.figures.drawing import panels, show_error, show_grey, write
from franbv.candidates import first_view
from franbv.parameters import Parameters
from render.d435i import SimulatedD435i
from render.sensor import SensorSettings
from render.world.rig import left_band
from render.world.truth import looks_at_part
from scenes.build import part_scene

ROLLS = {0.0: "baseline horizontal", 90.0: "on end"}
CHOICES = {
    "default": {},
    "preset high_accuracy": {"preset": "high_accuracy"},
    "roll 90": {"roll_deg": 90.0},
    "profile 640x480": {"profile": "640x480"},
    "D415": {"model": "d415"},
}
BAND_TINT = (110, 50, 0)
"""Laid over the left band [DN], red, green, blue."""
SPAN_MM = 20
"""Of the errors' colours [mm]."""


def main() -> None:
    """Print what each setting makes of the first view of part D1; draw both rolls, the world upright in both."""
    scene = part_scene("D1")
    for name, changed in CHOICES.items():
        camera = SimulatedD435i(scene, SensorSettings(crop=None, **changed))
        pose = first_view(Parameters(roll_deg=camera.settings.mount_roll_deg), 0.0)
        measured, truth = camera.measure(pose, 1), camera.truth(pose)
        part, depth = looks_at_part(truth, scene), measured.depths[0]
        missing = 100 * np.mean(depth[part] == 0)
        error = 1e3 * np.median(np.abs(depth - truth.depth)[part & (depth > 0)])
        print(
            f"{name}: Min-Z {1e3 * camera.min_z:.0f} mm, f B {camera.rig.focal_baseline:.2f} px m, part D1 on "
            f"{part.sum()} px, {missing:.1f} % of it without depth, median error {error:.1f} mm, "
            f"exposure {1e-3 * measured.imager.exposure_us:.1f} ms"
        )
    figure, axes = panels(4, width=8.4, height=2.6)
    grid = axes[0].get_gridspec()
    assert grid is not None
    grid.set_width_ratios([16, 16, 9, 9])  # 16:9 and 9:16 in one scale
    for roll, panel in zip(ROLLS, (axes[:2], axes[2:]), strict=True):
        camera = SimulatedD435i(scene, SensorSettings(crop=None))
        pose = first_view(Parameters(roll_deg=roll), 0.0)
        measured, truth = camera.measure(pose, 1), camera.truth(pose)
        depth, grey = measured.depths[0], np.dstack([measured.lefts[0]] * 3)
        band = left_band(camera.rig, truth.depth)
        grey[band] = grey[band] // 2 + np.array(BAND_TINT, np.uint8)
        error = np.where((depth > 0) & (truth.depth > 0), 1e3 * (depth - truth.depth), np.nan)
        show_grey(panel[0], upright(grey, roll), f"{ROLLS[roll]}: infrared")
        show_error(figure, panel[1], upright(error, roll), "depth error", SPAN_MM)
    write(figure, "mount")


def upright(image: np.ndarray, roll_deg: float) -> np.ndarray:
    """Every other pixel of the image, turned back so that what is up in the world is up in it."""
    return np.rot90(image, -round(roll_deg / 90))[::2, ::2]


if __name__ == "__main__":
    main()
