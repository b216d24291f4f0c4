"""OBJ and PLY files of the corpus: polygons on vertices."""

import struct

from tests.corpus.solids import Solid


def obj_lines(solid: Solid, first: int = 1, corner: str = "{0}") -> list[str]:
    """Vertices and polygons; `first` is the number of the first vertex, `corner` how a corner is written."""
    vertices = ["v " + " ".join(f"{value:g}" for value in point) for point in solid.points]
    return vertices + ["f " + " ".join(corner.format(i + first) for i in polygon) for polygon in solid.polygons]


def obj_backwards(solid: Solid) -> list[str]:
    """The same with corners counted back from the last vertex so far."""
    return obj_lines(solid, first=-len(solid.points))


def ply_header(order: str, solid: Solid, vertices: int | None = None, faces: int | None = None, more: str = "") -> str:
    """Header; `vertices` and `faces` are what it announces instead of the truth."""
    return (
        f"ply\nformat {order} 1.0\ncomment made\nelement vertex {vertices or len(solid.points)}\n"
        f"property float x\nproperty float y\nproperty float z\n{more}"
        f"element face {faces or len(solid.polygons)}\nproperty list uchar int vertex_indices\nend_header\n"
    )


def ply_text(solid: Solid) -> str:
    """Body of a text PLY."""
    rows = [" ".join(f"{value:g}" for value in point) for point in solid.points]
    rows += [" ".join(map(str, (len(polygon), *polygon))) for polygon in solid.polygons]
    return "\n".join(rows) + "\n"


def ply_binary(solid: Solid, order: str) -> bytes:
    """Body of a binary PLY; `order` is `<` or `>`."""
    body = b"".join(struct.pack(f"{order}3f", *point) for point in solid.points)
    return body + b"".join(
        struct.pack(f"{order}B{len(polygon)}i", len(polygon), *polygon) for polygon in solid.polygons
    )
