"""Draw all parts and write their meshes and manifest into `scenes/meshes/`.

Run with the extra `authoring` installed: python -m scenes.authoring.write_meshes [folder]
"""

# pyright: reportMissingImports=false
import json
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

from scenes.authoring.drawing import DrawnBody, DrawnPart
from scenes.authoring.part_a import part_a
from scenes.authoring.part_a1 import part_a1
from scenes.authoring.part_b import part_b
from scenes.authoring.part_b1 import part_b1
from scenes.authoring.part_c import part_c
from scenes.authoring.part_c1 import part_c1
from scenes.authoring.part_d import part_d
from scenes.authoring.part_d1 import part_d1
from scenes.authoring.part_e1 import part_e1
from scenes.authoring.part_e2 import part_e2
from scenes.authoring.part_e3 import part_e3
from scenes.authoring.part_e4 import part_e4
from scenes.authoring.tessellation import tessellate
from scenes.mesh_files import content_hash, write_mesh
from scenes.primitives import joined
from scenes.scene import Mesh

FOLDER = Path(__file__).parents[1] / "meshes"


def drawn_parts() -> tuple[DrawnPart, ...]:
    """All of them, the paper's first."""
    papers = (part_a(), part_b(), part_c(), part_d())
    return (*papers, part_a1(), part_b1(), part_c1(), part_d1(), part_e1(), part_e2(), part_e3(), part_e4())


def write_meshes(folder: Path) -> None:
    """Write one NPZ per body and `manifest.json`; the parts rest on z = 0 with their bounding box over the origin."""
    parts = {part.name: _write_part(folder, part) for part in drawn_parts()}
    manifest = {
        "units": "m",
        "licence": "MIT",
        "made_with": {name: version(name) for name in ("build123d", "bd_warehouse", "cadquery-ocp-novtk")},
        "parts": parts,
    }
    (folder / "manifest.json").write_text(json.dumps(manifest, indent=2) + "\n")


def _write_part(folder: Path, part: DrawnPart) -> dict:
    meshes = _on_table([_mesh(body) for body in part.bodies])
    corners = np.concatenate([mesh.vertices for mesh in meshes])
    bodies = []
    for body, mesh in zip(part.bodies, meshes, strict=True):
        file = f"{part.name.lower()}_{body.name}.npz"
        write_mesh(folder / file, mesh)
        bodies.append(
            {
                "name": body.name,
                "file": file,
                "material": body.material,
                "why": body.why,
                "triangles": len(mesh.faces),
                "sha256": content_hash(folder / file),
            }
        )
    return {
        "description": part.description,
        "script": f"scenes/authoring/part_{part.name.lower()}.py",
        "size": [round(float(length), 4) for length in np.ptp(corners, axis=0)],
        "bodies": bodies,
    }


def _mesh(body: DrawnBody) -> Mesh:
    """All solids of a body, each tessellated on its own, since solids that touch would share edges."""
    meshes = [solid if isinstance(solid, Mesh) else tessellate(solid) for solid in body.solids]
    return joined(meshes)


def _on_table(meshes: list[Mesh]) -> list[Mesh]:
    corners = np.concatenate([mesh.vertices for mesh in meshes])
    low, high = corners.min(axis=0), corners.max(axis=0)
    foot = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    return [Mesh(mesh.vertices - foot, mesh.faces, mesh.uvs, mesh.normals) for mesh in meshes]


if __name__ == "__main__":
    write_meshes(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
