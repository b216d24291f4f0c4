"""STL files of the corpus, binary and text."""

import struct

import numpy as np

from tests.corpus.solids import Solid


def binary(solid: Solid, header: bytes = b"", count: int | None = None) -> bytes:
    """A binary STL; `count` is what its header announces instead of the truth."""
    corners = solid.points[np.array(solid.triangles)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rows = [
        struct.pack("<12fH", *normal, *triangle.ravel(), 0) for normal, triangle in zip(normals, corners, strict=True)
    ]
    return header.ljust(80, b"\0") + struct.pack("<I", len(rows) if count is None else count) + b"".join(rows)


def text(solid: Solid, name: str = "", end: bool = True) -> str:
    """A solid of a text STL, with or without its last line."""
    lines = [f"solid {name}".rstrip()]
    for triangle in solid.points[np.array(solid.triangles)]:
        a, b, c = triangle
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        lines += ["  facet normal " + _numbers(normal), "    outer loop"]
        lines += ["      vertex " + _numbers(corner) for corner in triangle]
        lines += ["    endloop", "  endfacet"]
    return "\n".join([*lines, *([f"endsolid {name}".rstrip()] if end else [])]) + "\n"


def _numbers(values: np.ndarray) -> str:
    return " ".join(f"{value:g}" for value in values + 0.0)
