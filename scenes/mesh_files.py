"""Read and write the committed meshes: compressed NPZ, metres, one file per body, with a hash of their content."""

import hashlib
from pathlib import Path

import numpy as np

from scenes.scene import Mesh

NORMAL_SCALE = 32767
"""Normals are stored as 16-bit integers: 0.002 deg, far below any roughness here."""


def write_mesh(path: Path, mesh: Mesh) -> None:
    """Store a mesh with normals and UVs. Positions and UVs become float32 (10 nm at 0.1 m)."""
    if mesh.normals is None or mesh.uvs is None:
        raise ValueError(f"{path}: a stored mesh needs normals and texture coordinates")
    np.savez_compressed(
        path,
        vertices=mesh.vertices.astype("<f4"),
        faces=mesh.faces.astype("<u2" if len(mesh.vertices) < 2**16 else "<u4"),
        normals=np.round(mesh.normals * NORMAL_SCALE).astype("<i2"),
        uvs=mesh.uvs.astype("<f4"),
    )


def read_mesh(path: Path) -> Mesh:
    """Mesh [m] that `write_mesh` stored."""
    with np.load(path) as arrays:
        normals = arrays["normals"] / NORMAL_SCALE
        return Mesh(
            arrays["vertices"].astype(float),
            arrays["faces"].astype(np.int64),
            arrays["uvs"].astype(float),
            normals / np.linalg.norm(normals, axis=1, keepdims=True),
        )


def content_hash(path: Path) -> str:
    """SHA-256 over names, types, shapes and bytes of the arrays; does not depend on how the archive was compressed."""
    digest = hashlib.sha256()
    with np.load(path) as arrays:
        for name in sorted(arrays.files):
            array = np.ascontiguousarray(arrays[name])
            digest.update(f"{name} {array.dtype.str} {array.shape}".encode())
            digest.update(array.tobytes())
    return digest.hexdigest()
