"""A finished sensitivity study whose counts are made up, so that its tables and report can be checked by hand.

Only numbers are made up; metals, finishes and columns are the real ones, in the amounts of the full preset.
"""

import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from materials.catalog import material, metal_names
from materials.material import RoughConductor
from render.labels.causes import HOLES
from studies.sensitivity.columns import DETECTOR_STAGES, FALSE_DEPTHS, cause_column
from studies.sensitivity.measurement import CASES, RESULT
from studies.sensitivity.plan import write_plan
from studies.sensitivity.preset import SensitivityPreset, Sweep

FINISHES = ("mirror", "polished", "bright", "brushed", "milled", "blasted")
ANGLES = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 75.0)
SWEEPS = ("metals", "repetitions", "parts", "lights", "roughness", "dots")


def write_study(out: Path, metals: tuple[str, ...] = metal_names(), finishes: tuple[str, ...] = FINISHES) -> None:
    """Write a study's folder as the command leaves it, without tables and report."""
    cases = []
    for number, (sweep, result) in enumerate(_results(metals, finishes)):
        digest = f"{number:016x}"
        for rows in result.values():
            for row in rows:
                row["case"] = digest
        folder = out / CASES / digest
        folder.mkdir(parents=True)
        (folder / RESULT).write_text(json.dumps(result))
        cases.append((sweep, digest))
    sweeps = tuple(Sweep(name=name, materials=("primer",), recovery=name == "metals") for name in SWEEPS)
    preset = SensitivityPreset(title="Made-up <study> & more", sweeps=sweeps)
    write_plan(out, preset.title, preset, cases)


def _results(metals: tuple[str, ...], finishes: tuple[str, ...]) -> Iterator[tuple[str, dict[str, list]]]:
    for metal, finish, angle, distance in product(metals, finishes, ANGLES, (0.3, 0.5)):
        yield "metals", case("plate", f"{metal}:{finish}", angle, distance)
    for finish, angle, seed in product(finishes, ANGLES, range(1, 5)):
        yield "repetitions", case("plate", f"{metals[0]}:{finish}", angle, 0.3, seed=seed)
    for part, angle in product("ABCD", (20.0, 45.0)):
        yield "parts", case(part, "own", angle, 0.3)
    for finish in finishes[:2]:
        yield "lights", case("plate", f"{metals[0]}:{finish}", 20.0, 0.31, lights=(("workshop", 150.0), ("off", 360.0)))
    for width in (3.7, 5.0):
        yield "dots", case("plate", f"{metals[0]}:{finishes[0]}", 20.0, 0.3, dots=width)
    for alpha, distance in product((0.02, 0.05, 0.1, 0.2), (0.3, 0.5)):
        yield "roughness", case("plate", f"{metals[0]}:bright@alpha={alpha}", 0.0, distance)


def case(
    subject: str,
    spec: str,
    angle: float,
    distance: float,
    seed: int = 0,
    lights: tuple[tuple[str, float], ...] = (("workshop", 150.0),),
    dots: float | None = None,
) -> dict[str, list[dict[str, Any]]]:
    """The result of one case; its counts depend on what it is of."""
    rng = np.random.default_rng([seed, *f"{subject} {spec} {angle} {distance} {dots or ''}".strip().encode()])
    surface = None if spec == "own" else material(spec)
    metal, _, finish = spec.partition(":")
    conductor = surface if isinstance(surface, RoughConductor) else None
    alpha = conductor.alpha_u if conductor else 0.3
    keys = {
        "subject": subject, "material": spec, "metal": metal if conductor else None,
        "finish": finish if conductor and "@" not in finish else None,
        "alpha_u": alpha if conductor else None, "alpha_v": conductor.alpha_v if conductor else None,
        "polar_deg": angle, "azimuth_deg": 20.0, "distance_m": distance, "seed": seed,
        "dot_fwhm_px": dots,
    }  # fmt: skip
    views = [
        keys | {"lamps": lamps, "laser_mw": laser, "main_light": k == 0} | _counts(rng, alpha)
        for k, (lamps, laser) in enumerate(lights)
    ]
    views[0] |= _detection(rng, alpha)
    if alpha < 0.1 and distance == 0.3:
        views[0] |= {"recovery_views": 4, "pb_views": 4, "missing_mm2": 900.0, "regained_mm2": 900.0 * rng.random(),
                     "pb_regained_mm2": 300.0 * rng.random()}  # fmt: skip
    if subject == "D":
        views[0] |= {"hemisphere_views": 150, "best_regained_mm2": 850.0, "recovery_views": 4, "pb_views": 4,
                     "missing_mm2": 900.0, "regained_mm2": 400.0, "pb_regained_mm2": 100.0}  # fmt: skip
    lit = {"lamps": "workshop", "laser_mw": 150.0, "main_light": True}
    incidence = [
        keys
        | {"lamps": "workshop", "laser_mw": 150.0, "main_light": True, "incidence_deg": middle}
        | _counts(rng, alpha)
        for middle in (25.0, 45.0)
    ]
    takes = [
        keys | lit | {"kind": kind, "number": k,
                "regained_share": rng.random(), "incidence_before_deg": 30.0, "incidence_deg": 80.0 * rng.random(),
                "turn_deg": 40.0}
        for kind in ("diamond", "pb")
        for k in range(4)
    ]  # fmt: skip
    return {"views": views, "incidence": incidence, "recovery_views": takes if alpha < 0.1 else []}


def _counts(rng: np.random.Generator, alpha: float) -> dict[str, Any]:
    """Counts by cause: the rougher, the fewer."""
    most = int(800 * max(0.02, 1 - alpha / 0.15))
    counts = {cause_column(cause): int(rng.integers(0, most)) for cause in (*HOLES, *FALSE_DEPTHS)}
    counts["unexplained"] = 0
    holes = sum(counts[cause_column(cause)] for cause in HOLES)
    return counts | {
        "part_pixels": 12_000, "facing_pixels": 2_000, "facing_unusable": 2 * most, "window_holes": holes + 100,
        "window_unexplained": 1, "exposure_us": 8000.0, "gain": 16.0, "blocks": 180,
    }  # fmt: skip


def _detection(rng: np.random.Generator, alpha: float) -> dict[str, Any]:
    """A detector that loses pixels at every step."""
    true = int(60 * max(0.0, 1 - alpha / 0.15))
    found, right = true + 20 if true else 0, true
    row: dict[str, Any] = {
        "reflective": true, "fine_holes": 65 * true, "hidden_holes": 20 * true, "holes_made_false": 9 * true,
        "hidden_false": 5, "fine_false": 50,
    }  # fmt: skip
    for stage in DETECTOR_STAGES:
        row |= {f"found_{stage}": found, f"right_{stage}": right}
        right = int(right * (0.6 + 0.4 * rng.random()))
        found = right + max(0, found - true) // 2
    return row | {"regions": int(true > 0), "region_mm2": 500.0, "region_missing_mm2": 300.0, "patch_mm2": 900.0,
                  "patch_found_mm2": 200.0, "region_iou": 0.2, "in_front_mm": 20.0}  # fmt: skip
