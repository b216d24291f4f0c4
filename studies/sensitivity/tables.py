"""The tables of a study, gathered from the folders of its finished cases, and the figures that sum them up."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.base.case_folder import finished_case
from studies.base.reading import reading
from studies.sensitivity.columns import INCIDENCE_COLUMNS, RECOVERY_VIEW_COLUMNS, VIEW_COLUMNS
from studies.sensitivity.measurement import CASES, RESULT
from studies.sensitivity.rules import pb_regained, precision, recall, regained
from studies.sensitivity.shares import Row, column_share, false_depth, holes, part_pixels, pooled_share
from studies.store.tables import Column, write_rows

TABLES: Mapping[str, Sequence[Column]] = {
    "views": VIEW_COLUMNS,
    "incidence": INCIDENCE_COLUMNS,
    "recovery_views": RECOVERY_VIEW_COLUMNS,
}
"""Tables by name, each a file NAME.parquet of the study and a list of rows in the result of every case."""


@dataclass(frozen=True)
class Tables:
    """Rows of all finished cases, in the order of the preset; a case of two sweeps has rows for both."""

    views: list[Row]
    incidence: list[Row]
    recovery_views: list[Row]

    def rows(self, name: str) -> list[Row]:
        """A table by its name."""
        return getattr(self, name)


def gather_tables(out: Path, cases: Iterable[tuple[str, str]]) -> Tables:
    """Read the results of those cases, given by sweep and folder, that are finished."""
    rows: dict[str, list[Row]] = {name: [] for name in TABLES}
    for sweep, digest in cases:
        folder = finished_case(out / CASES, digest)
        if folder is not None:
            with reading(folder / RESULT, "copy the study whole, or give its command again with another --out"):
                result = json.loads((folder / RESULT).read_text(encoding="utf-8"))
                for name, columns in TABLES.items():
                    names = [column.name for column in columns]
                    rows[name] += [{key: row.get(key) for key in names} | {"sweep": sweep} for row in result[name]]
    return Tables(**rows)


def write_tables(out: Path, tables: Tables) -> None:
    """Write every table as Parquet."""
    for name, columns in TABLES.items():
        write_rows(out / f"{name}.parquet", columns, tables.rows(name))


def main_rows(tables: Tables) -> list[Row]:
    """Views of the sensor's own dots under the first light of their case, each once."""
    return [row for row in of_own_dots(_once(tables)) if row["main_light"]]


def of_own_dots(rows: Iterable[Row]) -> list[Row]:
    """Those whose dots are as wide as the study's sensor has them."""
    return [row for row in rows if row["dot_fwhm_px"] is None]


def _once(tables: Tables) -> list[Row]:
    """Views without the repetitions of cases that two sweeps share."""
    return list({(row["case"], row["lamps"], row["laser_mw"]): row for row in tables.views}.values())


def study_summary(tables: Tables) -> dict[str, Any]:
    """The study's figures; shares are pooled over all cases, null where there is nothing to have a share of.

    Holes and false depth: of the part's pixels. Unexplained: of all pixels without depth. Detection: decimated pixels
    in regions against those without depth because of reflection. Recovery: of the missing surface that the regions
    signal, what the diamond poses regain, and what as many views of PB-NBV do.
    """
    once = _once(tables)
    main = main_rows(tables)
    return {
        "cases": len({row["case"] for row in once}),
        "unexplained_share": column_share(once, "window_unexplained", "window_holes"),
        "hole_share": pooled_share(main, holes, part_pixels),
        "false_depth_share": pooled_share(main, false_depth, part_pixels),
        "detection_precision": precision(main),
        "detection_recall": recall(main),
        "recovered_share": regained(main),
        "pb_recovered_share": pb_regained(main),
    }
