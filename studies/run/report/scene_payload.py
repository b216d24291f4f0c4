"""The numbers behind the page's 3-D scene: surface, cloud, ellipsoids, regions and cameras of every acquisition.

Lengths are whole tenths of a millimetre in base64 int16 arrays: compact, exact enough to look at.
"""

import base64
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from studies.base.console import strict_json
from studies.run.acquisition_table import MAP_COVERAGE
from studies.store.views import StoredView

UNIT = 1e-4
"""Length of one count [m]."""
REACH = 3.2
"""Coordinates are clipped to +-this [m]: the range of 16 bits at UNIT, far beyond any workspace."""
MOST_POINTS = 24_000
"""Points of the cloud that are drawn. Choice: more do not look denser and turn less smoothly."""


def scene_payload(
    rows: Sequence[Mapping[str, Any]],
    views: Sequence[StoredView],
    cloud: Float[np.ndarray, "n 3"],
    cloud_acquisition: Int[np.ndarray, "n"],
    surface: Float[np.ndarray, "m 3"],
    surface_covered: Bool[np.ndarray, "k m"],
) -> str:
    """JSON for the viewer.

    cloud, cloud_acquisition: the points [m] and the acquisition that saw each.
    surface, surface_covered: reference points [m], and whether the map covers each after each acquisition.
    """
    step = max(1, -(-len(cloud) // MOST_POINTS))
    return strict_json(
        {
            "unit": UNIT,
            "cloud": {"at": packed(cloud[::step]), "acquisition": packed(cloud_acquisition[::step], 1.0)},
            "surface": {"at": packed(surface)},
            "views": [
                _view(row, view) | {"covered": base64.b64encode(np.packbits(covered).tobytes()).decode()}
                for row, view, covered in zip(rows, views, surface_covered, strict=True)
            ],
        }
    ).replace("</", "<\\/")  # nothing may end the script element early


def packed(values: np.ndarray, unit: float = UNIT) -> str:
    """Values as base64 of little-endian int16 counts of `unit`."""
    counts = np.rint(np.clip(np.asarray(values, float) / unit, -REACH / UNIT, REACH / UNIT))
    return base64.b64encode(counts.astype("<i2").tobytes()).decode()


def _view(row: Mapping[str, Any], view: StoredView) -> dict[str, Any]:
    return {
        "kind": row["kind"],
        "iteration": row["iteration"],
        "activation": row["activation"],
        "coverage": None if row[MAP_COVERAGE] is None else round(row[MAP_COVERAGE], 5),
        "camera": packed(frustum(view)),
        "ellipsoids": packed(ellipsoid_rows(view)),
        "frontier": [int(is_frontier) for is_frontier in view.ellipsoid_is_frontier],
        "regions": packed(np.array([box.corners() for box in view.regions])),
    }


def ellipsoid_rows(view: StoredView) -> Float[np.ndarray, "k 4 3"]:
    """Centre and the columns of a factor L of each shape S = L L^T [m]: the ellipsoid is centre + L u, |u| <= 1."""
    factors = np.linalg.cholesky(view.ellipsoid_shapes)
    return np.concatenate([view.ellipsoid_centres[:, None], np.swapaxes(factors, 1, 2)], axis=1)


def frustum(view: StoredView, length: float = 0.022) -> Float[np.ndarray, "5 3"]:
    """The camera's centre and the four corners of its image at `length` before it, world frame [m]."""
    i = view.intrinsics
    u = np.array([-0.5, i.width - 0.5, i.width - 0.5, -0.5])
    v = np.array([-0.5, -0.5, i.height - 0.5, i.height - 0.5])
    corners = length * np.column_stack([(u - i.cx) / i.fx, (v - i.cy) / i.fy, np.ones(4)])
    return view.pose.apply(np.vstack([np.zeros(3), corners]))
