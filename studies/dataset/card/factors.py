"""The declared factors of a dataset: how often each level occurs, beside how often it was declared to."""

import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from materials.catalog import finish_names
from materials.finishes import FINISHES
from studies.dataset.config import Materials
from studies.dataset.draw.draw import ClutterDraw, ObjectDraw
from studies.dataset.format.finished_scenes import Gathered

BINS = 8
"""Of the histogram of a range (choice)."""


@dataclass(frozen=True)
class Factor:
    """How often each level of something that was declared occurs."""

    name: str
    of: str
    """What is counted: scenes, views, objects..."""
    levels: dict[str, int]
    declared: dict[str, float] = field(default_factory=dict)
    """Share of each level that the configuration asks for; empty where it follows from several settings."""
    is_range: bool = False
    """Levels are parts of a range."""

    @property
    def missing(self) -> list[str]:
        """Levels that were declared and never drawn."""
        return [name for name, count in self.levels.items() if not count]


def factors(data: Gathered) -> list[Factor]:
    """Every declared factor; ranges in BINS equal parts (of the logarithm where it is drawn so)."""
    found = [*_object_factors(data), *_surrounding_factors(data), *_camera_factors(data), *_pose_factors(data)]
    return [factor for factor in found if factor.levels]


def _object_factors(data: Gathered) -> list[Factor]:
    """Which objects, of what, where and how they lie."""
    c, draws, m = data.config, data.draws, data.config.materials
    objects = [thing for draw in draws for thing in draw.objects]
    piles = [draw for draw in draws if draw.arrangement == "pile"]
    alone = [draw.objects[0] for draw in draws if draw.arrangement == "single"]
    metals = [thing for thing in objects if ":" in thing.material]
    names = [thing.material.partition("@")[0].split(":") for thing in metals]
    plain = [thing.material for thing in objects if ":" not in thing.material]
    kind = {"own": "own"} | dict.fromkeys(m.non_metals, "non_metal")
    weights = {**c.objects.parts, **{cad.file.name: cad.weight for cad in c.objects.cad}}
    piled = bool(c.objects.arrangement.get("pile"))
    metal, non_metal = m.kind.get("metal", 0), m.kind.get("non_metal", 0)
    offset = c.objects.offset_m
    return [
        _levels("object", "objects", weights, (thing.object for thing in objects)),
        _levels("arrangement", "scenes", c.objects.arrangement, (draw.arrangement for draw in draws)),
        _counted("parts in a pile", "piles", c.objects.pile_parts, [len(d.objects) for d in piles], piled),
        _levels("single part stands", "scenes", _two("upright", "lying", c.objects.upright),
                ("upright" if t.resting == "upright" else "lying" for t in alone)),
        _found("resting pose", "objects", (f"{thing.object}, {thing.resting}" for thing in objects)),
        _range("offset of a single part along x and y [m]", "coordinates", (-offset, offset) if alone else None,
               [row[3] for thing in alone for row in thing.T_world_model[:2]]),
        _range("distance of a pile's parts from the table's middle [m]", "objects",
               (0, 3 * c.objects.spread_m) if piled else None,
               [_from_middle(thing) for draw in piles for thing in draw.objects], uniform=False),
        _levels("kind of material", "objects", m.kind, [*(kind[p] for p in plain), *["metal"] * len(metals)]),
        _levels("metal", "objects", m.metals if metal else {}, (metal for metal, _ in names)),
        _levels("finish", "objects", finish_shares(m) if metal else {}, (finish for _, finish in names)),
        _levels("non-metal", "objects", m.non_metals if non_metal else {}, (p for p in plain if p != "own")),
        _range("roughness of metals, place in the finish's range", "objects",
               (0, 1) if metal and m.roughness == "range" else None, [_roughness_place(thing) for thing in metals]),
    ]  # fmt: skip


def _surrounding_factors(data: Gathered) -> list[Factor]:
    """Table, lamps, room, clutter."""
    s, draws = data.config.surroundings, data.draws
    clutter = [thing for draw in draws for thing in draw.clutter]
    littered = bool(s.clutter[1])
    return [
        _levels("table", "scenes", s.tables, (draw.table for draw in draws)),
        _levels("lamps", "scenes", s.lamps, (draw.lamps for draw in draws)),
        _levels("surroundings", "scenes", _two("room", "open", s.room), ("room" if d.room else "open" for d in draws)),
        _counted("clutter", "scenes", s.clutter, [len(draw.clutter) for draw in draws], True),
        _levels("shape of clutter", "things", s.clutter_shapes if littered else {}, (t.shape for t in clutter)),
        _levels("material of clutter", "things", s.clutter_materials if littered else {},
                (thing.material for thing in clutter)),
        _range("sides and diameters of clutter [m]", "lengths", s.clutter_size_m if littered else None,
               [side for thing in clutter for side in _sides(thing)], log=True),
    ]  # fmt: skip


def _camera_factors(data: Gathered) -> list[Factor]:
    """Stream, exposure, laser."""
    k, draws = data.config.camera, data.draws
    fixed = [draw.exposure_us for draw in draws if draw.exposure_us is not None]
    return [
        _levels("stream profile", "scenes", k.profiles, (draw.profile for draw in draws)),
        _levels("exposure", "scenes", _two("automatic", "fixed", k.auto_exposure),
                ("automatic" if draw.exposure_us is None else "fixed" for draw in draws)),
        _range("fixed exposure [us]", "scenes", k.exposure_us if k.auto_exposure < 1 else None, fixed, log=True),
        _range("laser power [mW]", "scenes", k.laser_mw, [draw.laser_mw for draw in draws], log=True),
    ]  # fmt: skip


def _pose_factors(data: Gathered) -> list[Factor]:
    """From where, how far, turned how. Along trajectories most numbers lie between two drawn ones."""
    p, draws = data.config.poses, data.draws
    views = [view for draw in draws for view in draw.views]
    return [
        _levels("motion", "scenes", p.motion, (draw.motion for draw in draws)),
        _range("elevation [deg]", "views", p.elevation_deg, [view.elevation_deg for view in views],
               chance=lambda deg: np.sin(np.radians(deg))),
        _range("distance [m]", "views", p.distance_m, [view.distance_m for view in views]),
        _range("azimuth [deg]", "views", (0, 360), [view.azimuth_deg for view in views]),
        _range("roll [deg]", "views", (-p.roll_deg, p.roll_deg), [view.roll_deg for view in views]),
        _range("aim beside the middle along x, y and z [m]", "coordinates", (-p.aim_m, p.aim_m),
               [along for view in views for along in view.aim_m]),
    ]  # fmt: skip


def _from_middle(thing: ObjectDraw) -> float:
    return math.hypot(thing.T_world_model[0][3], thing.T_world_model[1][3])


def _sides(thing: ClutterDraw) -> tuple[float, ...]:
    """The lengths that were drawn."""
    a, b, c = thing.size_m
    return {"box": (a, b, c), "cylinder": (a, c)}.get(thing.shape, (a,))


def _roughness_place(thing: ObjectDraw) -> float:
    """Where in its finish's range a metal's roughness is, on a logarithmic scale: 0 smoothest, 1 roughest."""
    name, _, alpha = thing.material.partition("@alpha=")
    low, high = FINISHES[name.split(":")[1]].range_u
    place = math.log(float(alpha.split(",")[0]) / low) / math.log(high / low) if alpha and high > low else 0.0
    return min(max(place, 0.0), 1.0)  # alpha is kept to four digits


def finish_shares(m: Materials) -> dict[str, float]:
    """Of metals that are drawn: a finish that a metal cannot have is left out of that metal's choice."""
    shares = dict.fromkeys((name for name, weight in m.finishes.items() if weight), 0.0)
    whole = sum(m.metals.values())
    for metal, weight in ((metal, weight) for metal, weight in m.metals.items() if weight):
        possible = {name: m.finishes[name] for name in shares if name in finish_names(metal, m.of_user)}
        for name, part in possible.items():
            shares[name] += weight / whole * part / sum(possible.values())
    return shares


def _two(first: str, second: str, share: float) -> dict[str, float]:
    return {first: share, second: 1 - share}


def _levels(name: str, of: str, weights: Mapping[str, float], drawn: Iterable[str]) -> Factor:
    found, whole = Counter(drawn), sum(weights.values())
    declared = {level: weight / whole for level, weight in sorted(weights.items()) if weight}
    return Factor(name, of, {level: found[level] for level in declared}, declared)


def _found(name: str, of: str, drawn: Iterable[str]) -> Factor:
    """Levels that follow from the objects' shapes."""
    return Factor(name, of, dict(sorted(Counter(drawn).items())))


def _counted(name: str, of: str, limits: tuple[int, int], drawn: list[int], declared: bool) -> Factor:
    """Whole numbers, each as likely as the other."""
    if not declared:
        return Factor(name, of, {})
    found, asked = Counter(drawn), range(limits[0], limits[1] + 1)
    known = sorted({*asked, *found})
    shares = {str(number): (number in asked) / len(asked) for number in known}
    return Factor(name, of, {str(number): found[number] for number in known}, shares)


def _range(
    name: str,
    of: str,
    limits: tuple[float, float] | None,
    drawn: Sequence[float],
    log: bool = False,
    uniform: bool = True,
    chance: Callable = lambda edge: edge,
) -> Factor:
    """Parts of a range. chance: whose differences between edges the parts' chances are in proportion to."""
    if limits is None:
        return Factor(name, of, {})
    low, high = limits
    if high <= low:
        return Factor(name, of, {f"{low:g}": len(drawn)}, {f"{low:g}": 1.0})
    edges = np.geomspace(low, high, BINS + 1) if log else np.linspace(low, high, BINS + 1)
    place = np.clip(np.searchsorted(edges, drawn, side="right") - 1, 0, BINS - 1)
    above = np.asarray(drawn) > high * (1 + 1e-9)
    found = np.bincount(place[~above], minlength=BINS) if len(drawn) else np.zeros(BINS, int)
    names = [f"{_short(a)} to {_short(b)}" for a, b in itertools.pairwise(edges)]
    chances = np.diff(np.log(edges) if log else chance(edges))
    shares = dict(zip(names, (chances / chances.sum()).tolist(), strict=True)) if uniform else {}
    levels = dict(zip(names, found.tolist(), strict=True))
    beyond = {f"above {_short(high)}": int(above.sum())} if above.any() else {}
    return Factor(name, of, levels | beyond, shares, is_range=True)


def _short(number: float) -> str:
    return f"{number:,.0f}" if abs(number) >= 100 else f"{number + 0.0:.3g}"
