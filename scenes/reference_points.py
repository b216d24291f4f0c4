"""Area-uniform points on the part's surface, the reference for coverage."""

import numpy as np
from jaxtyping import Float

from scenes.scene import Scene
from scenes.topology import face_normals


def reference_points(
    scene: Scene, n: int = 10_000, seed: int = 0
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """`n` points [m] drawn uniformly by area on all part bodies, and their outward unit normals; world frame.

    Surfaces that no view can reach (undersides, threads in their holes) are included: visibility is judged elsewhere.
    Default n: the paper's evaluation uses 10,000.
    """
    mesh = scene.part_mesh()
    normals = face_normals(mesh.vertices, mesh.faces)
    doubled_areas = np.linalg.norm(normals, axis=1)
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    triangle = rng.choice(len(doubled_areas), size=n, p=doubled_areas / doubled_areas.sum())
    root, along = np.sqrt(rng.random(n)), rng.random(n)  # square root: uniform in area (Turk 1990)
    weights = np.column_stack([1 - root, root * (1 - along), root * along])
    points = np.einsum("ij,ijk->ik", weights, mesh.vertices[mesh.faces[triangle]])
    return points, normals[triangle] / doubled_areas[triangle, None]


def part_box(scene: Scene) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner of the part's axis-aligned bounding box [m]."""
    corners = np.concatenate([body.mesh.vertices for body in scene.part_bodies])
    return np.stack([corners.min(axis=0), corners.max(axis=0)])


def part_half_diagonal(scene: Scene) -> float:
    """Half the space diagonal of that box [m]."""
    low, high = part_box(scene)
    return float(np.linalg.norm(high - low) / 2)
