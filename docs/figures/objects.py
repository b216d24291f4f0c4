"""The paper's objects on its bench, under its lamps. `python -m docs.figures.objects`."""

import numpy as np

from docs.figures.bench import as_seen
from docs.figures.drawing import panels, show_grey, write
from franbv.frames import Intrinsics, look_at
from render.d435i import SimulatedD435i
from render.light.radiance import render_layers
from render.light.sampling import Sampling
from scenes.build import part_scene
from scenes.parts import EXTRA_PARTS, PART_NAMES, part_description

SIDE_PX = 240
INTRINSICS = Intrinsics(SIDE_PX, SIDE_PX, 420.0, 420.0, (SIDE_PX - 1) / 2, (SIDE_PX - 1) / 2)
"""Of a narrower lens than the camera's: photographs of small things are taken with one."""
POSE = look_at(np.array([-0.30, -0.62, 0.34]), np.array([0.0, 0.0, 0.105]))
"""From the side that the lamp does not stand on, a little above the plinth, as the authors' photographs are."""


def main() -> None:
    """Draw all eight."""
    figure, axes = panels(4, rows=2, width=7.8, height=4.3)
    for panel, part in zip(axes, (*PART_NAMES, *EXTRA_PARTS), strict=True):
        camera = SimulatedD435i(part_scene(part, bench="paper"))
        light = camera.projector_light(POSE)
        seen = render_layers(camera.world, light, INTRINSICS, POSE, Sampling()).ambient
        show_grey(panel, as_seen(seen), f"{part}: {part_description(part)}", 1.0)
    write(figure, "objects")


if __name__ == "__main__":
    main()
