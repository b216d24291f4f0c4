"""Turns the acquisitions of a run into what is stored of it: rows, views, clouds, the reference surface, a summary."""

from typing import Any

import numpy as np
from jaxtyping import Bool, Int, Shaped

from franbv.acquisition import Acquisition, Reconstruction
from franbv.evaluation.coverage import MAP_MEASURE, MEASURES, RAW_MEASURE, CoverageRecord, History, Measure
from franbv.evaluation.quality import Quality, quality, wrongly_free_share, wrongly_occupied_share
from franbv.evaluation.reference import Reference
from franbv.parameters import Parameters
from franbv.reflective_regions import View, inside_eroded_silhouette, persistent_invalid
from studies.run.acquisition_table import (
    MAP_COVERAGE,
    MAP_INCREMENT,
    MISSING_BELIEVED,
    RAW_COVERAGE,
    RECOVERY,
    coverage_column,
    coverage_figures,
)
from studies.store.images import MM
from studies.store.views import StoredView, camera_vector


class RunRecorder:
    """Observes a reconstruction. Without a reference surface nobody knows what is covered, and it says None."""

    def __init__(self, reference: Reference | None, parameters: Parameters) -> None:
        self.rows: list[dict[str, Any]] = []
        self.covered_at: Int[np.ndarray, "m"] = np.full(0 if reference is None else len(reference.points), -1)
        """First acquisition after which each reference point is covered by the cloud at 5 mm, -1 = never."""
        self.covered: list[Bool[np.ndarray, "m"]] = []
        """Whether each is covered in the map after each acquisition."""
        self._coverage = None if reference is None else CoverageRecord(reference)
        self._parameters = parameters
        self._activations = 0

    def observe(self, acquisition: Acquisition) -> StoredView:
        """Add the acquisition's row; returns what is stored of its view."""
        found = self._covered(acquisition)
        self._activations += acquisition.activates
        view = stored_view(acquisition, self._parameters)
        self.rows.append(self._row(acquisition, view) | found)
        return view

    def history(self) -> History | None:
        """Coverage of all that was observed; None without a reference."""
        return None if self._coverage is None else self._coverage.history()

    def _covered(self, acquisition: Acquisition) -> dict[str, float | None]:
        """Coverages after the acquisition."""
        if self._coverage is None:
            self.covered.append(np.zeros(0, bool))
            return {**dict.fromkeys(coverage_figures(dict.fromkeys(MEASURES, 0.0))), MAP_INCREMENT: None}
        found = coverage_figures(self._coverage.add(acquisition))
        self.covered_at[(self.covered_at < 0) & self._coverage.covered(RAW_MEASURE)] = acquisition.index
        self.covered.append(self._coverage.covered(MAP_MEASURE)[: len(self.covered_at)])
        before = self.rows[-1][MAP_COVERAGE] if self.rows else 0.0
        return {**found, MAP_INCREMENT: found[MAP_COVERAGE] - before}

    def _row(self, a: Acquisition, view: StoredView) -> dict[str, Any]:
        pose = a.burst.T_world_cam
        found = a.detection
        return {
            "acquisition": a.index,
            "kind": a.kind,
            "iteration": a.nbv_iteration,
            "activation": self._activations if a.kind == RECOVERY else None,
            "position": pose.translation.tolist(),
            "quaternion_xyzw": pose.rotation.as_quat().tolist(),
            "utility": a.utility,
            "unreachable": a.n_unreachable,
            "valid_share": float(np.mean(~view.invalid)),
            "pixels": int(view.invalid.size),
            "invalid_pixels": int(view.invalid.sum()),
            "silhouette_pixels": int(view.silhouette.sum()),
            "candidate_pixels": int(view.candidates.sum()),
            "reflective_pixels": None if found is None else int(view.reflective.sum()),
            "regions": None if found is None else len(found.boxes),
            "recovery_poses": None if a.recovery_poses is None else len(a.recovery_poses.poses),
            MISSING_BELIEVED: a.missing,
            "gamma": a.gamma,
            "gamma_attainable": a.gamma_attainable,
            "occupied_voxels": len(a.model.object.occupied),
            "frontier_voxels": len(a.model.object.frontier),
            "occupied_ellipsoids": int(np.count_nonzero(~a.model.ellipsoids.is_frontier)),
            "frontier_ellipsoids": int(np.count_nonzero(a.model.ellipsoids.is_frontier)),
            "points": len(a.points),
            "motion_s": a.motion_s,
        }


def stored_view(a: Acquisition, parameters: Parameters) -> StoredView:
    """What is kept of one acquisition. Where the planner did not look for regions, the masks are made here."""
    seen = View(a.burst, a.model.ellipsoids, parameters)
    invalid = persistent_invalid(seen)
    found = a.detection
    boxes = found.boxes if found else ()
    return StoredView(
        T_world_cam=a.burst.T_world_cam.as_matrix(),
        camera=camera_vector(a.burst.intrinsics),
        depth=a.burst.median_depth(parameters.invalid_share).astype(np.float32),
        invalid=invalid,
        silhouette=seen.silhouette,
        candidates=found.candidates if found else invalid & inside_eroded_silhouette(seen),
        reflective=found.retained if found else np.zeros_like(invalid),
        ellipsoid_centres=a.model.ellipsoids.centres,
        ellipsoid_shapes=a.model.ellipsoids.shapes,
        ellipsoid_is_frontier=a.model.ellipsoids.is_frontier,
        region_centres=np.array([box.centre for box in boxes]).reshape(-1, 3),
        region_axes=np.array([box.axes for box in boxes]).reshape(-1, 3, 3),
        region_half_extents=np.array([box.half_extents for box in boxes]).reshape(-1, 3),
    )


def cloud_owner(run: Reconstruction) -> Int[np.ndarray, "n"]:
    """The acquisition that saw each point of the run's cloud."""
    return np.repeat(np.arange(len(run.acquisitions)), [len(a.points) for a in run.acquisitions])


def run_summary(run: Reconstruction, past: History | None, reference: Reference | None) -> dict[str, Any]:
    """The figures of a run; shares as fractions, lengths in millimetres. Without a reference coverage is None, and all
    else that is told from one is left out.

    `recovery_contribution` is what recovery views added to the coverage of the map, as a fraction of the surface; it
    can be negative. `recovery_gain` is the same of the raw coverage, `recovery_share` that over the final raw one.
    """
    told: dict[str, float | None] = {MAP_COVERAGE: None, RAW_COVERAGE: None}
    of_recovery: dict[str, float] = {}
    if reference is not None and past is not None:
        told, of_recovery = _surface_figures(run, past, reference), _recovery_figures(past)
    return {
        **told,
        "acquisitions": len(run.acquisitions),
        "nbv_iterations": run.acquisitions[-1].nbv_iteration,
        "recovery_activations": sum(a.activates for a in run.acquisitions),
        "recovery_acquisitions": sum(a.kind == RECOVERY for a in run.acquisitions),
        **of_recovery,
        MISSING_BELIEVED: run.acquisitions[-1].missing,
        "stop": str(run.stop),
    }


def _surface_figures(run: Reconstruction, past: History, reference: Reference) -> dict[str, float | None]:
    """What is told from a known surface."""
    final = run.acquisitions[-1].model
    occupied = final.object.occupied
    return {
        **_quality_figures(quality(reference, run.cloud), ""),
        **_quality_figures(quality(reference, run.cloud[run.is_mapped]), "filtered_"),
        **coverage_figures({measure: float(curve[-1]) for measure, curve in past.coverage.items()}),
        "wrongly_free_share": wrongly_free_share(reference, final.voxel_map),
        "wrongly_occupied_share": wrongly_occupied_share(reference, occupied, final.voxel_map.voxel_size),
    }


def _recovery_figures(past: History) -> dict[str, float]:
    return {
        "recovery_contribution": past.recovery_contribution(MAP_MEASURE),
        "recovery_gain": past.recovery_contribution(RAW_MEASURE),
        "recovery_share": past.recovery_share,
    }


def _quality_figures(found: Quality, prefix: str) -> dict[str, float]:
    counted = "filtered" if prefix else "raw"
    coverages = {coverage_column(Measure(counted, t)): share for t, share in found.coverage.items()}
    return coverages | {
        f"{prefix}accuracy_mm": MM * found.accuracy_mean,
        f"{prefix}accuracy_median_mm": MM * found.accuracy_median,
        f"{prefix}precision_5mm": found.precision,
        f"{prefix}f_score": found.f_score,
    }


def timing_figures(times: list[dict[str, float]], wall_s: float, processor_s: float) -> dict[str, float]:
    """Medians over the acquisitions [s]: `sensing` apart, all other stages are planning."""
    planning = [sum(seconds for stage, seconds in row.items() if stage != "sensing") for row in times]
    return {
        "planning_s_median": float(np.median(planning)),
        "sensing_s_median": float(np.median([row["sensing"] for row in times])),
        "wall_s": wall_s,
        "processor_s": processor_s,
    }


def surface_arrays(reference: Reference | None, recorder: RunRecorder) -> dict[str, Shaped[np.ndarray, "..."]]:
    """The visible reference points [m], when the cloud first covered each, and which the map covers at what time."""
    return {
        "points": np.zeros((0, 3), np.float32) if reference is None else reference.points.astype(np.float32),
        "covered_at": recorder.covered_at.astype(np.int16),
        "covered": np.packbits(recorder.covered, axis=1),
    }
