"""Light transport: the two layers, further bounces, the projector's shadow. `python -m docs.figures.light`."""

import numpy as np

from docs.figures.drawing import panels, show_grey, write
from franbv.candidates import first_view
from franbv.parameters import Parameters
from materials.material import Matte
from render.d435i import SensorSettings, SimulatedD435i
from render.light.radiance import Sampling
from render.world.rig import PROJECTOR_OFFSET
from render.world.truth import looks_at_part
from scenes.build import part_scene
from scenes.scene import Body, Scene
from tests.physics.simple_scenes import facing_x, rectangle, wall

SETTINGS = SensorSettings(crop=None)
POST, WALL, HALF_WIDTH = 0.5, 1.0, 0.03
"""Distances of a post and of the wall behind it, half the post's width [m]."""
PART = np.s_[80:280, 190:450]
"""Where part D1 stands in the first view."""


def main() -> None:
    """Print what bounces add and where the shadow falls; draw part D1's layers and the shadow."""
    scene, pose = part_scene("D1"), first_view(Parameters(), 0.0)
    camera = SimulatedD435i(scene, SETTINGS)
    on_part = looks_at_part(camera.truth(pose), scene)
    left, right = camera.render(pose)
    once, _ = camera.stopped_at_first_surface(pose, left, right)
    for name in ("projector", "ambient"):
        whole, direct = (float(getattr(layer, name)[on_part].mean()) for layer in (left, once))
        print(
            f"part D1, {name}: {1e3 * whole:.2f} mW m^-2 sr^-1, "
            f"{100 * (1 - direct / whole):.0f} % by a second or third bounce"
        )

    face = rectangle([POST, 0, 0], [0, 0, 0], 2 * HALF_WIDTH, 4.0)
    post = Scene("post", (*wall(WALL).bodies, Body("post", face, Matte("post", 0.5), True)), (), 0.0)
    rig = camera.rig
    shadow = SimulatedD435i(post, SETTINGS, sampling=Sampling(max_depth=1)).render(facing_x())[0].projector
    edge = rig.intrinsics.cx - rig.intrinsics.fx * HALF_WIDTH / POST
    parallax = rig.intrinsics.fx * PROJECTOR_OFFSET * (1 / POST - 1 / WALL)
    dark = int(np.count_nonzero(shadow[:, round(edge) - 30 : round(edge)].max(axis=0) == 0))
    print(
        f"post at {POST} m before a wall at {WALL} m: shadow {parallax:.1f} px wide by closed form, "
        f"{dark} whole columns dark"
    )

    figure, axes = panels(3, height=2.3)
    show_grey(axes[0], left.projector[PART], "projector's layer", float(np.percentile(left.projector[PART], 99)))
    show_grey(axes[1], left.ambient[PART], "lamps' layer", float(np.percentile(left.ambient[PART], 99)))
    around = shadow[110:250, round(edge) - 60 : round(edge) + 100]
    show_grey(axes[2], around, "post before a wall, its shadow on the left", float(np.percentile(around, 98)))
    for place in (60 - parallax, 60):
        axes[2].axvline(place, c="tab:orange", lw=0.8)
    write(figure, "light")


if __name__ == "__main__":
    main()
