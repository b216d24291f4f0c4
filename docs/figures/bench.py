"""The paper's bench: its light on the plinth, what it costs, how it looks. `python -m docs.figures.bench`."""

import time

import numpy as np
from jaxtyping import Float32
from scipy.spatial.transform import RigidTransform

from docs.figures.drawing import panels, show_grey, write
from docs.figures.mount import upright
from franbv.candidates import candidate_poses, first_view
from franbv.frames import Intrinsics, look_at, rolled
from franbv.geometry.oriented_box import axis_aligned_box
from franbv.parameters import Parameters
from materials.lights import imager_radiance_per_luminance, white_led
from render.d435i import SensorSettings, SimulatedD435i
from render.light.radiance import render_layers
from render.light.sampling import Sampling
from scenes.build import BENCHES, part_scene
from scenes.lamps import form_integral
from scenes.scene import Scene

N_FRAMES = 15
"""Of a burst (paper)."""
ON_END = Parameters(roll_deg=90.0)
NORMALS = {"up": (0, 0, 1), "+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0)}
"""Of the faces of an object that are asked for their light."""
OVERVIEW = look_at(np.array([-0.67, -1.66, 1.05]), np.array([0.18, 0.12, 0.22]))
"""About where the authors' photograph of the whole bench was taken from."""
OVERVIEW_INTRINSICS = Intrinsics(465, 620, 900.0, 900.0, 232.0, 309.5)
LOW = rolled(look_at(np.array([-0.30, -0.25, 0.11]), np.array([0.0, 0.0, 0.06])), 90.0)


def main() -> None:
    """Print light and times; draw the bench."""
    scene = part_scene("D", bench="paper")
    print_light(scene)
    print_times({name: part_scene("D", bench=name) for name in BENCHES})
    camera = SimulatedD435i(scene, SensorSettings(crop=None))
    light = camera.projector_light(OVERVIEW)
    overview = render_layers(camera.world, light, OVERVIEW_INTRINSICS, OVERVIEW, Sampling()).ambient
    figure, axes = panels(3, width=7.6, height=3.2)
    show_grey(axes[0], as_seen(overview)[::2, ::2], "bench and hall", 1.0)
    for panel, pose, title in ((axes[1], first_view(ON_END, 0.0), "first view"), (axes[2], LOW, "from below the lamp")):
        show_grey(panel, upright(camera.measure(pose, 1).lefts[0], 90.0), f"infrared, {title}")
    write(figure, "bench")


def print_light(scene: Scene) -> None:
    """Direct light of each lamp on the plinth and on upright faces 10 cm above it, in lux as the imager counts it."""
    per_luminance = imager_radiance_per_luminance(white_led())
    for lamp in scene.lamps:
        points = {side: np.array([0.0, 0.0, 0.0 if side == "up" else 0.1]) for side in NORMALS}
        lux = {
            side: lamp.radiance * form_integral(lamp, points[side], np.array(normal, float)) / per_luminance
            for side, normal in NORMALS.items()
        }
        on_faces = ", ".join(f"{side} {value:.0f}" for side, value in lux.items())
        print(f"{lamp.name}: {lamp.radiance / per_luminance:.0f} cd/m^2; {on_faces} lx")


def print_times(scenes: dict[str, Scene]) -> None:
    """Processor time of a burst on each bench from the same poses, the first left out, which compiles."""
    box = axis_aligned_box(np.array([-0.1, -0.05, 0.0]), np.array([0.1, 0.05, 0.1]))
    poses = [first_view(ON_END, 0.0), *candidate_poses(box, ON_END, 0.3)[1::6]]
    cameras = {name: SimulatedD435i(scene, SensorSettings()) for name, scene in scenes.items()}
    spent = {name: np.array([burst_s(camera, pose) for pose in poses])[1:] for name, camera in cameras.items()}
    first, *others = spent
    for name in others:
        ratio = spent[name] / spent[first]
        print(f"burst, {name} over {first}: {np.median(ratio):.2f} ({ratio.min():.2f} to {ratio.max():.2f})")


def burst_s(camera: SimulatedD435i, pose: RigidTransform) -> float:
    """Processor time of a burst [s]."""
    start = time.process_time()
    camera.measure(pose, N_FRAMES)
    return time.process_time() - start


def as_seen(radiance: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """As a photograph shows it, 0 to 1: the brightest 3 % white, gamma 2.2."""
    return np.clip(radiance / np.percentile(radiance, 97), 0, 1) ** np.float32(1 / 2.2)


if __name__ == "__main__":
    main()
