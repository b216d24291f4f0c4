"""Depth coding and decimation: what 8 x 8 blocks make of holes. `python -m docs.figures.coding`."""

import numpy as np

from docs.figures.drawing import panels, show_error, write
from franbv.candidates import first_view
from franbv.parameters import Parameters
from render.d435i import SensorSettings, SimulatedD435i
from render.world.truth import looks_at_part
from scenes.build import part_scene

FRAMES = 5
FALSE_M = 0.005
"""Depth error that counts as false [m]."""


def main() -> None:
    """Print the shares of holes and false depth on part D1 by factor of decimation; draw both depth images."""
    scene, pose = part_scene("D1"), first_view(Parameters(), 0.0)
    camera = SimulatedD435i(scene, SensorSettings(crop=None))
    truth = camera.truth(pose)
    on_part = looks_at_part(truth, scene)
    burst, layers = {}, camera.render(pose)
    print("part D1, first view: share of the part without depth, and of its depth more than 5 mm off")
    for factor in (1, 2, 4, 8):
        reduced = SimulatedD435i(scene, SensorSettings(crop=None, decimation=factor))
        depth = reduced.expose(pose, *layers, FRAMES).burst.depths
        h, w = depth.shape[1:]
        # A block belongs to the part if all of it does; its true depth is the mean.
        part, true = (
            image[: h * factor, : w * factor].reshape(h, factor, w, factor) for image in (on_part, truth.depth)
        )
        whole, true = part.all(axis=(1, 3)), true.mean(axis=(1, 3))
        valid = depth[:, whole] > 0
        wrong = valid & (np.abs(depth[:, whole] - true[whole]) > FALSE_M)
        print(
            f"  factor {factor}: {100 * np.mean(~valid):.1f} %, {100 * wrong.sum() / valid.sum():.1f} % "
            f"of {whole.sum()} px"
        )
        burst[factor] = np.where(depth[0] > 0, 1e3 * (depth[0] - true), np.nan)
    figure, axes = panels(2, height=2.7)
    for panel, factor in zip(axes, (1, 8), strict=True):
        h, w = burst[factor].shape
        rows, columns = slice(h // 5, 4 * h // 5), slice(w // 4, 3 * w // 4)
        show_error(figure, panel, burst[factor][rows, columns], f"depth error, decimated by {factor}", 20)
    write(figure, "coding")


if __name__ == "__main__":
    main()
