"""A finished reconstruction as its folder holds it: all that the report is made of."""

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from materials.input_error import InputError
from studies.base.latest import LATEST
from studies.base.reading import reading
from studies.run.acquisition_table import ACQUISITION_COLUMNS
from studies.run.bursts import depths_path, infrared_path, stored_depths, stored_infrared
from studies.store.ply import read_ply
from studies.store.tables import read_rows
from studies.store.views import VIEWS, StoredView, read_arrays, read_view, view_path

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


RUN_FORMAT = 4
"""Of `run.json` and what stands beside it; it rises when a report cannot be drawn from older ones."""
MEND = "copy the case whole, or give its command again with another --out"
"""What to do where a part of a case is missing or damaged; nothing that is there is in the way."""


@dataclass(frozen=True)
class StoredRun:
    """Reads the files when they are asked for; InputError names the file that cannot be read, or an older format."""

    folder: Path

    @cached_property
    def run(self) -> dict[str, Any]:
        """Title, resolved configuration, seeds, versions and summary."""
        stored = self._json(RUN, "title", "config", "versions", "summary")
        if stored.get("format") != RUN_FORMAT:
            raise InputError(
                f"{self.folder / RUN}: was written by an older or newer version (format {stored.get('format', 1)}, "
                f"here {RUN_FORMAT}); read it with that version, or give its command again with another --out"
            )
        return stored

    @cached_property
    def timings(self) -> dict[str, Any]:
        """`wall_s`, `processor_s` and, per acquisition, the seconds of each stage."""
        return self._json(TIMINGS, "wall_s", "processor_s", "acquisitions")

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """The table of acquisitions."""
        with reading(self.folder / ACQUISITIONS, MEND):
            rows = read_rows(self.folder / ACQUISITIONS)
            lacking = {column.name for column in ACQUISITION_COLUMNS} - set(rows[0])
            if lacking:
                raise ValueError(f"columns {sorted(lacking)} are missing")
        return rows

    @cached_property
    def surface(self) -> tuple[Float[np.ndarray, "m 3"], Bool[np.ndarray, "k m"]]:
        """Visible reference points [m], and whether the map covers each after each acquisition."""
        with reading(self.folder / SURFACE, MEND):
            arrays = read_arrays(self.folder / SURFACE)
            points = arrays["points"]
            return points, np.unpackbits(arrays["covered"], axis=1, count=len(points)).astype(bool)

    @cached_property
    def first_covered(self) -> Int[np.ndarray, "m"]:
        """First acquisition after which the cloud covers each of these points within 5 mm, -1 = never."""
        with reading(self.folder / SURFACE, MEND):
            return read_arrays(self.folder / SURFACE)["covered_at"]

    @cached_property
    def cloud(self) -> tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "n"]]:
        """The points [m] and the acquisition that saw each."""
        with reading(self.folder / CLOUD, MEND):
            return read_ply(self.folder / CLOUD)

    def view(self, acquisition: int) -> StoredView:
        """Masks, ellipsoids and regions of one acquisition."""
        with reading(view_path(self.folder, acquisition), MEND):
            return read_view(self.folder, acquisition)

    def infrared(self, acquisition: int) -> UInt8[np.ndarray, "h w"] | None:
        """Left infrared image of the first frame, None when the sensor gave none."""
        with reading(infrared_path(self.folder, acquisition), MEND):
            return stored_infrared(self.folder, acquisition)

    def depths(self, acquisition: int) -> Float[np.ndarray, "n h w"] | None:
        """Depth frames of one acquisition [m]; None where they were not kept, as in replays."""
        path = depths_path(self.folder, acquisition)
        with reading(path, MEND):
            return stored_depths(self.folder, acquisition) if path.exists() else None

    def _json(self, name: str, *keys: str) -> dict[str, Any]:
        with reading(self.folder / name, MEND):
            stored = json.loads((self.folder / name).read_text(encoding="utf-8"))
            lacking = [key for key in keys if key not in stored]
            if lacking:
                raise ValueError(f"`{lacking[0]}` is missing")
        return stored


def stored_runs(folder: Path) -> list[Path]:
    """Finished reconstructions at `folder`: itself, those in it, or those in the --out folders in it; InputError when
    there are none."""
    if not folder.exists():
        raise InputError(f"{folder}: no such folder; give the --out folder of a reconstruction")
    if not folder.is_dir():
        raise InputError(f"{folder}: this is a file; give the --out folder of a reconstruction")
    found = [folder] if is_case(folder) else _cases_below(folder)
    if not found:
        raise InputError(f"{folder}: holds no finished reconstruction (no {RUN}); run `franbv reconstruct` first")
    return found


def is_case(folder: Path) -> bool:
    """Whether this is the folder of a case, and not one that only shows some of a case's files."""
    return (folder / RUN).is_file() and (folder / VIEWS).is_dir()


def _cases_below(folder: Path) -> list[Path]:
    """Cases in a folder, or else in the folders in it. `latest` shows one of the others, as a link or, copied with
    links followed, as a second copy."""
    below = [path for path in sorted(folder.glob("[!.]*")) if path.is_dir() and not path.is_symlink()]
    cases = [path for path in below if is_case(path)]
    named = [path for path in cases if path.name != LATEST]
    return named or cases or [case for path in below for case in _cases_below(path)]
