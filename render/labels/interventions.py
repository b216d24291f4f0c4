"""Measure a pose again with one thing changed: dots in shadows, another exposure, one surface only, strong dots.

Noise and speckle stay those of the measurement, and so do exposure and gain unless they are the question or dots are
added to darkness: nothing but the light differs. These leave the metal in place, which gives false depth by itself: a
pixel has come back only when it is matched rightly. Only the pixels that are asked for, at least one, are matched
again with what lies between them; of others nothing is said.
"""

import numpy as np
from jaxtyping import Bool, Float32

from render.d435i import Measurement, SimulatedD435i
from render.imager.settings import REFERENCE_LASER_POWER_MW
from render.labels.infrared import looks_different
from render.labels.outcome import is_matched_rightly
from render.light.radiance import RadianceLayers
from render.world.surface import SurfaceMap
from render.world.truth import Truth

FULL_STRENGTH_AT = 0.3
"""Dots are as strong as they are meant to be at this distance [m] (D435i: nearest of its ideal range, 0.3 to 3 m)."""


def matched_without_shadows(
    camera: SimulatedD435i, measurement: Measurement, truth: Truth, pixels: Bool[np.ndarray, "h w"]
) -> Bool[np.ndarray, "h w"]:
    """Which pixels are matched rightly when nothing stands in the way of the dots to Lambertian surfaces."""
    lit, pose = camera.changed(imager=measurement.imager), measurement.T_world_cam
    left, right = (
        RadianceLayers(layers.projector + missing, layers.ambient)
        for layers, missing in zip(
            (measurement.left_layers, measurement.right_layers), camera.dots_in_shadow(pose), strict=True
        )
    )
    again = lit.expose(pose, left, right, len(measurement.z16), pixels)
    return pixels & is_matched_rightly(lit, again, truth)


def matched_when_exposed_for(
    camera: SimulatedD435i, measurement: Measurement, truth: Truth, pixels: Bool[np.ndarray, "h w"]
) -> Bool[np.ndarray, "h w"]:
    """Which pixels are matched rightly when exposure and gain are such that they are as bright as an image should be on
    average."""
    left, right = measurement.left_layers, measurement.right_layers
    other = camera.changed(imager=camera.auto_exposed(measurement.T_world_cam, left, measurement.imager, pixels))
    again = other.expose(measurement.T_world_cam, left, right, len(measurement.z16), pixels)
    return pixels & is_matched_rightly(other, again, truth)


def matched_at_first_surface(
    camera: SimulatedD435i, measurement: Measurement, truth: Truth, pixels: Bool[np.ndarray, "h w"]
) -> Bool[np.ndarray, "h w"]:
    """Which pixels are matched rightly when paths stop at the first surface: no mirror images, no mutual light.

    Only where that changes the images at all: a highlight that stays white may be matched otherwise by chance.
    """
    direct, pose = camera.changed(imager=measurement.imager), measurement.T_world_cam
    layers = camera.stopped_at_first_surface(pose, measurement.left_layers, measurement.right_layers)
    again = direct.expose(pose, *layers, len(measurement.z16), pixels)
    return pixels & is_matched_rightly(direct, again, truth) & looks_different(measurement, again, truth, camera.rig)


def matched_with_strong_dots(
    camera: SimulatedD435i, measurement: Measurement, truth: Truth, right: SurfaceMap, pixels: Bool[np.ndarray, "h w"]
) -> Bool[np.ndarray, "h w"]:
    """Which pixels are matched rightly when distance takes nothing from the dots and the laser has its default power.

    The law of inverse squares is undone in the rendered layers. A camera that chooses its exposure chooses it anew:
    the one for darkness would drown the dots. right: what the right imager's pixels see.
    """
    pose = measurement.T_world_cam
    power = max(measurement.imager.laser_power_mw, REFERENCE_LASER_POWER_MW)
    imager = measurement.imager.model_copy(update={"laser_power_mw": power})
    to_right = camera.rig.right_imager(pose).inv()
    right_depth = to_right.apply(right.position.reshape(-1, 3).astype(float))[:, 2].reshape(truth.depth.shape)
    left_layers = _strengthened(measurement.left_layers, truth.depth)
    right_layers = _strengthened(measurement.right_layers, right_depth.astype(np.float32))
    if camera.settings.auto_exposure:
        imager = camera.auto_exposed(pose, left_layers, imager)
    strong = camera.changed(imager=imager)
    again = strong.expose(pose, left_layers, right_layers, len(measurement.z16), pixels)
    return pixels & is_matched_rightly(strong, again, truth)


def _strengthened(layers: RadianceLayers, depth: Float32[np.ndarray, "h w"]) -> RadianceLayers:
    """The layers with dots as on a surface at FULL_STRENGTH_AT; nearer ones stay. depth: [m]."""
    gain = np.maximum(depth / np.float32(FULL_STRENGTH_AT), np.float32(1)) ** 2
    return RadianceLayers(layers.projector * gain, layers.ambient)
