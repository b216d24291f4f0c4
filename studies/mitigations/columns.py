"""Columns of the tables of a study of mitigations."""

import pyarrow as pa

from studies.store.tables import Column

_OF_CASE = (
    Column("case", pa.string(), "Folder of the case"),
    Column("coupon", pa.string(), "Coupon by name"),
    Column("material", pa.string(), "Material by name"),
    Column("metal", pa.string(), "Metal by name; empty for others"),
    Column("finish", pa.string(), "Finish by name; empty for what is no metal"),
)
_OF_REMEDY = (
    Column("factor", pa.string(), "Remedy by name; `as set`: none"),
    Column("level", pa.string(), "How it was tried"),
)
MITIGATION_VIEW_COLUMNS = (
    *_OF_CASE,
    *_OF_REMEDY,
    Column("pose", pa.string(), "As the command line spells it: azimuth [deg], elevation [deg], distance [m]"),
    Column("seed", pa.int64(), "Of the noise"),
    Column("seen", pa.float64(), "Surface of the part before the camera [m^2]"),
    Column("right", pa.float64(), "With right depth [m^2]"),
    Column("false", pa.float64(), "With false depth [m^2]"),
)
CASE_REMEDY_COLUMNS = (
    *_OF_CASE,
    *_OF_REMEDY,
    Column("right_share", pa.float64(), "Right depth, of the surface that the poses see [0, 1]"),
    Column("lo", pa.float64(), "Lower end of its 95 % interval over poses and seeds"),
    Column("hi", pa.float64(), "Upper end"),
    Column("false_share", pa.float64(), "False depth [0, 1]"),
    Column("hole_share", pa.float64(), "No depth [0, 1]"),
    Column("error_mm", pa.float64(), "Median of |Z - truth|, mean over views [mm]"),
    Column("gain", pa.float64(), "Right share beyond the camera as it is set"),
    Column("gain_lo", pa.float64(), "Lower end of its 95 % interval, paired over poses and seeds"),
    Column("gain_hi", pa.float64(), "Upper end"),
    Column(
        "verdict",
        pa.string(),
        "helps, trades, hurts, or level with the camera as it is set; helps and hurts from two points on",
    ),
    Column("wins", pa.bool_(), "Whether it is what is advised on this case"),
    Column("is_ceiling", pa.bool_(), "Whether it changes the part itself"),
)
