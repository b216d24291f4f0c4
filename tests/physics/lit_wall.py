"""A matte wall in the dots of the projector and in the light of lamps, as the left imager sees it."""

from dataclasses import dataclass, replace

import numpy as np

from materials.material import Matte
from render.d435i import SensorSettings, SimulatedD435i
from render.imager.expose import expose_burst
from render.imager.exposure import auto_exposure
from render.imager.settings import ImagerSettings
from render.light.radiance import RadianceLayers
from scenes.lamps import form_integral, lighting
from tests.physics.simple_scenes import facing_x, lamp_at, wall

ALBEDO = 0.5
ROOM_LIGHT = "dim"
"""Lamps of the comparison with real dots: 200 lx, the least of EN 12464-1 for rooms in which people stay."""
DISTANCE = 0.44
"""Distance of the comparison [m]: that of the dots on the box in the real frame, from their disparity of 49 px."""


@dataclass(frozen=True, eq=False)
class LitWall:
    """The rendered wall, its lamp light scaled to 1 W/m^2 in the middle."""

    layers: RadianceLayers
    focal_px: float

    def image(self, irradiance: float, settings: ImagerSettings | None = None, seed: int = 1) -> np.ndarray:
        """Infrared image (h, w) [DN] under so much lamp light [W/m^2]; settings: None = auto-exposure."""
        ambient = self.layers.ambient * np.float32(irradiance)
        if settings is None:
            settings = auto_exposed(self.layers.projector, ambient)
        return expose_burst(self.layers.projector, ambient, settings, 1, seed)[0]

    def image_without_white(self, irradiance: float) -> np.ndarray:
        """The same at a third of the auto-exposure, dark enough that no dot is clipped."""
        chosen = auto_exposed(self.layers.projector, self.layers.ambient * np.float32(irradiance))
        return self.image(irradiance, chosen.model_copy(update={"exposure_us": chosen.exposure_us / 3}))


def auto_exposed(projector: np.ndarray, ambient: np.ndarray) -> ImagerSettings:
    """Default settings with the camera's own choice of exposure and gain."""
    exposure_us, gain = auto_exposure(projector, ambient, ImagerSettings())
    return ImagerSettings(exposure_us=exposure_us, gain=gain)


def lit_wall(distance: float, profile: str = "1280x720", dot_fwhm_px: float | None = None) -> LitWall:
    """Render the wall at `distance` [m]; dot_fwhm_px: see `SensorSettings`."""
    lamp = lamp_at([-1.0, 0.0, 1.0], [distance, 0, 0], 0.4, 1.0)
    geometry = form_integral(lamp, np.array([distance, 0.0, 0.0]), np.array([-1.0, 0.0, 0.0]))
    scene = wall(distance, Matte("wall", ALBEDO), (replace(lamp, radiance=1 / geometry),))
    camera = SimulatedD435i(scene, SensorSettings(profile=profile, crop=None, dot_fwhm_px=dot_fwhm_px))
    return LitWall(camera.render(facing_x())[0], camera.rig.intrinsics.fx)


def lamp_irradiance(preset: str) -> float:
    """What the lamps of a preset put on a surface that faces them [W/m^2, 850 nm-equivalent]."""
    up = np.array([0.0, 0.0, 1.0])
    return sum(lamp.radiance * form_integral(lamp, np.zeros(3), up) for lamp in lighting(preset).lamps)


def middle_of_field(shape: tuple[int, ...]) -> np.ndarray:
    """The middle of an image, well inside the projector's field, where vignetting takes at most a fifth."""
    h, w = shape
    region = np.zeros((h, w), bool)
    region[round(0.25 * h) : round(0.75 * h), round(0.35 * w) : round(0.65 * w)] = True
    return region
