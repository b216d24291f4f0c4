"""All scenes of a dataset taken together: what was drawn, by what it was made, what was counted."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from render.labels.causes import HOLES
from studies.dataset.config import DatasetConfig
from studies.dataset.draw.draw import SceneDraw
from studies.dataset.format.folders import DATASET, MANIFEST, SCENE, SPLIT, STATISTICS, read_json
from studies.dataset.format.index import scene_folders
from studies.dataset.format.statistics import Counts


@dataclass(frozen=True, eq=False)
class Gathered:
    """Everything but the images."""

    config: DatasetConfig
    materials: list[str]
    draws: list[SceneDraw]
    exposures_us: list[float]
    """Of every view [us]."""
    counts: Counts
    makers: list[str]
    """Renderers and versions by which scenes were made; more than one where they differ."""
    hole_shares: list[float]
    """Share of the objects' pixels without depth, of every view that sees any."""

    @property
    def views(self) -> int:
        """How many there are."""
        return sum(len(draw.views) for draw in self.draws)


def gather_scenes(root: Path) -> Gathered:
    """Read what every scene says about itself."""
    top = read_json(root / DATASET)
    draws, exposures, rows, shares, makers = [], [], [], [], set()
    for name in scene_folders(root):
        scene = read_json(root / SPLIT / name / SCENE)
        makers.add(made_by(read_json(root / SPLIT / name / MANIFEST)))
        draws.append(SceneDraw.model_validate(scene["draw"]))
        exposures += [entry["exposure_us"] for entry in scene["exposures"]]
        for view in read_json(root / SPLIT / name / STATISTICS).values():
            rows.append(view)
            cells = np.array(view)
            seen = cells[:, 2] == 1
            if seen.any():
                missing = seen & np.isin(cells[:, 3], HOLES)
                shares.append(float(cells[missing, 4].sum() / cells[seen, 4].sum()))
    config = DatasetConfig.model_validate(top["config"])
    return Gathered(config, top["materials"], draws, exposures, Counts.total(rows), sorted(makers), shares)


def made_by(manifest: dict[str, Any]) -> str:
    """Renderer and versions of a scene, in words."""
    return f"renderer {manifest['renderer']}; " + ", ".join(f"{a} {b}" for a, b in manifest["versions"].items())
