"""The few solids of the corpus, with the volumes that geometry books give [mm, mm^3]."""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True, eq=False)
class Solid:
    """A closed surface of flat polygons."""

    points: np.ndarray
    """(n, 3) [mm]."""
    polygons: tuple[tuple[int, ...], ...]
    """Corners of each, counter-clockwise from outside."""
    triangles: tuple[tuple[int, int, int], ...]
    """The same surface, cut by hand."""
    volume: float
    """[mm^3]."""

    def moved(self, x: float, y: float, z: float) -> "Solid":
        """Shifted [mm]."""
        return replace(self, points=self.points + np.array([x, y, z]))

    @property
    def low(self) -> np.ndarray:
        """Lowest corner of the bounding box [mm]."""
        return self.points.min(axis=0)

    @property
    def high(self) -> np.ndarray:
        """Highest corner [mm]."""
        return self.points.max(axis=0)


def prism(outline: list[tuple[float, float]], cap: list[tuple[int, int, int]], height: float, area: float) -> Solid:
    """Upright prism; `cap` is the outline (counter-clockwise from above) cut into triangles by hand.

    No side stands on a bridge, which the outline runs both ways.
    """
    count = len(outline)
    steps = {(outline[i], outline[(i + 1) % count]) for i in range(count)}
    walls = [i for i in range(count) if (outline[(i + 1) % count], outline[i]) not in steps]
    points = np.array([(x, y, z) for z in (0.0, height) for x, y in outline])
    top = tuple(count + i for i in range(count))
    bottom = tuple(reversed(range(count)))
    sides = tuple((i, (i + 1) % count, count + (i + 1) % count, count + i) for i in walls)
    triangles = [
        *((a + count, b + count, c + count) for a, b, c in cap),
        *((c, b, a) for a, b, c in cap),
        *(half for a, b, c, d in sides for half in ((a, b, c), (a, c, d))),
    ]
    return Solid(points, (top, bottom, *sides), tuple(triangles), area * height)


def block(x: float, y: float, z: float) -> Solid:
    """Box with a corner at the origin."""
    return prism([(0, 0), (x, 0), (x, y), (0, y)], [(0, 1, 2), (0, 2, 3)], z, x * y)


BASE = block(40, 30, 20)
KNOB = block(10, 10, 10).moved(50, 0, 0)
ANGLE = prism(
    [(40, 10), (10, 10), (10, 30), (0, 30), (0, 0), (40, 0)],
    [(4, 5, 0), (4, 0, 1), (4, 1, 2), (4, 2, 3)],
    20,
    40 * 10 + 10 * 20,
)
"""An L, 40 x 30 mm with legs 10 mm wide: its caps are concave hexagons, whose fan from the first corner has 1200 mm^2
instead of 600."""
FRAME = prism(
    [(0, 0), (40, 0), (40, 40), (0, 40), (0, 0), (10, 10), (10, 30), (30, 30), (30, 10), (10, 10)],
    [(0, 1, 8), (0, 8, 9), (1, 2, 7), (1, 7, 8), (2, 3, 6), (2, 6, 7), (3, 4, 5), (3, 5, 6)],
    10,
    40 * 40 - 20 * 20,
)
"""A square ring: the outline runs round, over a bridge from corner to corner, and round the hole backwards."""
