"""A finished reconstruction as its folder holds it: all that the report is made of."""

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int, UInt8

from materials.input_error import InputError
from studies.run.bursts import infrared_path
from studies.store.images import read_png
from studies.store.ply import read_ply
from studies.store.tables import read_rows
from studies.store.views import StoredView, read_arrays, read_view

RUN, TIMINGS, ACQUISITIONS, CLOUD, FILTERED_CLOUD, SURFACE, REPORT = (
    "run.json",
    "timings.json",
    "acquisitions.parquet",
    "cloud.ply",
    "cloud_filtered.ply",
    "surface.npz",
    "report.html",
)
"""Files of a case. Only `timings.json` and the report drawn from it differ between two runs of one configuration."""


@dataclass(frozen=True)
class StoredRun:
    """Reads the files when they are asked for."""

    folder: Path

    @cached_property
    def run(self) -> dict[str, Any]:
        """Title, resolved configuration, seeds, versions and summary."""
        return _read_json(self.folder / RUN)

    @cached_property
    def timings(self) -> dict[str, Any]:
        """`wall_s`, `processor_s` and, per acquisition, the seconds of each stage."""
        return _read_json(self.folder / TIMINGS)

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """The table of acquisitions."""
        return read_rows(self.folder / ACQUISITIONS)

    @cached_property
    def surface(self) -> tuple[Float[np.ndarray, "m 3"], Int[np.ndarray, "m"]]:
        """Reference points [m] and the first acquisition after which each is covered within 5 mm, -1 = never."""
        arrays = read_arrays(self.folder / SURFACE)
        return arrays["points"], arrays["covered_at"]

    @cached_property
    def cloud(self) -> tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "n"]]:
        """The points [m] and the acquisition that saw each."""
        return read_ply(self.folder / CLOUD)

    def view(self, acquisition: int) -> StoredView:
        """Masks, ellipsoids and regions of one acquisition."""
        return read_view(self.folder, acquisition)

    def infrared(self, acquisition: int) -> UInt8[np.ndarray, "h w"] | None:
        """Left infrared image of the first frame, None when the sensor gave none."""
        path = infrared_path(self.folder, acquisition)
        return read_png(path) if path.exists() else None


def stored_runs(folder: Path) -> list[Path]:
    """Finished reconstructions at `folder`: itself, or those in it; InputError when there are none."""
    if not folder.exists():
        raise InputError(f"{folder}: no such folder; give the --out folder of a reconstruction")
    if not folder.is_dir():
        raise InputError(f"{folder}: this is a file; give the --out folder of a reconstruction")
    own = folder / RUN
    if own.is_file() and not own.is_symlink():
        return [folder]
    found = sorted(path.parent for path in folder.glob(f"[!.]*/{RUN}") if not path.parent.is_symlink())
    if not found:
        raise InputError(f"{folder}: holds no finished reconstruction (no {RUN}); run `franbv reconstruct` first")
    return found


def _read_json(path: Path) -> dict[str, Any]:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read ({error}); the case is damaged, remove it and run it again") from None
