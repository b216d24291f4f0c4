"""Point clouds as binary PLY: x, y, z in metres, and the acquisition that saw each point.

Format: G. Turk, The PLY Polygon File Format, 1994. Extra properties are ignored by readers that do not know them.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from studies.base.atomic_file import write_atomically

VERTEX = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("acquisition", "<i4")])
"""Layout of one point."""

HEADER = """ply
format binary_little_endian 1.0
comment metres, world frame: z up, table top at z = 0
element vertex {count}
property float x
property float y
property float z
property int acquisition
end_header
"""


def write_ply(path: Path, points: Float[np.ndarray, "n 3"], acquisition: Int[np.ndarray, "n"]) -> None:
    """Write the points [m] with the number of the acquisition that saw each."""
    vertices = np.zeros(len(points), VERTEX)
    vertices["x"], vertices["y"], vertices["z"] = np.asarray(points, np.float32).T
    vertices["acquisition"] = acquisition
    write_atomically(path, HEADER.format(count=len(points)).encode() + vertices.tobytes())


def read_ply(path: Path) -> tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "n"]]:
    """Points [m] and acquisitions of a file that `write_ply` wrote; ValueError for any other."""
    data = path.read_bytes()
    end = data.find(b"end_header\n") + len(b"end_header\n")
    count = (len(data) - end) // VERTEX.itemsize
    if data[:end] != HEADER.format(count=count).encode():
        raise ValueError(f"{path}: not a cloud of this tool, or cut short")
    vertices = np.frombuffer(data, VERTEX, count, end)
    return np.column_stack([vertices["x"], vertices["y"], vertices["z"]]), vertices["acquisition"].astype(np.int64)
