"""How many camera rays a second this machine traces, from a small fixed scene: a steel ball on a table under a lamp."""

import math
import statistics
import sys
import time
from typing import Any

from render.world import backend

SIZE = 256
"""Width and height of the picture [px]. Choice: large enough to fill all threads."""
SAMPLES = 16
"""Rays per pixel. Choice: about 0.3 s a picture on two slow cores."""
MAX_DEPTH = 3
"""Ball, table, lamp: the bounces that the sensor's own images need."""


def camera_rays_per_second(n_renders: int = 3) -> float:
    """Median of `n_renders` pictures after a first one that compiles the kernels [1/s]. Paths have up to 2 bounces."""
    mi = backend.mitsuba()
    scene = mi.load_dict(_ball_on_a_table(mi))
    durations = []
    for seed in range(n_renders + 1):
        start = time.perf_counter()
        mean = float(mi.render(scene, spp=SAMPLES, seed=seed).numpy().mean())
        durations.append(time.perf_counter() - start)
        if not (math.isfinite(mean) and mean > 0):
            raise backend.BackendError(
                f"{mi.variant()}: a lit test scene renders as {mean}; reinstall mitsuba and drjit"
            )
    return SIZE * SIZE * SAMPLES / statistics.median(durations[1:])


def _ball_on_a_table(mi: Any) -> dict[str, Any]:
    """Mitsuba description; steel is austenitic stainless at 850 nm (Karlsson 1982)."""
    eye = [0.0, -0.4, 0.3]
    view = mi.ScalarTransform4f().look_at(origin=eye, target=[0.0, 0.0, 0.05], up=[0.0, 0.0, 1.0])
    film = {
        "type": "hdrfilm",
        "width": SIZE,
        "height": SIZE,
        "pixel_format": "luminance",
        "rfilter": {"type": "box"},
    }
    steel = {
        "type": "roughconductor",
        "distribution": "ggx",
        "alpha": 0.1,
        "eta": {"type": "spectrum", "value": 3.249},
        "k": {"type": "spectrum", "value": 4.905},
    }
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": MAX_DEPTH},
        "sensor": {"type": "perspective", "fov": 60.0, "to_world": view, "film": film},
        "lamp": {"type": "point", "position": eye, "intensity": {"type": "spectrum", "value": 1.0}},
        "table": {"type": "rectangle", "bsdf": {"type": "diffuse"}},
        "ball": {"type": "sphere", "center": [0.0, 0.0, 0.05], "radius": 0.05, "bsdf": steel},
    }


if __name__ == "__main__":
    # `franbv doctor` runs this as a process of its own: a broken backend aborts its process instead of raising.
    sys.stdout.write(f"{camera_rays_per_second():.6g}\n")
