"""How far the default sample counts are from 1024 independent paths a pixel, and how far two such references are apart.

Around part D1 only, the part with most metal: elsewhere pixels see matte surfaces, whose error is far smaller.
"""

import cv2
import numpy as np
import pytest

from franbv.candidates import first_view
from franbv.parameters import Parameters
from render.d435i import SimulatedD435i
from render.imager.exposure import mean_electrons, mean_grey
from render.imager.settings import WHITE_LEVEL
from render.light.radiance import RadianceLayers, render_layers
from render.light.sampling import Sampling
from render.matcher.interface import Window
from render.world.truth import looks_at_part
from scenes.build import part_scene
from tests.benchmarks.stopwatch import Stopwatch

pytestmark = pytest.mark.benchmark

REFERENCE_PATHS = 1024
N_FRAMES = 15
MARGIN_PX = 12
"""Around the part; as far as its mirror images and shadows reach the matcher's support."""


def test_default_sampling_against_reference(stopwatch: Stopwatch):
    """Prints grey-value errors and the agreement of the hole maps (share of frames without depth >= 0.5)."""
    scene, pose = part_scene("D1"), first_view(Parameters(), 0.0)
    camera = SimulatedD435i(scene)
    truth = camera.truth(pose)
    part = looks_at_part(truth, scene)
    near = cv2.dilate(part.astype(np.uint8), np.ones((2 * MARGIN_PX + 1,) * 2)) > 0
    default = camera.render(pose)
    shift = camera.rig.focal_baseline / truth.depth[part]
    boxes = box_around(near, (0, 0)), box_around(near, (shift.max(), shift.min()))
    first, second = (reference(camera, pose, default, boxes, seed) for seed in (0, 1))

    def holes(layers):
        return np.mean(camera.expose(pose, *layers, N_FRAMES).z16 == 0, axis=0) >= 0.5

    imager = camera.expose(pose, *first, 1).imager
    grey = [mean_grey(sum(mean_electrons(a.projector, a.ambient, imager)), imager) for a, _ in (default, first, second)]
    measurable = near & (grey[1] < WHITE_LEVEL)
    for name, other, layers in (("default sampling", grey[0], default), ("a second reference", grey[2], second)):
        error = np.abs(other - grey[1])[measurable]
        a, b = holes(first)[near], holes(layers)[near]
        stopwatch.note(
            f"{name} against {REFERENCE_PATHS} paths a pixel around part D1: median error {np.median(error):.2f} DN, "
            f"90th percentile {np.percentile(error, 90):.2f} DN; hole maps IoU {np.sum(a & b) / np.sum(a | b):.3f}"
        )


def box_around(mask: np.ndarray, shifts: tuple[float, float]) -> Window:
    """Bounding box of a mask of the left image, moved left by up to and at least these disparities [px]."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    left, right = max(int(columns[0] - shifts[0]), 0), min(int(columns[-1] - shifts[1]) + 1, mask.shape[1])
    return Window(left, int(rows[0]), right - left, int(rows[-1] - rows[0]) + 1)


def reference(camera: SimulatedD435i, pose, default, boxes: tuple[Window, Window], seed: int) -> list[RadianceLayers]:
    """Both imagers' layers with independent whole paths at every pixel of the boxes."""
    light, sampling, layers = camera.projector_light(pose), Sampling().reference(REFERENCE_PATHS), []
    for T, box, around in zip((pose, camera.rig.right_imager(pose)), boxes, default, strict=True):
        window = camera.rig.intrinsics.cropped(box.left, box.top, box.width, box.height)
        inside = render_layers(camera.world, light, window, T, sampling, seed)
        pasted = RadianceLayers(around.projector.copy(), around.ambient.copy())
        pasted.projector[box.slices], pasted.ambient[box.slices] = inside.projector, inside.ambient
        layers.append(pasted)
    return layers
