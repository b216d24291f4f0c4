"""Sheet metal folded along parallel bends, in mm: the angle bracket of E1 and the U brackets of E4."""

# pyright: reportMissingImports=false
from itertools import pairwise

import numpy as np
from build123d import Axis, Polyline, Shape, Vertex, extrude, fillet, make_face
from jaxtyping import Float

GALVANISED = "stainless_austenitic:bright"
"""Stand-in for galvanised sheet. The catalogue has no zinc: what refractiveindex.info's tables give at 850 nm, normal
reflectances of 0.665 (Querry) and 0.730 (Werner's calculation), encloses this steel's 0.691."""
WHY_GALVANISED = (
    "galvanised sheet, rolled smooth, blurs mirror images; zinc has no trusted constants, and its reflectance at 850 nm"
    " (0.67 to 0.73) is about that of stainless steel (0.69)"
)


def folded(path: list[tuple[float, float]], thickness: float, length: float, bend: float) -> Shape:
    """Sheet along `path` (its middle, in the xy plane), `length` high from z = 0, bent with the inner radius `bend`."""
    points = np.array(path, float)
    outline = np.concatenate([_beside(points, thickness / 2), _beside(points, -thickness / 2)[::-1]])
    sheet = extrude(make_face(Polyline(*map(tuple, outline), tuple(outline[0]))), length)
    for corner, turn in zip(points[1:-1], _turns(points), strict=True):
        upright = sheet.edges().filter_by(Axis.Z).sort_by_distance(Vertex(*corner, length / 2))[:2]
        inner_first = sorted(upright, key=lambda edge, c=corner, t=turn: _outwardness(edge, c, t))
        # One at a time: the first fillet leaves the other edge as it is.
        sheet = fillet(inner_first[0], bend)
        far = inner_first[1].center()
        outer = sheet.edges().filter_by(Axis.Z).sort_by_distance(Vertex(far.X, far.Y, length / 2))[0]
        sheet = fillet(outer, bend + thickness)
    return sheet


def _beside(points: Float[np.ndarray, "n 2"], distance: float) -> Float[np.ndarray, "n 2"]:
    """The path moved to its left by `distance`, mitred at its corners."""
    along = np.diff(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    left = np.column_stack([-along[:, 1], along[:, 0]])
    before, after = np.concatenate([left[:1], left]), np.concatenate([left, left[-1:]])
    return points + distance * (before + after) / (1 + np.sum(before * after, axis=1, keepdims=True))


def _turns(points: Float[np.ndarray, "n 2"]) -> list[Float[np.ndarray, "2"]]:
    """At each bend, the direction from its inner to its outer side."""
    along = np.diff(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    return [before - after for before, after in pairwise(along)]


def _outwardness(edge: Shape, corner: Float[np.ndarray, "2"], turn: Float[np.ndarray, "2"]) -> float:
    middle = edge.center()
    return float(np.dot(np.array([middle.X, middle.Y]) - corner, turn))
