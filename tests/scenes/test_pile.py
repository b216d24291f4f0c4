"""Piles: on the table at height 0, on each other where that carries, nowhere else; nothing inside anything."""

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.parts import part_bodies
from scenes.pile import CELL, LATTICE, SPACING, THINNING, Pile, surface_samples
from scenes.primitives import box, moved
from scenes.scene import Mesh, Scene

GAP = 2 * SPACING
"""Between a part and what carries it [m]: both surfaces are bounded from outside by SPACING."""


def _let_down(pile: Pile, size: tuple[float, float, float], x: float, y: float, yaw_deg: float = 0.0) -> float | None:
    turn = Rotation.from_euler("z", yaw_deg, degrees=True)
    pose = RigidTransform.from_components([x, y, size[2] / 2], turn)
    return pile.resting_height(surface_samples(box(size)), pose, np.zeros(3))


def test_the_first_part_stands_on_the_table():
    """At height 0."""
    assert _let_down(Pile(), (0.06, 0.04, 0.03), 0.01, -0.02, 30) == pytest.approx(0, abs=1e-12)


def test_a_second_part_stands_on_the_first():
    """On its top, 40 mm up, and the bounded gap above it."""
    pile = Pile()
    _let_down(pile, (0.10, 0.10, 0.04), 0, 0)
    assert _let_down(pile, (0.05, 0.05, 0.03), 0.01, 0.01) == pytest.approx(0.04 + GAP, abs=1e-9)


def test_what_would_tip_over_does_not_stay():
    """Its middle is beyond the edge of what carries it; and the try leaves no trace."""
    pile = Pile()
    _let_down(pile, (0.06, 0.06, 0.04), 0, 0)
    assert _let_down(pile, (0.08, 0.05, 0.03), 0.05, 0) is None
    assert _let_down(pile, (0.03, 0.03, 0.03), 0.10, 0) == pytest.approx(0, abs=1e-12)


def test_a_bridge_over_two_blocks_stays():
    """Its middle is above the gap between two blocks of one height, inside the hull of its contacts."""
    pile = Pile()
    for x in (-0.05, 0.05):
        assert _let_down(pile, (0.04, 0.04, 0.03), x, 0) == pytest.approx(0, abs=1e-12)
    assert _let_down(pile, (0.14, 0.03, 0.02), 0, 0) == pytest.approx(0.03 + GAP, abs=1e-9)


def test_a_weight_on_an_overhang_does_not_stay():
    """A plate balances on a narrow block; a weight out on the plate would tip the plate over."""
    pile = Pile()
    _let_down(pile, (0.04, 0.04, 0.03), 0, 0)
    assert _let_down(pile, (0.12, 0.05, 0.01), 0, 0) is not None
    assert _let_down(pile, (0.02, 0.02, 0.02), 0.045, 0) is None
    assert _let_down(pile, (0.02, 0.02, 0.02), 0, 0) is not None


def test_samples_leave_no_gap():
    """Random points of a box's surface and its corners are within SPACING of a sample, as the constants promise."""
    mesh = box((0.05, 0.031, 0.012))
    tree = cKDTree(surface_samples(mesh))
    rng = np.random.default_rng(0)
    corners = mesh.vertices[mesh.faces[rng.integers(len(mesh.faces), size=4000)]]
    weights = rng.dirichlet([1, 1, 1], 4000)
    points = np.concatenate([np.einsum("ij,ijk->ik", weights, corners), mesh.vertices])
    assert tree.query(points)[0].max() <= SPACING
    assert LATTICE / np.sqrt(3) + THINNING * np.sqrt(3) <= SPACING <= CELL


@pytest.mark.parametrize("seed", range(3))
def test_piled_parts_do_not_intersect(seed: int):
    """Parts C1 thrown at random: no dense surface sample of one is inside the other (signed distance to its planes)."""
    mesh = Scene("C1", part_bodies("C1"), (), 0.0).part_mesh()
    samples, rng, pile = surface_samples(mesh), np.random.default_rng(seed), Pile()
    placed: list[RigidTransform] = []
    for _ in range(12):
        pose = RigidTransform.from_components(
            [*rng.normal(0, 0.04, 2), 0], Rotation.from_euler("z", rng.uniform(0, 360), degrees=True)
        )
        height = pile.resting_height(samples, pose, np.array([0, 0, 0.02]))
        if height is not None:
            placed.append(RigidTransform.from_translation([0, 0, height]) * pose)
    assert len(placed) >= 2
    for i, first in enumerate(placed):
        for second in placed[i + 1 :]:
            assert not _inside(mesh, (first.inv() * second).apply(samples)).any()


def _inside(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """Ray parity along +z through the triangles: an independent test of being inside a closed surface."""
    near = np.all((points >= mesh.vertices.min(axis=0)) & (points <= mesh.vertices.max(axis=0)), axis=1)
    hits = np.zeros(len(points), int)
    p = points[near] + [1.234e-7, 2.345e-7, 0]  # off the edges
    count = np.zeros(len(p), int)
    for a, b, c in mesh.vertices[mesh.faces]:
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if abs(area) < 1e-14:
            continue
        v = ((p[:, 0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (p[:, 1] - a[1])) / area
        w = ((b[0] - a[0]) * (p[:, 1] - a[1]) - (p[:, 0] - a[0]) * (b[1] - a[1])) / area
        z = a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2])
        count += (v >= 0) & (w >= 0) & (v + w <= 1) & (z > p[:, 2])
    hits[near] = count
    return hits % 2 == 1


def test_a_turned_mesh_keeps_its_samples_apart():
    """Moving a mesh moves its samples: the pile may sample once and turn often."""
    mesh = box((0.05, 0.03, 0.02))
    pose = RigidTransform.from_components([0.01, 0.02, 0.03], Rotation.from_euler("xyz", [10, 20, 30], degrees=True))
    there = surface_samples(moved(mesh, pose))
    assert cKDTree(pose.apply(surface_samples(mesh))).query(there)[0].max() <= 2 * SPACING
