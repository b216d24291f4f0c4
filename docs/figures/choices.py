"""What the choices move: holes, false depth and labels when one number is another. `python -m docs.figures.choices`."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from types import ModuleType

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.candidates import first_view
from franbv.frames import look_at
from franbv.parameters import Parameters
from materials.catalog import TWIN_REFLECTANCE, material
from materials.material import Material, Matte
from render.d435i import SensorSettings, SimulatedD435i
from render.imager.settings import ImagerSettings
from render.labels import outcome
from render.labels.causes import is_hole, is_of
from render.labels.labels import label_frame
from render.labels.twin import measure_twin
from render.light import pattern
from render.light.radiance import RadianceLayers
from render.world.truth import looks_at_part
from scenes.build import coupon_scene, part_scene
from scenes.coupons import plate_centre_height
from scenes.lamps import INDIRECT_SHARE
from scenes.scene import Scene

FRAMES = 5
STEEL, GROUND = material("stainless_austenitic:polished"), material("stainless_austenitic:ground")
PLATE_TILT = np.radians(20.0)


@dataclass(frozen=True, eq=False)
class View:
    """A scene from one pose; its light is rendered once for all choices that come after it."""

    name: str
    scene: Scene
    pose: RigidTransform

    @cached_property
    def layers(self) -> tuple[RadianceLayers, RadianceLayers]:
        """With all choices as they are."""
        return SimulatedD435i(self.scene, SensorSettings(crop=None)).render(self.pose)


@dataclass(frozen=True)
class Choice:
    """One number and what it is changed to."""

    name: str
    imager: dict[str, float] = field(default_factory=dict)
    """Settings of the imager."""
    twin: float = TWIN_REFLECTANCE
    """Albedo of the matte twin."""
    indirect: float = INDIRECT_SHARE
    """Light from walls where no room is modelled, per direct light."""
    seed: int = 0
    """Of noise and speckle."""
    constant: Callable[[], AbstractContextManager[None]] = nullcontext
    """Within which a constant of a module is another one: those that no argument reaches."""
    renders: bool = False
    """Light has to be rendered again."""


@contextmanager
def constant(module: ModuleType, name: str, value: float) -> Iterator[None]:
    """Let a module's constant be another one for as long as this lasts, patterns that were drawn with it included."""
    usual = getattr(module, name)
    pattern.dot_pattern.cache_clear()
    setattr(module, name, value)
    try:
        yield
    finally:
        setattr(module, name, usual)
        pattern.dot_pattern.cache_clear()


def choices() -> list[Choice]:
    """As they are, then one changed at a time."""

    def of_imager(name: str, *values: float) -> list[Choice]:
        usual = ImagerSettings.model_fields[name].default
        return [Choice(f"`{name}` {value:g}, not {usual:g}", imager={name: value}) for value in values]

    def of_module(module: ModuleType, name: str, *values: float, renders: bool) -> list[Choice]:
        usual = getattr(module, name)
        return [
            Choice(f"`{name}` {v:g}, not {usual:g}", constant=partial(constant, module, name, v), renders=renders)
            for v in values
        ]

    return [
        Choice("as they are"),
        *(Choice(f"other noise, seed {seed}", seed=seed) for seed in (1, 2)),
        *(Choice(f"`TWIN_REFLECTANCE` {v:g}, not {TWIN_REFLECTANCE:g}", twin=v) for v in (0.3, 0.6, 0.8)),
        *of_module(pattern, "BACKGROUND_SHARE", 0.1, 0.3, renders=True),
        *of_module(pattern, "BRIGHTNESS_SPREAD", 0.0, 0.3, renders=True),
        *of_imager("laser_modes", 5.0, 20.0),
        *of_imager("full_well", 4000.0, 8000.0),
        *of_imager("lens_sigma_um", 1.5, 3.0),
        *of_module(outcome, "SUBPIXEL_RMS", 0.05, renders=False),
        *(Choice(f"`INDIRECT_SHARE` {v:g}, not {INDIRECT_SHARE:g}", indirect=v, renders=True) for v in (0.2, 0.5)),
    ]


def views() -> list[View]:
    """Parts A1 and D1 in a room; a plate without one, so that the light from walls is a number."""
    first = first_view(Parameters(), 0.0)
    cuboid = part_scene("A1").with_materials(lambda body: STEEL if body.is_part else body.material)
    plate = coupon_scene("plate", GROUND, room=False, tilt=PLATE_TILT, size=0.15)
    middle = np.array([0.0, 0.0, plate_centre_height(0.15)])
    turn = np.radians(55.0)
    eye = middle + 0.4 * np.array([np.cos(turn), 0.0, np.sin(turn)])
    return [
        View("A1, polished steel", cuboid, first),
        View("D1, own materials", part_scene("D1"), first),
        View("plate, ground steel, no room", plate, look_at(eye, middle)),
    ]


def shares(view: View, choice: Choice) -> tuple[float, float, float]:
    """On the part: without depth and with false depth, of all pixels; reflection's, of the holes [%]."""
    with choice.constant():
        lit = replace(view.scene, ambient_radiance=view.scene.ambient_radiance * choice.indirect / INDIRECT_SHARE)
        settings = SensorSettings(crop=None, imager=ImagerSettings.model_validate(choice.imager))
        camera = SimulatedD435i(lit, settings, choice.seed)
        layers = camera.render(view.pose) if choice.renders else view.layers
        measurement, truth = camera.expose(view.pose, *layers, FRAMES), camera.truth(view.pose)
        grey = camera.changed(scene=lit.with_materials(lambda body: _matte(body.material, choice.twin)))
        twin = measure_twin(camera, view.pose, FRAMES, truth, grey)
        labels = label_frame(camera, view.pose, measurement, twin, truth)
    part = looks_at_part(truth, lit)
    holes = is_hole(labels.cause) & part
    of_reflection = is_of(labels.cause, "reflection") & part
    n, n_holes, n_false, n_reflection = (
        int(np.count_nonzero(mask)) for mask in (part, holes, labels.false_depth & part, of_reflection)
    )
    return 100 * n_holes / n, 100 * n_false / n, 100 * n_reflection / max(n_holes, 1)


def _matte(what: Material, albedo: float) -> Matte:
    """`materials.catalog.matte_twin` of another albedo."""
    return what if isinstance(what, Matte) else Matte("matte_twin", albedo)


def main() -> None:
    """Print the table, a row as soon as it is there."""
    seen = views()
    print("| choice | " + " | ".join(view.name for view in seen) + " |\n" + "|---" * (len(seen) + 1) + "|")
    usual: list[tuple[float, float, float]] = []
    for choice in choices():
        # Light from walls is no number where the room is modelled.
        open_only = choice.indirect != INDIRECT_SHARE
        row = [None if open_only and view.scene.ambient_radiance == 0 else shares(view, choice) for view in seen]
        cells = []
        for number, found in enumerate(row):
            if found is None:
                cells.append("")
            elif not usual:
                cells.append(" / ".join(f"{share:.1f}" for share in found) + " %")
            else:
                cells.append(" / ".join(f"{a - b:+.1f}" for a, b in zip(found, usual[number], strict=True)))
        usual = usual or [found for found in row if found]
        print(f"| {choice.name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
