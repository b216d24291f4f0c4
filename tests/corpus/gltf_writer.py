"""glTF and GLB files of the corpus: a tree, and the numbers that it points to."""

import base64
import copy
import json
from typing import Any

import numpy as np

from tests.corpus.solids import Solid

MM = 1e-3
"""glTF is in metres."""
COMPONENT = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}


class Gltf:
    """A file in the making."""

    def __init__(self) -> None:
        self.binary = b""
        self.tree: dict[str, Any] = {
            "asset": {"version": "2.0"},
            **{"scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": []},
            **{"accessors": [], "bufferViews": [], "buffers": []},
        }

    def view(self, values: np.ndarray, stride: int | None = None) -> int:
        """Number of a new buffer view with the values, rows padded to `stride` bytes."""
        rows = [row.tobytes() for row in values]
        data = b"".join(row.ljust(stride or len(row), b"\0") for row in rows)
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        self.binary += data + b"\0" * (-len(data) % 4)
        self.tree["bufferViews"].append({**view, **({"byteStride": stride} if stride else {})})
        return len(self.tree["bufferViews"]) - 1

    def accessor(self, values: np.ndarray, stride: int | None = None, **more: Any) -> int:
        """Number of a new accessor with the values, (n, 1) or (n, 3)."""
        self.tree["accessors"].append(
            {
                "bufferView": self.view(values, stride),
                "componentType": COMPONENT[values.dtype.str[1:]],
                "count": len(values),
                "type": {1: "SCALAR", 3: "VEC3"}[values.shape[1]],
                **more,
            }
        )
        return len(self.tree["accessors"]) - 1

    def positions(self, points: np.ndarray) -> int:
        """Accessor of points [mm] in metres, with their bounds."""
        values = (points * MM).astype("<f4")
        return self.accessor(values, min=values.min(axis=0).tolist(), max=values.max(axis=0).tolist())

    def indices(self, corners: Any) -> int:
        """Accessor of vertex numbers."""
        return self.accessor(np.array(corners, "<u2").reshape(-1, 1))

    def mesh(self, *primitives: dict[str, Any], name: str | None = None) -> int:
        """Number of a new mesh."""
        self.tree["meshes"].append({"primitives": list(primitives), **({"name": name} if name else {})})
        return len(self.tree["meshes"]) - 1

    def solid(self, solid: Solid) -> int:
        """Number of a new mesh of one primitive."""
        return self.mesh(
            {"attributes": {"POSITION": self.positions(solid.points)}, "indices": self.indices(solid.triangles)}
        )

    def node(self, mesh: int | None = None, root: bool = True, **more: Any) -> int:
        """Number of a new node."""
        self.tree["nodes"].append({**({} if mesh is None else {"mesh": mesh}), **more})
        if root:
            self.tree["scenes"][0]["nodes"].append(len(self.tree["nodes"]) - 1)
        return len(self.tree["nodes"]) - 1

    def require(self, *extensions: str) -> None:
        """Name extensions without which the file cannot be read."""
        self.tree["extensionsUsed"] = self.tree["extensionsRequired"] = list(extensions)

    def glb(self) -> bytes:
        """As a binary file (glTF 2.0, section 4.4)."""
        tree = {**self.tree, "buffers": [{"byteLength": len(self.binary)}]}
        text = json.dumps(tree).encode()
        text += b" " * (-len(text) % 4)
        body = b"".join(
            len(chunk).to_bytes(4, "little") + kind + chunk
            for chunk, kind in ((text, b"JSON"), (self.binary, b"BIN\0"))
        )
        return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body

    def gltf(self) -> bytes:
        """As a text file with its buffer inside."""
        tree = copy.deepcopy(self.tree)
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
        tree["buffers"] = [{"byteLength": len(self.binary), "uri": uri}]
        return json.dumps(tree, indent=1).encode()
