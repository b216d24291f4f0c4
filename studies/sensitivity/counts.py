"""Pixels of a labelled view by cause: over the part, over bins of true incidence, and where it faces the camera."""

from typing import Any

import cv2
import numpy as np
from jaxtyping import Bool, UInt8

from materials.material import RoughConductor
from render.d435i import SimulatedD435i
from render.labels.causes import HOLES, Cause, is_hole
from render.labels.outcome import blocks
from render.world.scene_geometry import NO_BODY
from render.world.truth import Truth, looks_at_part
from studies.sensitivity.cases import LitCase
from studies.sensitivity.columns import FALSE_DEPTHS, cause_column
from studies.sensitivity.preset import OWN
from studies.sensitivity.views import LitView

INCIDENCE_BIN_DEG = 10.0
"""Width of a bin of incidence angles [deg] (choice: some hundred pixels of a small coupon in each)."""
OUTLINE_PX = 9
"""Pixels nearer to the part's outline than this do not count as facing [px] (choice: a census window, so that only the
surface itself decides)."""


def view_keys(config: LitCase, view: LitView) -> dict[str, Any]:
    """What the rows of a view begin with."""
    metal, _, finish = config.material.partition(":")
    surface = None if config.material == OWN else view.camera.scene.part_bodies[0].material
    conductor = surface if isinstance(surface, RoughConductor) else None
    return {
        "case": config.digest,
        "subject": config.subject,
        "material": config.material,
        "metal": metal if conductor else None,
        "finish": finish if conductor and "@" not in finish else None,
        "alpha_u": conductor.alpha_u if conductor else None,
        "alpha_v": conductor.alpha_v if conductor else None,
        "polar_deg": config.polar_deg,
        "azimuth_deg": config.azimuth_deg,
        "distance_m": config.distance_m,
        "seed": config.seed,
        "dot_fwhm_px": config.dot_fwhm_px,
        "lamps": view.light.lamps,
        "laser_mw": view.light.laser_mw,
        "main_light": view.light == config.lights[0],
    }


def view_counts(view: LitView) -> dict[str, Any]:
    """Counts of one view, by the names of the columns of `views.parquet`."""
    camera, labels, truth = view.camera, view.labels, view.truth
    part = looks_at_part(truth, camera.world.source) & (labels.cause != Cause.UNMEASURED)
    part_blocks = blocks(part, camera).mean(axis=-1) > 0.5
    facing = facing_pixels(camera, truth, part)
    unusable = is_hole(labels.cause) | labels.false_depth
    return {
        "exposure_us": view.measurement.imager.exposure_us,
        "gain": view.measurement.imager.gain,
        "part_pixels": int(part.sum()),
        **cause_counts(labels.picture[part]),
        "facing_pixels": int(facing.sum()),
        "facing_unusable": int(np.count_nonzero(facing & unusable)),
        "window_holes": int(is_hole(labels.cause).sum()),
        "window_unexplained": int(np.count_nonzero(labels.cause == Cause.UNEXPLAINED)),
        "blocks": int(part_blocks.sum()),
        **cause_counts(labels.picture_decimated[part_blocks], "blocks_"),
    }


def incidence_counts(view: LitView) -> list[dict[str, Any]]:
    """Counts of one view in bins of true incidence, by the names of the columns of `incidence.parquet`."""
    labels, truth = view.labels, view.truth
    part = looks_at_part(truth, view.camera.world.source) & (labels.cause != Cause.UNMEASURED)
    number = np.full(part.shape, -1)
    number[part] = (np.degrees(truth.incidence[part]) // INCIDENCE_BIN_DEG).astype(int)
    return [
        {
            "incidence_deg": (k + 0.5) * INCIDENCE_BIN_DEG,
            "part_pixels": int(np.count_nonzero(number == k)),
            **cause_counts(labels.picture[number == k]),
        }
        for k in np.unique(number[part]).tolist()
    ]


def cause_counts(labels: UInt8[np.ndarray, "n"], prefix: str = "") -> dict[str, int]:
    """Pixels of every cause of missing or false depth."""
    found = np.bincount(labels, minlength=NO_BODY + 1)
    return {cause_column(cause, prefix): int(found[cause]) for cause in (*HOLES, *FALSE_DEPTHS)}


def facing_pixels(camera: SimulatedD435i, truth: Truth, part: Bool[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Pixels of the part where a mirror would send the projector's light back to the camera, away from its outline.

    There the half-vectors between projector and either imager differ by B / (2 Z), and lie about as near to the normal.
    """
    inside = cv2.erode(part.astype(np.uint8), np.ones((2 * OUTLINE_PX + 1,) * 2, np.uint8)) > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        return inside & (truth.incidence < camera.rig.baseline / (2 * truth.depth))
