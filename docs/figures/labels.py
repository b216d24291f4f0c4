"""Labels: why each pixel has no depth, and what the matte twin shows there. `python -m docs.figures.labels`."""

import numpy as np
from matplotlib.patches import Patch

from docs.figures.drawing import panels, show_grey, write
from franbv.candidates import first_view
from franbv.parameters import Parameters
from materials.catalog import material
from render.d435i import SensorSettings, SimulatedD435i
from render.labels.causes import LEGEND, is_hole, is_of
from render.labels.labels import label_frame
from render.labels.twin import measure_twin
from render.world.truth import looks_at_part
from scenes.build import part_scene
from scenes.parts import EARLIER_PARTS

FRAMES = 5
PART = np.s_[60:300, 170:470]


def main() -> None:
    """Print the share of each cause on part D1 and around it; draw the label map."""
    scene, pose = part_scene("D1"), first_view(Parameters(), 0.0)
    camera = SimulatedD435i(scene, SensorSettings(crop=None))
    measurement, truth = camera.measure(pose, FRAMES), camera.truth(pose)
    picture = label_frame(camera, pose, measurement, truth=truth).picture
    on_part = looks_at_part(truth, scene)
    print("share of the pixels: on part D1, elsewhere")
    shown = []
    for cause, entry in LEGEND.items():
        shares = [float(np.mean(picture[pixels] == cause)) for pixels in (on_part, ~on_part)]
        if max(shares) > 0:
            print(f"  {entry.name:28s} {100 * shares[0]:5.1f} % {100 * shares[1]:5.1f} %")
            shown.append(Patch(color="#" + bytes(entry.colour).hex(), label=entry.name))
    colours = np.zeros((256, 3), np.uint8)
    for cause, entry in LEGEND.items():
        colours[cause] = entry.colour
    figure, axes = panels(3, height=2.3)
    show_grey(axes[0], measurement.lefts[0][PART], "infrared image")
    axes[1].imshow(colours[picture[PART]])
    axes[1].set_title("labels")
    for panel in axes[1:]:
        panel.set_axis_off()
    axes[2].legend(handles=shown, loc="center left", fontsize=6)
    write(figure, "labels")
    print_holes_by_twin()


def print_holes_by_twin() -> None:
    """Print, of the holes on each part, which are reflection's, and of how many the twin's depth is false."""
    pose, steel = first_view(Parameters(), 0.0), material("stainless_austenitic:polished")
    print("first view, holes on the part: reflection, twin's depth false, unexplained")
    for part, material_of_part in ((part, m) for m in (None, steel) for part in EARLIER_PARTS):
        scene = part_scene(part)
        if material_of_part:
            scene = scene.with_materials(lambda body, m=material_of_part: m if body.is_part else body.material)
        camera = SimulatedD435i(scene, SensorSettings(crop=None))
        truth = camera.truth(pose)
        twin = measure_twin(camera, pose, FRAMES, truth)
        cause = label_frame(camera, pose, camera.measure(pose, FRAMES), twin, truth).cause
        holes = is_hole(cause) & looks_at_part(truth, scene)
        kinds = is_of(cause, "reflection"), twin.outcome.is_false, is_of(cause, "unexplained")
        shares = "  ".join(f"{100 * float(np.mean(kind[holes])):5.1f} %" for kind in kinds)
        name = material_of_part.name if material_of_part else "own"
        print(f"  {part}, {name}: {np.count_nonzero(holes):5d}: {shares}")


if __name__ == "__main__":
    main()
