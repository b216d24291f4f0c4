"""The tables of a sensitivity study: their columns, units and meanings stand here only.

Counts, not shares, are stored: shares of any group of rows are sums of counts over sums of counts.
"""

import pyarrow as pa

from franbv.reflective_regions import FILTERS
from render.labels.causes import HOLES, LEGEND, Cause
from studies.store.tables import Column

FALSE_DEPTHS = (Cause.FALSE_DEPTH_REFLECTION, Cause.FALSE_DEPTH_OTHER)
"""Labels of pixels whose depth is wrong."""


def cause_column(cause: Cause, prefix: str = "") -> str:
    """Column with the pixels of one cause."""
    return f"{prefix}{LEGEND[cause].name}"


def _cause_columns(where: str, prefix: str = "") -> tuple[Column, ...]:
    return tuple(
        Column(cause_column(cause, prefix), pa.int32(), f"{where}: {LEGEND[cause].meaning} [px]")
        for cause in (*HOLES, *FALSE_DEPTHS)
    )


KEYS = (
    Column("sweep", pa.string(), "Sweep of the preset that asked for it"),
    Column("case", pa.string(), "Folder of the case in `cases`"),
    Column("subject", pa.string(), "Coupon or part"),
    Column("material", pa.string(), "Material by name; `own` = what the real part is made of"),
    Column("metal", pa.string(), "Metal of the material; empty for others"),
    Column("finish", pa.string(), "Finish of the metal; empty for others and where the roughness was given"),
    Column("alpha_u", pa.float64(), "GGX roughness along the lay; empty unless one metal [-]"),
    Column("alpha_v", pa.float64(), "The same across the lay [-]"),
    Column("polar_deg", pa.float64(), "Angle of the view from the vertical, on the plate that of incidence [deg]"),
    Column("azimuth_deg", pa.float64(), "Azimuth of the camera [deg]"),
    Column("distance_m", pa.float64(), "From the camera to the subject's middle [m]"),
    Column("seed", pa.int32(), "Sets azimuth and noise [-]"),
    Column("dot_fwhm_px", pa.float64(), "Width of the dots in 1280x720 images, empty = the sensor's [px]"),
    Column("lamps", pa.string(), "Lamp preset"),
    Column("laser_mw", pa.float64(), "Laser power [mW]"),
    Column("main_light", pa.bool_(), "Whether detection and recovery were measured under this light"),
)

DETECTOR_STAGES = (*FILTERS, "located", "grouped")
"""Steps of the detector: the image filters, the one that gives pixels a place, clustering into regions."""

_STAGE_MEANINGS = {
    "persistent_invalid": "missing in half of the frames",
    "inside_silhouette": "and inside the silhouette",
    "inside_eroded_silhouette": "and inside the eroded silhouette",
    "located": "and with a frontier ellipsoid as first hit",
    "grouped": "and in a region",
}

DETECTION_COLUMNS = (
    Column("reflective", pa.int32(), "Decimated pixels without depth because of reflection; as all that follow, empty "
           "unless detection was measured [px]"),
    *(
        column
        for stage in DETECTOR_STAGES
        for column in (
            Column(f"found_{stage}", pa.int32(), f"Decimated pixels {_STAGE_MEANINGS.get(stage, f'and {stage}')} [px]"),
            Column(f"right_{stage}", pa.int32(), "Of them: reflective [px]"),
        )
    ),
    Column("hidden_holes", pa.int32(), "Full-resolution reflective holes in decimated pixels with depth [px]"),
    Column("holes_made_false", pa.int32(), "Full-resolution reflective holes in decimated pixels of false depth [px]"),
    Column("fine_holes", pa.int32(), "Full-resolution reflective holes [px]"),
    Column("hidden_false", pa.int32(), "Full-resolution depths, false by reflection, in decimated pixels that are not "
           "false [px]"),
    Column("fine_false", pa.int32(), "Full-resolution depths that are false by reflection [px]"),
    Column("regions", pa.int32(), "Regions found [-]"),
    Column("region_mm2", pa.float64(), "True surface inside the regions' boxes [mm^2]"),
    Column("region_missing_mm2", pa.float64(), "Of it: of the missing patch that each box overlaps best [mm^2]"),
    Column("patch_mm2", pa.float64(), "True surface of all missing patches [mm^2]"),
    Column("patch_found_mm2", pa.float64(), "Of it: in any box [mm^2]"),
    Column("region_iou", pa.float64(), "Surface in the largest region and its best patch over that in either [-]"),
    Column("in_front_mm", pa.float64(), "Distance of the largest region's points before the true surface [mm]"),
)  # fmt: skip

RECOVERY_COLUMNS = (
    Column("recovery_views", pa.int32(), "Diamond poses taken for the largest region; empty if not measured [-]"),
    Column("pb_views", pa.int32(), "Views of PB-NBV taken in their place [-]"),
    Column("hemisphere_views", pa.int32(), "Poses of a hemisphere tried to learn what was possible [-]"),
    Column("missing_mm2", pa.float64(), "True surface that the region signals and no point covers [mm^2]"),
    Column("regained_mm2", pa.float64(), "Of it: covered after the diamond poses [mm^2]"),
    Column("pb_regained_mm2", pa.float64(), "Of it: covered after the views of PB-NBV [mm^2]"),
    Column("best_regained_mm2", pa.float64(), "Of it: covered by the best single pose of the hemisphere [mm^2]"),
)

VIEW_COLUMNS = (
    *KEYS,
    Column("exposure_us", pa.float64(), "Exposure time that the camera chose [us]"),
    Column("gain", pa.float64(), "Gain that the camera chose, 16 = 1x [-]"),
    Column("part_pixels", pa.int32(), "Full-resolution pixels of the part in the measured window [px]"),
    *_cause_columns("Of them"),
    Column("facing_pixels", pa.int32(), "Those whose incidence is below B / (2 Z), inside the subject [px]"),
    Column("facing_unusable", pa.int32(), "Of them: no depth or false depth [px]"),
    Column("window_holes", pa.int32(), "Pixels without depth in the whole measured window [px]"),
    Column("window_unexplained", pa.int32(), "Of them: unexplained [px]"),
    Column("blocks", pa.int32(), "Pixels of the part after decimation [px]"),
    *_cause_columns("Of them", "blocks_"),
    *DETECTION_COLUMNS,
    *RECOVERY_COLUMNS,
)
"""`views.parquet`: a row per case and light."""

INCIDENCE_COLUMNS = (
    *KEYS,
    Column("incidence_deg", pa.float64(), "Middle of the bin of true incidence angles [deg]"),
    Column("part_pixels", pa.int32(), "Full-resolution pixels of the part in the bin [px]"),
    *_cause_columns("Of them"),
)
"""`incidence.parquet`: a row per case, light and bin of the angle between surface normal and view ray."""

RECOVERY_VIEW_COLUMNS = (
    *KEYS,
    Column("kind", pa.string(), "diamond, pb, or best = the one of the hemisphere that regains most"),
    Column("number", pa.int32(), "Of the view, from 0 [-]"),
    Column("regained_share", pa.float64(), "Share of the missing surface that this view alone covers [-]"),
    Column("incidence_before_deg", pa.float64(), "Mean angle of incidence on it in the view that saw the hole [deg]"),
    Column("incidence_deg", pa.float64(), "The same in this view [deg]"),
    Column("turn_deg", pa.float64(), "Mean angle between the two views' rays on it [deg]"),
)
"""`recovery_views.parquet`: a row per view that was taken to recover a region."""
