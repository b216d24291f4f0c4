"""`acquisitions.parquet`: one row per acquisition of a run. The columns, their units and meanings stand here only."""

from collections.abc import Iterable, Mapping

import pyarrow as pa

from franbv.evaluation.coverage import MAP_MEASURE, MEASURES, CoveringSet, Measure
from studies.store.tables import Column

FIRST, NBV, RECOVERY = "first", "nbv", "recovery"
"""Kinds of acquisition: the given first view, a next best view, a recovery view of a reflective region."""


MAP_COVERAGE, MAP_INCREMENT = "coverage_map_5mm", "increment_map_5mm"
"""The headline, by MAP_MEASURE, and what an acquisition changed of it."""
RAW_COVERAGE = "coverage_5mm"
"""Of the growing cloud, by RAW_MEASURE."""
MISSING_BELIEVED = "missing_believed"
"""What the planner believes the map to lack."""

_COUNTED_WORDS: dict[CoveringSet, str] = {
    "raw": "the cloud",
    "filtered": "the cloud's points in voxels that are occupied after this acquisition",
    "voxel": "the centres of the object's occupied voxels",
}


def coverage_column(measure: Measure) -> str:
    """Name of a coverage: `coverage_2_5mm` of the cloud, `filtered_coverage_5mm`, `voxel_coverage_5mm_with_base`."""
    prefix = "" if measure.counted == "raw" else f"{measure.counted}_"
    name = f"{prefix}coverage_{1000 * measure.tolerance:g}mm".replace(".", "_")
    return f"{name}_with_base" if measure.with_base else name


def coverage_figures(found: Mapping[Measure, float]) -> dict[str, float]:
    """Coverages by the names of their columns, the headline first."""
    return {MAP_COVERAGE: found[MAP_MEASURE], **{coverage_column(m): value for m, value in found.items()}}


def _coverages() -> Iterable[Column]:
    same = f"the same number as {coverage_column(MAP_MEASURE)}"
    yield Column(MAP_COVERAGE, pa.float64(), f"Coverage of the map at 5 mm, {same} [-]")
    yield Column(MAP_INCREMENT, pa.float64(), "What this acquisition changed of it; below 0 where it was carved [-]")
    for measure in MEASURES:
        surface = "visible surface and the base face" if measure.with_base else "visible surface"
        near = f"within {1000 * measure.tolerance:g} mm of {_COUNTED_WORDS[measure.counted]}"
        yield Column(
            coverage_column(measure), pa.float64(), f"Share of the {surface} {near}, after this acquisition [-]"
        )


ACQUISITION_COLUMNS = (
    Column("acquisition", pa.int32(), "Number of the acquisition, from 0 [-]"),
    Column("kind", pa.string(), "first, nbv or recovery"),
    Column("iteration", pa.int32(), "NBV iteration that it belongs to; 0 = the first view [-]"),
    Column("activation", pa.int32(), "Recovery activation that it belongs to, from 1; empty for other views [-]"),
    Column("position", pa.list_(pa.float64(), 3), "Origin of the left imager, world frame [m]"),
    Column("quaternion_xyzw", pa.list_(pa.float64(), 4), "Orientation of the left imager, world frame [-]"),
    Column("utility", pa.float64(), "U or U_r of the chosen pose; empty for the first view [px^2]"),
    Column("unreachable", pa.int32(), "Candidate poses that the arm could not reach [-]"),
    Column("valid_share", pa.float64(), "Share of the pixels with depth in more than half of the frames [-]"),
    Column("pixels", pa.int32(), "Pixels of the depth image [px]"),
    Column("invalid_pixels", pa.int32(), "Frequently invalid pixels, |I| [px]"),
    Column("silhouette_pixels", pa.int32(), "Pixels of the projected ellipsoids, |I_o| [px]"),
    Column("candidate_pixels", pa.int32(), "Invalid pixels well inside the silhouette, |I_c| [px]"),
    Column("reflective_pixels", pa.int32(), "Candidates whose ray first meets a frontier ellipsoid [px]"),
    Column("regions", pa.int32(), "Reflective regions found [-]"),
    Column("recovery_poses", pa.int32(), "Poses for the recovery that this acquisition sets off; empty if none [-]"),
    Column(
        MISSING_BELIEVED,
        pa.float64(),
        "Share of the surface that the planner believes the map lacks; empty without an idea [-]",
    ),
    Column("gamma", pa.float64(), "Gamma after a recovery view; empty for other views [-]"),
    Column("gamma_attainable", pa.float64(), "Gamma over what a surface patch can attain; empty for other views [-]"),
    Column("occupied_voxels", pa.int32(), "Occupied voxels of the object [-]"),
    Column("frontier_voxels", pa.int32(), "Frontier voxels [-]"),
    Column("occupied_ellipsoids", pa.int32(), "K_o [-]"),
    Column("frontier_ellipsoids", pa.int32(), "K_f [-]"),
    Column("points", pa.int32(), "Points that this acquisition adds to the cloud [-]"),
    *_coverages(),
    Column("motion_s", pa.float64(), "Modelled time of the arm's motion to this pose [s]"),
)
