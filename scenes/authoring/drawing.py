"""What a part's drawing hands over, and the turned and hexagonal shapes that fittings are made of. In mm, z up."""

# pyright: reportMissingImports=false
from dataclasses import dataclass

from build123d import Axis, Location, Plane, Polyline, RegularPolygon, Shape, Solid, extrude, make_face, revolve

from scenes.scene import Mesh


@dataclass(frozen=True)
class DrawnBody:
    """Solids of one material. Each is closed; they may overlap where a spigot sits in its hole."""

    name: str
    solids: tuple[Shape | Mesh, ...]
    material: str
    """Catalogue name: `metal:finish` or a non-metal."""
    why: str
    """Why the real thing has this surface."""


@dataclass(frozen=True)
class DrawnPart:
    """One of the parts that `scenes.parts` knows by name."""

    name: str
    description: str
    bodies: tuple[DrawnBody, ...]


def turned(profile: list[tuple[float, float]]) -> Solid:
    """Solid of revolution about z of a closed half section, points (radius, height) [mm]."""
    section = make_face(Polyline(*((r, 0.0, z) for r, z in [*profile, profile[0]])))
    return revolve(section, Axis.Z).solid()


def tube(outer: float, inner: float, bottom: float, top: float, edge: float = 0.5) -> Solid:
    """Tube of the given radii between two heights, outer edges broken by `edge` [mm]."""
    rim = outer - edge
    return turned(
        [(inner, bottom), (rim, bottom), (outer, bottom + edge), (outer, top - edge), (rim, top), (inner, top)]
    )


def hexagon(across_flats: float, bottom: float, top: float, bore: float) -> Shape:
    """Hexagon with round bore (radius) between two heights [mm]; 30 deg chamfers from 95 % of the flats."""
    prism = Plane.XY.offset(bottom) * extrude(RegularPolygon(across_flats / 2, 6, major_radius=False), top - bottom)
    corner = across_flats / 3**0.5 + 0.01
    rim = 0.95 * across_flats / 2
    drop = (corner - rim) / 3**0.5
    ends = [(bore, bottom), (rim, bottom), (corner, bottom + drop), (corner, top - drop), (rim, top), (bore, top)]
    return prism & turned(ends)


def along(x: float, y: float, z: float, toward: str) -> Location:
    """Where a fitting drawn along +z sits: its foot at (x, y, z) [mm], its axis `toward` "+x", "-y", "+z" ..."""
    direction = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}[toward[1]]
    sign = 1 if toward[0] == "+" else -1
    return Plane(origin=(x, y, z), z_dir=tuple(sign * c for c in direction)).location
