"""Workshop lamps as rectangular emitters, set by the illuminance that they give on the table."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform, Rotation

from materials.input_error import InputError
from materials.lights import Band, imager_radiance_per_luminance, lamp_spectrum
from materials.suggestion import suggest
from scenes.scene import Lamp

QUADRATURE = 16
"""Midpoints per side of a lamp: the error is below 1e-4 for a 0.6 m panel 2 m away [-]."""
INDIRECT_SHARE = 0.3
"""Light from walls and ceiling per direct light, where no room is modelled [-] (choice: bright rooms, 0.2 to 0.5)."""


@dataclass(frozen=True)
class Lighting:
    """Lamps and the light that comes from everywhere else."""

    name: str
    lamps: tuple[Lamp, ...]
    ambient_radiance: float
    """Radiance of what lies beyond the modelled scene [W m^-2 sr^-1, 850 nm-equivalent]; unseen in a closed room."""
    band: Band = Band.PROJECTOR
    """What kind of light it is, all of it: walls that send it back are taken as white."""


@dataclass(frozen=True)
class _Preset:
    illuminance: float
    """Direct light on the table [lux]."""
    band: Band
    layout: Callable[[], tuple[Lamp, ...]]


def ceiling_panels() -> tuple[Lamp, ...]:
    """Four 0.6 x 0.6 m LED panels (the common ceiling grid), 1.95 m above the table, radiance 1."""
    down = Rotation.from_euler("x", 180, degrees=True)
    return tuple(
        Lamp(f"panel_{i}", RigidTransform.from_components([x, y, 1.95], down), 0.6, 0.6, 1.0)
        for i, (x, y) in enumerate(((-0.9, -0.7), (0.9, -0.7), (-0.9, 0.7), (0.9, 0.7)))
    )


def halogen_floods() -> tuple[Lamp, ...]:
    """Two 500 W floods with 0.19 x 0.14 m windows on stands, 1.4 m above the table, aimed at its centre, radiance 1."""
    return tuple(
        Lamp(f"flood_{i}", aimed(np.array([x, -0.9, 1.4])), 0.19, 0.14, 1.0) for i, x in enumerate((-1.1, 1.1))
    )


def aimed(position: Float[np.ndarray, "3"], target: Float[np.ndarray, "3"] | None = None) -> RigidTransform:
    """Pose at `position` whose +z looks at the target (the origin), x level; not for one straight above or below."""
    way = (np.zeros(3) if target is None else target) - position
    z = way / np.linalg.norm(way)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x = x / np.linalg.norm(x)
    return RigidTransform.from_components(position, Rotation.from_matrix(np.column_stack([x, np.cross(z, x), z])))


_PRESETS = {
    "off": _Preset(0.0, Band.WHITE_LED, lambda: ()),
    # 500 lx is EN 12464-1 for machining to fine tolerances; 200 and 1000 lx are steps of its scale below and above.
    "dim": _Preset(200.0, Band.WHITE_LED, ceiling_panels),
    "workshop": _Preset(500.0, Band.WHITE_LED, ceiling_panels),
    "bright": _Preset(1000.0, Band.WHITE_LED, ceiling_panels),
    "halogen": _Preset(500.0, Band.HALOGEN, halogen_floods),
}
LIGHTING_NAMES = tuple(_PRESETS)


def lighting(name: str) -> Lighting:
    """The preset: `off`, `dim` (200 lx), `workshop` (500 lx), `bright` (1000 lx), LED; `halogen` (500 lx)."""
    if name not in _PRESETS:
        raise InputError(f"lamps {name}: there is no such preset; {suggest(name, _PRESETS)}")
    preset = _PRESETS[name]
    return lighting_for(name, preset.layout(), preset.illuminance, preset.band)


def lighting_for(name: str, lamps: tuple[Lamp, ...], illuminance: float, band: Band) -> Lighting:
    """Lamps of equal radiance that light the middle of the table with `illuminance` [lux], indirect light left out.

    A Lambertian lamp of luminance L_v gives E_v = L_v G at the table, G = sum over lamps of
    integral cos(theta) cos(theta_lamp) / r^2 dA; so L_v = E_v / G, and the spectrum turns that luminance into the
    radiance at 850 nm that frees as many electrons (`materials.lights`). Where there is no light, its band is the
    projector's.
    """
    if not (np.isfinite(illuminance) and illuminance >= 0):
        raise InputError(f"lamps {name}: illuminance is {illuminance:g} lx; give a number from 0 up")
    if not lamps or illuminance == 0:
        return Lighting(name, (), 0.0)
    geometry = sum(form_integral(lamp, np.zeros(3), np.array([0.0, 0.0, 1.0])) for lamp in lamps)
    per_luminance = imager_radiance_per_luminance(lamp_spectrum(band))
    radiance = illuminance / geometry * per_luminance
    ambient = INDIRECT_SHARE * illuminance / np.pi * per_luminance
    return Lighting(name, tuple(replace(lamp, radiance=radiance) for lamp in lamps), ambient, band)


def form_integral(lamp: Lamp, point: Float[np.ndarray, "3"], normal: Float[np.ndarray, "3"]) -> float:
    """Irradiance at `point` with unit `normal` per radiance of the lamp [sr], by midpoint quadrature."""
    steps = (np.arange(QUADRATURE) + 0.5) / QUADRATURE - 0.5
    x, y = np.meshgrid(steps * lamp.width, steps * lamp.height)
    sources = lamp.T_world_lamp.apply(np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]))
    ray = point - sources
    distance = np.linalg.norm(ray, axis=1)
    facing = lamp.T_world_lamp.rotation.apply([0.0, 0.0, 1.0])
    leaving = np.maximum(ray @ facing, 0) / distance
    arriving = np.maximum(-(ray @ normal), 0) / distance
    return float(np.sum(leaving * arriving / distance**2) * lamp.width * lamp.height / QUADRATURE**2)
