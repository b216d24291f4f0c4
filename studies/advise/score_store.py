"""Counts of setups at poses, kept on disk one by one, so that nothing is measured twice."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from studies.advise.scoring import SurfaceCount, measured_part
from studies.advise.setup import Setup
from studies.advise.stored_light import LightStore
from studies.base.atomic_file import write_atomically
from studies.base.case_folder import case_digest
from studies.base.config import Config
from studies.base.console import strict_json
from studies.base.reading import reading
from studies.run.scene_settings import SubjectSettings

SURFACE_COUNTS = "scores"
"""Sub-folder of the counts."""
ViewCounts = tuple[SurfaceCount, ...]
"""Of one pose, one for each seed."""


class ScoredPose(Config):
    """Names one file of counts: all that decides them."""

    subject: SubjectSettings
    pose: str
    roll_deg: float
    """Of the mount."""
    seeds: tuple[int, ...]
    setup: Setup


@dataclass(eq=False)
class ScoreStore:
    """Counts by setup and pose; measures what is missing."""

    lights: LightStore
    seeds: tuple[int, ...]
    """Of the noise."""
    _known: dict[tuple[str, int], ViewCounts] = field(default_factory=dict)

    def path(self, setup: Setup, index: int) -> Path:
        """File of one setup at one pose."""
        scored = ScoredPose(
            subject=self.lights.subject,
            pose=self.lights.poses[index],
            roll_deg=self.lights.roll_deg,
            seeds=self.seeds,
            setup=setup,
        )
        return self.lights.out / SURFACE_COUNTS / f"{case_digest('advise score 2', scored)}.json"

    def has(self, setup: Setup, n_poses: int) -> bool:
        """Whether all of the first so many poses are counted."""
        return all(self.path(setup, index).exists() for index in range(n_poses))

    def counts(self, setup: Setup, index: int) -> ViewCounts:
        """Read, or measured and written."""
        key = setup.model_dump_json(), index
        if key not in self._known:
            path = self.path(setup, index)
            if not path.exists():
                counts = [measured_part(self.lights, setup, index, seed).count for seed in self.seeds]
                path.parent.mkdir(exist_ok=True)
                write_atomically(path, strict_json([asdict(one) for one in counts]).encode())
            with reading(path, "remove it and give the command again"):
                stored = json.loads(path.read_text(encoding="utf-8"))
                self._known[key] = tuple(SurfaceCount(**one) for one in stored)
        return self._known[key]

    def all_counts(self, setup: Setup, n_poses: int) -> Sequence[ViewCounts]:
        """Of the first so many poses."""
        return [self.counts(setup, index) for index in range(n_poses)]
