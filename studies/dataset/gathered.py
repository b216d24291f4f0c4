"""All scenes of a dataset taken together: what was drawn, how often each declared level occurs, what was counted."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studies.dataset.config import DatasetConfig
from studies.dataset.draw import SceneDraw
from studies.dataset.folders import DATASET, SCENE, SPLIT, STATISTICS, read_json
from studies.dataset.index import scene_folders
from studies.dataset.statistics import Counts

BINS = 8
"""Of the histogram of a range (choice)."""


@dataclass(frozen=True, eq=False)
class Gathered:
    """Everything but the images."""

    config: DatasetConfig
    materials: list[str]
    draws: list[SceneDraw]
    exposures_us: list[float]
    """Of every view [us]."""
    counts: Counts
    hole_shares: list[float]
    """Share of the objects' pixels without depth, of every view that sees any."""

    @property
    def views(self) -> int:
        """How many there are."""
        return sum(len(draw.views) for draw in self.draws)


def gather(root: Path) -> Gathered:
    """Read what every scene says about itself."""
    top = read_json(root / DATASET)
    draws, exposures, rows, shares = [], [], [], []
    for name in scene_folders(root):
        scene = read_json(root / SPLIT / name / SCENE)
        draws.append(SceneDraw.model_validate(scene["draw"]))
        exposures += [entry["exposure_us"] for entry in scene["exposures"]]
        for view in read_json(root / SPLIT / name / STATISTICS).values():
            rows.append(view)
            cells = np.array(view)
            seen = cells[:, 2] == 1
            if seen.any():
                missing = seen & (cells[:, 3] > 0) & (cells[:, 3] < 20)
                shares.append(float(cells[missing, 4].sum() / cells[seen, 4].sum()))
    config = DatasetConfig.model_validate(top["config"])
    return Gathered(config, top["materials"], draws, exposures, Counts.total(rows), shares)


@dataclass(frozen=True)
class Factor:
    """How often each level of something that was declared occurs."""

    name: str
    of: str
    """What is counted: scenes, views, objects..."""
    levels: dict[str, int]

    @property
    def missing(self) -> list[str]:
        """Levels that were declared and never drawn."""
        return [name for name, count in self.levels.items() if not count]


def factors(data: Gathered) -> list[Factor]:
    """Every declared factor with its levels; ranges in BINS equal parts (of the logarithm where it is drawn so)."""
    c, draws = data.config, data.draws
    m, s, k = c.materials, c.surroundings, c.camera
    objects = [thing for draw in draws for thing in draw.objects]
    clutter = [thing for draw in draws for thing in draw.clutter]
    views = [view for draw in draws for view in draw.views]
    metals = [thing.material.partition("@")[0].split(":") for thing in objects if ":" in thing.material]
    plain = [thing.material for thing in objects if ":" not in thing.material]
    kind = {"own": "own"} | dict.fromkeys(m.non_metals, "non_metal")
    weights = {**c.objects.parts, **{cad.file.name: cad.weight for cad in c.objects.cad}}
    piles = [len(draw.objects) for draw in draws if draw.arrangement == "pile"]
    fixed = [draw.exposure_us for draw in draws if draw.exposure_us is not None]
    drawn, plain_kind = m.kind.get("metal", 0), m.kind.get("non_metal", 0)
    littered = s.clutter[1]
    return [
        _levels("object", "objects", weights, (thing.object for thing in objects)),
        _levels("arrangement", "scenes", c.objects.arrangement, (draw.arrangement for draw in draws)),
        _counted("parts in a pile", "piles", c.objects.pile_parts, piles, bool(c.objects.arrangement.get("pile"))),
        _levels("kind of material", "objects", m.kind, [*(kind[p] for p in plain), *["metal"] * len(metals)]),
        _levels("metal", "objects", _if(drawn, m.metals), (metal for metal, _ in metals)),
        _levels("finish", "objects", _if(drawn, m.finishes), (finish for _, finish in metals)),
        _levels("non-metal", "objects", _if(plain_kind, m.non_metals), (p for p in plain if p != "own")),
        _levels("table", "scenes", s.tables, (draw.table for draw in draws)),
        _levels("lamps", "scenes", s.lamps, (draw.lamps for draw in draws)),
        _levels(
            "surroundings", "scenes", _share("room", "open", s.room), _two(draws, "room", "open", lambda d: d.room)
        ),
        _counted("clutter", "scenes", s.clutter, [len(draw.clutter) for draw in draws], True),
        _levels("shape of clutter", "things", _if(littered, s.clutter_shapes), (thing.shape for thing in clutter)),
        _levels("material of clutter", "things", _if(littered, s.clutter_materials), (t.material for t in clutter)),
        _levels("stream profile", "scenes", k.profiles, (draw.profile for draw in draws)),
        _levels(
            "exposure", "scenes", _share("automatic", "fixed", k.auto_exposure),
            _two(draws, "automatic", "fixed", lambda d: d.exposure_us is None),
        ),
        _range("fixed exposure [us]", "scenes", _if_range(1 - k.auto_exposure, k.exposure_us), fixed, log=True),
        _range("laser power [mW]", "scenes", k.laser_mw, [draw.laser_mw for draw in draws], log=True),
        _levels("motion", "scenes", c.poses.motion, (draw.motion for draw in draws)),
        _range("elevation [deg]", "views", c.poses.elevation_deg, [view.elevation_deg for view in views]),
        _range("distance [m]", "views", c.poses.distance_m, [view.distance_m for view in views]),
        _range("azimuth [deg]", "views", (0, 360), [view.azimuth_deg for view in views]),
    ]  # fmt: skip


def _if(weight: float, weights: dict[str, float]) -> dict[str, float]:
    return weights if weight else {}


def _if_range(weight: float, limits: tuple[float, float]) -> tuple[float, float] | None:
    return limits if weight else None


def _share(first: str, second: str, share: float) -> dict[str, float]:
    return {first: share, second: 1 - share}


def _two(draws: list[SceneDraw], first: str, second: str, is_first) -> list[str]:
    return [first if is_first(draw) else second for draw in draws]


def _levels(name: str, of: str, weights: dict[str, float], drawn: Iterable[str]) -> Factor:
    found = Counter(drawn)
    return Factor(name, of, {level: found[level] for level, weight in sorted(weights.items()) if weight})


def _counted(name: str, of: str, limits: tuple[int, int], drawn: list[int], declared: bool) -> Factor:
    found = Counter(drawn)
    known = set(range(limits[0], limits[1] + 1)) | set(found) if declared else set()
    return Factor(name, of, {str(number): found[number] for number in sorted(known)})


def _range(name: str, of: str, limits: tuple[float, float] | None, drawn: list[float], log: bool = False) -> Factor:
    if limits is None:
        return Factor(name, of, {})
    low, high = limits
    if high <= low:
        return Factor(name, of, {f"{low:g}": len(drawn)})
    edges = np.geomspace(low, high, BINS + 1) if log else np.linspace(low, high, BINS + 1)
    place = np.clip(np.searchsorted(edges, drawn, side="right") - 1, 0, BINS - 1)
    above = np.asarray(drawn) > high * (1 + 1e-9)
    found = np.bincount(place[~above] if len(drawn) else place, minlength=BINS)
    levels = {f"{a:.4g} to {b:.4g}": int(n) for a, b, n in zip(edges[:-1], edges[1:], found, strict=True)}
    return Factor(name, of, levels | ({f"above {high:.4g}": int(above.sum())} if above.any() else {}))
