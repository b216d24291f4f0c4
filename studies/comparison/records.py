"""The finished runs of a comparison as the statistics need them, read from the cases' folders."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from jaxtyping import Float, Int

from studies.base.case_folder import finished_case
from studies.run.acquisition_table import MAP_COVERAGE, RAW_COVERAGE
from studies.run.batch import RUNS, PlannedRun
from studies.run.robot_seconds import FRAME_S, robot_seconds
from studies.run.stored_run import StoredRun
from studies.store.tables import Column

CONTRIBUTED = "recovery_contribution"
"""What recovery views added to the coverage of the map, of a run's summary [-]."""


@dataclass(frozen=True, eq=False)
class Record:
    """One finished run."""

    part: str
    arm: str
    run: int
    case: str
    """Name of its folder."""
    summary: Mapping[str, Any]
    """The summary of run.json."""
    coverage: Float[np.ndarray, "k"]
    """C_k at 5 mm of what the map holds."""
    raw: Float[np.ndarray, "k"]
    """The same of all points ever seen."""
    kinds: tuple[str, ...]
    """first, nbv or recovery, of each acquisition."""
    iterations: Int[np.ndarray, "k"]
    """NBV iteration of each acquisition."""
    planning_s: Float[np.ndarray, "k"]
    motion_s: Float[np.ndarray, "k"]
    n_frames: int
    processor_s: float
    """What the run took of this machine, simulation included."""
    versions: Mapping[str, str]
    """Of Python and what the planners and the sensor stand on."""
    losses: Mapping[str, float]
    """Sums over the run of what each step of the detection and recovery kept."""

    def by_iteration(self, values: Float[np.ndarray, "k"]) -> Float[np.ndarray, "i"]:
        """The values after each NBV iteration with its recoveries; index 0 is the first view."""
        last = np.flatnonzero(np.diff(self.iterations, append=self.iterations[-1] + 1))
        return values[last]

    def iteration_times(self, overhead_s: float = 0.0) -> dict[str, Float[np.ndarray, "i"]]:
        """Planning, motion, exposure and overhead of each NBV iteration with its recoveries [s].

        The first view is given and belongs to no iteration; recoveries that it starts count to the first one.
        overhead_s: of every view.
        """
        parts = {
            "planning": self.planning_s,
            "motion": self.motion_s,
            "exposure": np.full(len(self.kinds), self.n_frames * FRAME_S),
            "overhead": np.full(len(self.kinds), overhead_s),
        }
        places, n = np.maximum(self.iterations[1:], 1) - 1, int(self.iterations[-1])
        return {name: np.bincount(places, values[1:], minlength=n)[:n] for name, values in parts.items()}

    def increments(self, kind: str) -> tuple[Float[np.ndarray, "v"], Float[np.ndarray, "v"]]:
        """Coverage of the map before each view of a kind, and what the view added to it; it may have taken away."""
        of_kind = np.array(self.kinds) == kind
        before = np.concatenate([[0.0], self.coverage[:-1]])
        return before[of_kind], (self.coverage - before)[of_kind]


def read_records(out: Path, runs: Iterable[PlannedRun]) -> list[Record]:
    """Those of the runs that are finished."""
    records = []
    for planned in runs:
        folder = finished_case(out / RUNS, planned.digest)
        if folder is not None:
            records.append(_record(planned, StoredRun(folder)))
    return records


def _record(planned: PlannedRun, stored: StoredRun) -> Record:
    rows = stored.rows
    seconds = robot_seconds(stored)
    return Record(
        part=planned.part,
        arm=planned.arm,
        run=planned.run,
        case=planned.digest,
        summary=stored.run["summary"],
        coverage=np.array([row[MAP_COVERAGE] for row in rows]),
        raw=np.array([row[RAW_COVERAGE] for row in rows]),
        kinds=tuple(row["kind"] for row in rows),
        iterations=np.array([row["iteration"] for row in rows]),
        planning_s=seconds["planning"],
        motion_s=seconds["motion"],
        n_frames=stored.run["config"]["parameters"]["n_frames"],
        processor_s=stored.timings["processor_s"],
        versions=stored.run["versions"],
        losses=_losses(rows),
    )


def _losses(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Of the views in which regions are looked for: pixels after each filter, regions, poses; of recoveries: Gamma."""
    looked = [row for row in rows if row["regions"] is not None]
    gammas = [row["gamma"] for row in rows if row["gamma"] is not None]
    return {
        "views": len(looked),
        "invalid_pixels": sum(row["invalid_pixels"] for row in looked),
        "candidate_pixels": sum(row["candidate_pixels"] for row in looked),
        "reflective_pixels": sum(row["reflective_pixels"] for row in looked),
        "regions": sum(row["regions"] for row in looked),
        "activations": sum((row["recovery_poses"] or 0) > 0 for row in looked),
        "poses": sum(row["recovery_poses"] or 0 for row in looked),
        "recovery_views": len(gammas),
        "largest_gamma": max(gammas, default=0.0),
    }


SUMMARY_COLUMNS = {
    MAP_COVERAGE: "Share of the visible surface within 5 mm of what the final map holds [-]",
    CONTRIBUTED: "What recovery views added to that share, view by view [-]",
    RAW_COVERAGE: "Share of the visible surface within 5 mm of the raw cloud [-]",
    "filtered_coverage_5mm": "The same of the points in occupied voxels [-]",
    "accuracy_mm": "Mean distance of the cloud from the surface [mm]",
    "accuracy_median_mm": "Median of that distance [mm]",
    "f_score": "Harmonic mean of coverage and precision at 5 mm [-]",
    "filtered_f_score": "The same of the points in occupied voxels [-]",
    "wrongly_free_share": "Share of the surface's voxels that the map calls free [-]",
    "wrongly_occupied_share": "Share of the object's voxels that the surface cannot pass through [-]",
    "recovery_share": "Share of the raw cloud's coverage that recovery views brought [-]",
}
COUNTS = {
    "acquisitions": "Acquisitions, the first view included [-]",
    "nbv_iterations": "NBV iterations [-]",
    "recovery_activations": "Recovery activations [-]",
    "recovery_acquisitions": "Recovery views [-]",
}

RUN_COLUMNS = (
    Column("part", pa.string(), "Part, or the inside corner"),
    Column("arm", pa.string(), "Planner, or name of an ablation"),
    Column("run", pa.int32(), "Number of the start; equal numbers start alike [-]"),
    Column("case", pa.string(), "Folder of the run"),
    *(Column(name, pa.float64(), meaning) for name, meaning in SUMMARY_COLUMNS.items()),
    *(Column(name, pa.int32(), meaning) for name, meaning in COUNTS.items()),
    Column("stop", pa.string(), "Rule that ended the run"),
    Column("planning_s", pa.float64(), "Mean processor time of planning of an NBV iteration with its recoveries [s]"),
    Column("motion_s", pa.float64(), "Mean modelled motion time of the same [s]"),
    Column("iteration_s", pa.float64(), "Mean of planning, motion and exposure of the same [s]"),
    Column("processor_s", pa.float64(), "Processor time of the run, simulation included; shared bursts cost none [s]"),
)
"""Of `runs.parquet`, a row per run."""


def table_row(record: Record) -> dict[str, Any]:
    """The row of one run."""
    times = {name: float(values.mean()) if len(values) else None for name, values in record.iteration_times().items()}
    known = [seconds for seconds in times.values() if seconds is not None]
    return {
        **{name: getattr(record, name) for name in ("part", "arm", "run", "case", "processor_s")},
        **{name: record.summary[name] for name in (*SUMMARY_COLUMNS, *COUNTS, "stop")},
        "planning_s": times["planning"],
        "motion_s": times["motion"],
        "iteration_s": sum(known) if known else None,
    }
