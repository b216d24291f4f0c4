"""Bursts that several runs of a study have in common: the same subject, camera, seed and pose give the same frames.

Runs that start alike take the same first view, and methods that differ in one step look from the same poses until that
step decides something. Files are shared by hard links, so that they cost no space, and by copies where there are none.
"""

import hashlib
import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from studies.base.atomic_file import DIGEST_BYTES, write_atomically
from studies.run.scene_settings import SubjectSettings


@dataclass(frozen=True)
class SharedCaptures:
    """A folder of bursts that were taken from one subject by one camera, noise included."""

    folder: Path
    subject: str
    """All that decides a burst but its pose and its number of frames, as text."""

    @classmethod
    def of(cls, folder: Path, settings: SubjectSettings) -> "SharedCaptures":
        """Those of these (resolved) settings; what else a run is told does not matter to its camera."""
        stored = settings.model_dump(mode="json", include=set(SubjectSettings.model_fields))
        folder.mkdir(parents=True, exist_ok=True)
        return cls(folder, json.dumps(stored, sort_keys=True))

    def take_over(self, T_world_cam: RigidTransform, n_frames: int, files: Iterable[Path]) -> bool:
        """Make the case's files from the shared ones; False if nobody has taken this burst yet."""
        pairs = [(self._shared(T_world_cam, n_frames, own), own) for own in files]
        if not all(shared.exists() for shared, _ in pairs):
            return False
        for shared, own in pairs:
            _link(shared, own)
        return True

    def offer(self, T_world_cam: RigidTransform, n_frames: int, files: Iterable[Path]) -> None:
        """Let other runs have these files of a finished burst."""
        for own in files:
            shared = self._shared(T_world_cam, n_frames, own)
            if not shared.exists():
                _link(own, shared)

    def _shared(self, T_world_cam: RigidTransform, n_frames: int, own: Path) -> Path:
        """The shared form of a case's file: named by what decides it, and by its type."""
        pose = np.ascontiguousarray(T_world_cam.as_matrix()).tobytes()
        text = f"{self.subject} {n_frames} ".encode()
        return self.folder / (hashlib.blake2b(text + pose, digest_size=DIGEST_BYTES).hexdigest() + own.suffix)


def _link(source: Path, target: Path) -> None:
    """Let `target` be the same file as `source`, or a copy of it; it is there whole or not at all."""
    temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        os.link(source, temporary)
    except OSError:  # a file system without hard links
        write_atomically(target, source.read_bytes())
        return
    os.replace(temporary, target)
    temporary.unlink(missing_ok=True)  # renaming a link to another link of the same file does nothing
