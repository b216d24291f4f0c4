"""A scene's draw, drawn again from the configuration: the same choices, and the bodies that follow from them."""

from collections.abc import Iterator, Sequence
from threading import Lock
from typing import Any

from studies.dataset.config import DatasetConfig
from studies.dataset.draw.built_scene import BuiltScene, build_scene, sensor_settings
from studies.dataset.draw.draw import SceneDraw, draw_scene
from studies.dataset.draw.objects import PoolObject

Pool = Sequence[PoolObject]
DRAW_ERROR = 1e-6
"""Of drawn numbers [m, deg, mW...], by the arithmetic of another processor."""
_DRAWING = Lock()
"""Objects compute their stable poses once, when they are first drawn."""


def drawn_again(config: DatasetConfig, pool: Pool, scene: int) -> tuple[SceneDraw, BuiltScene]:
    """What the scene must be."""
    with _DRAWING:
        draw = draw_scene(config, pool, scene)
        return draw, build_scene(draw, pool, config.materials.of_user)


def draw_faults(scene: dict[str, Any], config: DatasetConfig, again: SceneDraw, built: BuiltScene) -> Iterator[str]:
    """Where `scene.json` is not what follows from the draw."""
    bodies = [
        {"name": body.name, "material": body.material.name, "object": owner}
        for body, owner in zip(built.scene.bodies, built.owner, strict=True)
    ]
    for name, wanted in (("draw", again.model_dump(mode="json")), ("bodies", bodies)):
        if what := difference(scene[name], wanted, name):
            yield what
    if again.exposure_us is not None:
        imager = sensor_settings(config, again).imager
        fixed = {"exposure_us": imager.exposure_us, "gain": imager.gain}
        if what := difference(scene["exposures"], [fixed] * len(again.views), "exposures"):
            yield what


def difference(stated: Any, wanted: Any, place: str) -> str | None:
    """The first place at which two JSON values differ; numbers may by DRAW_ERROR."""
    if isinstance(wanted, dict) and isinstance(stated, dict):
        if stated.keys() != wanted.keys():
            return f"{place} has the entries {', '.join(map(str, stated))}, not {', '.join(map(str, wanted))}".lstrip()
        pairs = [(f"{place}.{key}".lstrip("."), stated[key], wanted[key]) for key in wanted]
    elif isinstance(wanted, list) and isinstance(stated, list):
        if len(stated) != len(wanted):
            return f"{place} has {len(stated)} entries, not {len(wanted)}"
        pairs = [(f"{place}[{k}]", *both) for k, both in enumerate(zip(stated, wanted, strict=True))]
    else:
        return None if _same(stated, wanted) else f"{place} is {stated!r}, not {wanted!r}"
    return next((found for name, a, b in pairs if (found := difference(a, b, name))), None)


def _same(stated: Any, wanted: Any) -> bool:
    if type(stated) is float and type(wanted) is float:
        return abs(stated - wanted) <= DRAW_ERROR
    return type(stated) is type(wanted) and stated == wanted
