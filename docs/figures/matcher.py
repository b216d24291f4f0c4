"""Matcher: the holes of the D4-like one beside OpenCV's on the same pair. `python -m docs.figures.matcher`."""

import numpy as np

from docs.figures.drawing import panels, show_error, show_grey, write
from franbv.candidates import first_view
from franbv.parameters import Parameters
from render.d435i import SensorSettings, SimulatedD435i
from render.depth.coding import metres_from_z16, z16_from_disparity
from render.matcher.d4.matcher import D4Matcher
from render.matcher.sgbm import SgbmMatcher
from render.world.truth import looks_at_part
from scenes.build import part_scene

AROUND = np.s_[90:290, 220:420]
"""Where part D1 stands in the first view."""


def main() -> None:
    """Print the share of part D1 without depth by matcher; draw both depth errors."""
    scene, pose = part_scene("D1"), first_view(Parameters(), 0.0)
    settings = SensorSettings(crop=None)
    camera = SimulatedD435i(scene, settings)
    measured, truth = camera.measure(pose, 1), camera.truth(pose)
    on_part = looks_at_part(truth, scene)
    figure, axes = panels(3, width=7.6, height=2.1)
    show_grey(axes[0], measured.lefts[0][AROUND], "left infrared image")
    for panel, (name, matcher) in zip(axes[1:], {"D4-like": D4Matcher(), "SGBM": SgbmMatcher()}.items(), strict=True):
        disparity = matcher.match(measured.lefts[0], measured.rights[0])
        coded = z16_from_disparity(disparity, camera.rig.focal_baseline, settings.depth)
        depth = metres_from_z16(coded, settings.depth)
        print(f"{name}: {100 * np.mean(depth[on_part] == 0):.1f} % of part D1 without depth, first view")
        error = np.where((depth > 0) & (truth.depth > 0), 1e3 * (depth - truth.depth), np.nan)
        show_error(figure, panel, error[AROUND], f"{name}: depth error", 20)
    write(figure, "matcher")


if __name__ == "__main__":
    main()
