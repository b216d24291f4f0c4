"""A measurement of planning times made by hand: RE scores slower than PB in proportion to the size, all else alike."""

from typing import Any

from studies.comparison.planning_speed import goals

SIZES = {"voxels": (64, 128), "candidates": (32, 128), "pixels": (60, 160)}


def made_speed(map_s: float = 0.01) -> dict[str, Any]:
    """PB: map, object 10 ms, ellipsoids 20 ms, candidates 1 ms, scoring 2 ms; RE: the same without ellipsoids, scoring
    1 ms for each unit of size."""
    rows = [
        {
            "axis": axis, "size": size, "planner": planner, "map": map_s, "object": 0.01,
            "ellipsoids": 0.02 if planner == "pb" else 0.0, "candidates": 0.001,
            "score": 0.002 if planner == "pb" else 0.001 * size,
            "map_voxels": size**3 if axis == "voxels" else 442764, "poses": size if axis == "candidates" else 32,
            "rays": 40 * size if axis == "pixels" else 2400, "object_voxels": 900,
        }
        for axis, sizes in SIZES.items() for size in sizes for planner in ("pb", "re")
    ]  # fmt: skip
    return {"machine": "2 x Processor, load 0.0, Python 3.11.2", "rows": rows}


def with_goals(**made: float) -> dict[str, Any]:
    """The measurement with the goals beside it."""
    speed = made_speed(**made)
    return {**speed, "goals": goals(speed["rows"])}
