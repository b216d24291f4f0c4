"""Counts of views that were not measured, so that bins and pages can be checked by hand."""

from typing import Any

from render.labels.causes import HOLES, Cause
from studies.safe_angles.views import AnglesView
from studies.sensitivity.columns import FALSE_DEPTHS, cause_column


def row(middle_deg: float, pixels: int, **lost: int) -> dict[str, Any]:
    """A bin of one view: pixels of the part, and what is lost to causes by their names."""
    none = {cause_column(cause): 0 for cause in (*HOLES, *FALSE_DEPTHS)}
    assert set(lost) <= set(none)
    return {"incidence_deg": middle_deg, "part_pixels": pixels, **none, **lost}


def counted(view: AnglesView, pixels: int = 1000) -> dict[str, list[dict[str, Any]]]:
    """What a view might count: blasted surfaces are right between 20 and 50 deg, others nowhere; flat views see steep
    angles and steep ones flat angles, all see 20 to 50 deg."""
    keys = {"case": view.digest, "subject": view.subject, "material": view.material, "polar_deg": view.polar_deg}
    dark, window = cause_column(Cause.REFLECTION_DARK), cause_column(Cause.OCCLUSION_WINDOW)
    good = view.material.endswith("blasted")
    middles = (25.0, 35.0, 45.0, *((55.0, 65.0) if view.seed % 2 else (5.0, 15.0)))
    inside = [keys | row(middle, pixels, **{dark: 2 if good else pixels // 2}) for middle in middles[:3]]
    outside = [keys | row(middle, pixels, **{window: pixels // 3}) for middle in middles[3:]]
    total = {"part_pixels": pixels * len(middles)}
    return {"views": [keys | total], "incidence": [*inside, *outside] if pixels else [], "recovery_views": []}
