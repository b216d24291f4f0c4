"""Triangles of a CAD solid with the exact normals of its surfaces and texture coordinates along the lay.

Smooth shading needs the normal of the true surface: facets of a polished fitting would mirror the dots facet by facet.
Each CAD face is its own chart, so vertices are doubled along the edges between faces, with bit-equal positions.
"""

# pyright: reportMissingImports=false
import numpy as np
from build123d import Face, Shape
from jaxtyping import Float, Int
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepGProp import BRepGProp_Face
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.gp import gp_Pnt, gp_Vec
from OCP.TopAbs import TopAbs_Orientation
from OCP.TopLoc import TopLoc_Location
from scipy.spatial import KDTree

from scenes.lay import planar_lay
from scenes.scene import Mesh
from scenes.topology import face_normals

CHORD_TOLERANCE_MM = 0.04
"""Largest distance of a triangle from its surface [mm] (choice: 1/20 of the 0.8 mm that a pixel covers at 0.28 m)."""
ANGLE_TOLERANCE = 0.3
"""Largest turn of the surface along an edge [rad]; OCCT halves it on full circles, so 42 facets around (choice)."""
WELD_TOLERANCE_MM = 1e-4
"""Nodes of neighbouring faces nearer than this are one point; OCCT builds them equal to about 1e-7 mm [mm]."""


def tessellate(shape: Shape) -> Mesh:
    """Mesh [m] of all faces of `shape` (drawn in mm), outward, with analytic normals and metric UVs along the lay."""
    BRepMesh_IncrementalMesh(shape.wrapped, CHORD_TOLERANCE_MM, False, ANGLE_TOLERANCE, False)
    charts = [_chart(face) for face in shape.faces()]
    offsets = np.cumsum([0, *(len(points) for points, *_ in charts)])
    points = np.concatenate([chart[0] for chart in charts])
    faces = np.concatenate([chart[1] + offset for chart, offset in zip(charts, offsets, strict=False)])
    normals = np.concatenate([chart[2] for chart in charts])
    uvs = np.concatenate([chart[3] for chart in charts])
    points, place = _welded(points)
    ids = place[faces]
    whole = (ids[:, 0] != ids[:, 1]) & (ids[:, 1] != ids[:, 2]) & (ids[:, 2] != ids[:, 0])  # poles collapse
    return Mesh(points / 1000, faces[whole], uvs / 1000, normals)


def _chart(
    face: Face,
) -> tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "m 3"], Float[np.ndarray, "n 3"], Float[np.ndarray, "n 2"]]:
    """Nodes [mm], triangles, outward unit normals and texture coordinates [mm] of one CAD face."""
    location = TopLoc_Location()
    triangulation = BRep_Tool.Triangulation_s(face.wrapped, location)
    transformation = location.Transformation()
    count = range(1, triangulation.NbNodes() + 1)
    nodes = [triangulation.Node(i).Transformed(transformation) for i in count]
    points = np.array([[p.X(), p.Y(), p.Z()] for p in nodes])
    parameters = np.array([[triangulation.UVNode(i).X(), triangulation.UVNode(i).Y()] for i in count])
    triangles = np.array([[t.Value(1), t.Value(2), t.Value(3)] for t in triangulation.Triangles()]) - 1
    if face.wrapped.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
        triangles = triangles[:, ::-1]
    normals = _surface_normals(face, parameters, points, triangles)
    return points, triangles, normals, _texture_coordinates(face, parameters, points, normals)


def _surface_normals(
    face: Face,
    parameters: Float[np.ndarray, "n 2"],
    points: Float[np.ndarray, "n 3"],
    triangles: Int[np.ndarray, "m 3"],
) -> Float[np.ndarray, "n 3"]:
    """Outward unit normals of the CAD surface; at a pole, where it has none, the mean of the triangles around it."""
    surface, point, vector = BRepGProp_Face(face.wrapped), gp_Pnt(), gp_Vec()
    normals = np.zeros((len(points), 3))
    for i, (u, v) in enumerate(parameters):
        surface.Normal(u, v, point, vector)
        normals[i] = vector.X(), vector.Y(), vector.Z()
    fallback = np.zeros_like(normals)
    for corner in range(3):
        np.add.at(fallback, triangles[:, corner], face_normals(points, triangles))
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    singular = lengths[:, 0] < 1e-6 * lengths.max()
    normals = np.where(singular[:, None], fallback, normals)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _texture_coordinates(
    face: Face,
    parameters: Float[np.ndarray, "n 2"],
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
) -> Float[np.ndarray, "n 2"]:
    """Texture coordinates [mm]: planes are machined along their longest side, round surfaces around their axis."""
    surface = BRepAdaptor_Surface(face.wrapped)
    if surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Plane:
        lay = planar_lay(points, normals[0])
        return np.column_stack([points @ lay, points @ np.cross(normals[0], lay)])
    return parameters * _parameter_speeds(surface, parameters)


def _parameter_speeds(surface: BRepAdaptor_Surface, parameters: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "2"]:
    """Mean length of the surface per unit of its two parameters [mm]; u goes round the axis of turned surfaces."""
    point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
    speeds = []
    for u, v in parameters:
        surface.D1(u, v, point, along_u, along_v)
        speeds.append([along_u.Magnitude(), along_v.Magnitude()])
    return np.mean(speeds, axis=0)


def _welded(points: Float[np.ndarray, "n 3"]) -> tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "n"]]:
    """The points with neighbours moved onto the first of their group, and the group of each."""
    first = np.arange(len(points))
    for a, b in sorted(KDTree(points).query_pairs(WELD_TOLERANCE_MM)):
        first[b] = min(first[b], first[a])
    return points[first], first
