"""Mismatches between the real cell and the declared one: the chosen setting on the same draws, one thing changed.

Each changes a draw's scene or its camera; noise, poses and seeds stay those of the draw, so that a change shows by
itself.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.spatial.transform import RigidTransform

from materials.material import ALPHA_RANGE, Material, RoughConductor, RoughPlastic
from render.d435i import SensorSettings
from scenes.scene import Scene

SceneChange = Callable[[Scene], Scene]
SensorChange = Callable[[SensorSettings], SensorSettings]
OTHER_INDEX: dict[str, tuple[float, float, str]] = {
    "aluminium": (2.205, 7.188, "main/Al/McPeak"),
    "iron": (3.048, 3.782, "main/Fe/Ordal"),
    "chromium": (4.996, 4.541, "main/Cr/Sytchkova"),
    "nickel": (2.589, 4.621, "main/Ni/Ordal"),
    "copper": (0.475, 5.366, "main/Cu/Ordal"),
    "titanium": (2.570, 2.573, "main/Ti/Palm"),
    "gold": (0.416, 5.313, "main/Au/Hagemann"),
    "silver": (0.271, 5.982, "main/Ag/Hagemann"),
    "tungsten": (3.466, 2.821, "main/W/Ordal"),
}
"""n and k at 850 nm by other authors than the catalogue's, with their page in refractiveindex.info: of those that there
are, the one whose reflectance is farthest from ours. Stainless steel and brass have one author each."""
LAMP_SHIFT_M = 0.3
"""How far a lamp is moved [m]."""
NOISE_FACTOR, LASER_FACTORS, ALPHA_FACTORS = 2.0, (0.7, 1.3), (0.5, 1.5)
CALIBRATION_PX = 0.3
"""Rows that the right image lies too low after rectification."""
ROLL_DEG = 90.0
"""Turn of the camera in its mount, beside the declared one."""
DOT_WIDTHS_PX = (3.8, 6.0)
"""Of the projector's dots, beside the 4.8 px of the camera: the D415's in proportion, and as much wider."""


def _same(thing: Scene) -> Scene:
    return thing


@dataclass(frozen=True)
class Stress:
    """One mismatch."""

    words: str
    """For people."""
    scene: SceneChange = _same
    sensor: SensorChange = lambda sensor: sensor
    applies: Callable[[Scene], bool] = lambda scene: True
    """Whether it changes anything of a scene; a draw that it does not change says nothing of it."""


DECLARED = Stress("as declared")
"""No mismatch."""


def _noisier(sensor: SensorSettings) -> SensorSettings:
    """Twice the noise at the same brightness: shot noise by a quarter of the electrons, read noise in proportion."""
    imager, less = sensor.imager, NOISE_FACTOR**2
    changed = imager.model_copy(
        update={
            "full_well": imager.full_well / less,
            "quantum_efficiency": imager.quantum_efficiency / less,
            "read_noise": imager.read_noise * NOISE_FACTOR / less,
        }
    )
    return sensor.model_copy(update={"imager": changed})


def _laser(factor: float, sensor: SensorSettings) -> SensorSettings:
    power = sensor.imager.laser_power_mw * factor
    return sensor.model_copy(update={"imager": sensor.imager.model_copy(update={"laser_power_mw": power})})


def _sensor(sensor: SensorSettings, **changed: float) -> SensorSettings:
    return sensor.model_copy(update=changed)


def _turned(sensor: SensorSettings) -> SensorSettings:
    """Level instead of on end, and the other way round."""
    return _sensor(sensor, roll_deg=ROLL_DEG if sensor.mount_roll_deg == 0 else 0.0)


def _with_material(scene: Scene, change: Callable[[Material], Material]) -> Scene:
    bodies = (replace(b, material=change(b.material)) if b.is_part else b for b in scene.bodies)
    return replace(scene, bodies=tuple(bodies))


def _rougher(factor: float, material: Material) -> Material:
    if isinstance(material, RoughConductor):
        return replace(material, alpha_u=_alpha(material.alpha_u * factor), alpha_v=_alpha(material.alpha_v * factor))
    if isinstance(material, RoughPlastic):
        return replace(material, alpha=_alpha(material.alpha * factor))
    return material


def _alpha(value: float) -> float:
    """Within what the renderer takes."""
    return float(np.clip(value, *ALPHA_RANGE))


def metal_of(material: Material) -> str:
    """The metal in a material's name."""
    return material.name.partition(":")[0]


def _other_index(material: Material) -> Material:
    if isinstance(material, RoughConductor) and metal_of(material) in OTHER_INDEX:
        n, k, _ = OTHER_INDEX[metal_of(material)]
        return replace(material, n=n, k=k)
    return material


def _has_other_index(scene: Scene) -> bool:
    metals = [b.material for b in scene.bodies if b.is_part and isinstance(b.material, RoughConductor)]
    return any(metal_of(material) in OTHER_INDEX for material in metals)


def _lamp_moved(scene: Scene) -> Scene:
    """The first lamp, along the world's x axis."""
    first, *others = scene.lamps
    shift = RigidTransform.from_translation([LAMP_SHIFT_M, 0.0, 0.0])
    return replace(scene, lamps=(replace(first, T_world_lamp=shift * first.T_world_lamp), *others))


def _scaled(factor: float, scene: Scene) -> Scene:
    return _with_material(scene, partial(_rougher, factor))


STRESSES: dict[str, Stress] = {
    "noise_x2": Stress("twice the imagers' noise", sensor=_noisier),
    "laser_70": Stress("laser 30 % weaker", sensor=partial(_laser, LASER_FACTORS[0])),
    "laser_130": Stress("laser 30 % stronger", sensor=partial(_laser, LASER_FACTORS[1])),
    "alpha_50": Stress("half the roughness", scene=partial(_scaled, ALPHA_FACTORS[0])),
    "alpha_150": Stress("half as rough again", scene=partial(_scaled, ALPHA_FACTORS[1])),
    "other_index": Stress(
        "n and k of other authors",
        scene=lambda scene: _with_material(scene, _other_index),
        applies=_has_other_index,
    ),
    "calibration": Stress(
        "rectification off by 0.3 px", sensor=lambda sensor: _sensor(sensor, row_misalignment_px=CALIBRATION_PX)
    ),
    "roll": Stress("camera turned by 90 deg in its mount", sensor=_turned),
    "lamp_moved": Stress("lamp moved by 0.3 m", scene=_lamp_moved, applies=lambda scene: bool(scene.lamps)),
    "dots_narrow": Stress("dots a fifth narrower", sensor=lambda s: _sensor(s, dot_fwhm_px=DOT_WIDTHS_PX[0])),
    "dots_wide": Stress("dots a quarter wider", sensor=lambda s: _sensor(s, dot_fwhm_px=DOT_WIDTHS_PX[1])),
}
"""By the name under which their draws are kept."""


def stress_of(name: str) -> Stress:
    """By its name; an empty one is no mismatch."""
    return STRESSES[name] if name else DECLARED
