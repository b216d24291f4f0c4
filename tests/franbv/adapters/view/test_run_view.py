"""What is drawn of a run is the run: the viewer's own reader finds its points, boxes and poses at their steps."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.franbv.adapters.recording.recorded_run import PARAMETERS, infrared

pytest.importorskip("rerun")
from franbv.adapters.view.run_view import ARROW
from tests.franbv.adapters.view.rrd_reading import Drawn, counts, drawn, verified

SINGLE = 1e-6
"""Relative error of single precision, which the viewer keeps."""


@pytest.fixture(scope="module")
def found(drawn_run) -> Drawn:
    """What the file holds."""
    return drawn(drawn_run.path)


def test_the_viewer_accepts_the_file(drawn_run):
    """By its own program's judgement; a run is named by its title."""
    assert verified(drawn_run.path) == "0: 1 file verified without error."


def test_every_step_has_what_its_acquisition_has(drawn_run, found: Drawn):
    """As many points, voxels, ellipsoids, regions and recovery poses, none left over from an earlier step."""
    run = drawn_run.run.acquisitions
    models = [a.model for a in run]
    boxes = [0 if a.detection is None else len(a.detection.boxes) for a in run]
    poses = [0 if a.recovery_poses is None else len(a.recovery_poses.poses) for a in run]
    assert counts(found, "/world/cloud:Points3D:positions") == [len(a.points) for a in run]
    assert counts(found, "/world/voxels/occupied:Boxes3D:centers") == [len(m.object.occupied) for m in models]
    assert counts(found, "/world/voxels/frontier:Boxes3D:centers") == [len(m.object.frontier) for m in models]
    for kind, some in [("occupied", "of_occupied"), ("frontier", "of_frontier")]:
        number = [len(getattr(m.ellipsoids, some)()) for m in models]
        assert counts(found, f"/world/ellipsoids/{kind}:Ellipsoids3D:half_sizes") == number
    assert counts(found, "/world/reflective_regions:Boxes3D:half_sizes") == boxes
    assert counts(found, "/world/recovery_poses:Arrows3D:origins") == poses
    assert max(boxes) > 0
    assert max(poses) == PARAMETERS.n_recovery_poses
    assert counts(found, "/world/camera:Transform3D:translation") == [1] * len(run)
    assert [len(strip[0]) for strip in found["/world/way:LineStrips3D:strips"].values()] == [a.index + 1 for a in run]


def test_things_stand_where_they_are(drawn_run, found: Drawn):
    """Points, cameras, lines of sight and the voxels' size, in metres of the world."""
    for a in drawn_run.run.acquisitions:
        np.testing.assert_allclose(found["/world/cloud:Points3D:positions"][a.index], a.points, atol=SINGLE)
        pose = a.burst.T_world_cam
        np.testing.assert_allclose(
            found["/world/camera:Transform3D:translation"][a.index], [pose.translation], atol=SINGLE
        )
        turned = Rotation.from_quat(found["/world/camera:Transform3D:quaternion"][a.index][0])
        assert (turned.inv() * pose.rotation).magnitude() < 1e-3 * SINGLE**0.5
        half_sizes = np.array(found["/world/voxels/occupied:Boxes3D:half_sizes"][a.index])
        np.testing.assert_allclose(half_sizes, PARAMETERS.voxel_size / 2, rtol=SINGLE)
    first = drawn_run.run.acquisitions[0]
    ends = (
        np.array(found["/world/recovery_poses:Arrows3D:origins"][0])
        + found["/world/recovery_poses:Arrows3D:vectors"][0]
    )
    towards = first.recovery_poses.target - [pose.translation for pose in first.recovery_poses.poses]
    towards /= np.linalg.norm(towards, axis=1)[:, None]  # all look at the target
    starts = np.array([pose.translation for pose in first.recovery_poses.poses])
    np.testing.assert_allclose(ends, starts + ARROW * towards, atol=SINGLE)


def test_ellipsoids_and_boxes_keep_their_shape(drawn_run, found: Drawn):
    """S is put together again of semi-axes and quaternions; so are the corners of the regions."""
    for a in drawn_run.run.acquisitions:
        for kind, some in [
            ("occupied", a.model.ellipsoids.of_occupied()),
            ("frontier", a.model.ellipsoids.of_frontier()),
        ]:
            halves = np.array(found[f"/world/ellipsoids/{kind}:Ellipsoids3D:half_sizes"][a.index])
            axes = Rotation.from_quat(found[f"/world/ellipsoids/{kind}:Ellipsoids3D:quaternions"][a.index]).as_matrix()
            shapes = np.einsum("kij,kj,klj->kil", axes, halves**2, axes)
            np.testing.assert_allclose(shapes, some.shapes, atol=10 * SINGLE * np.abs(some.shapes).max())
            np.testing.assert_allclose(
                found[f"/world/ellipsoids/{kind}:Ellipsoids3D:centers"][a.index], some.centres, atol=SINGLE
            )
    (box,) = drawn_run.run.acquisitions[0].detection.boxes
    turned = Rotation.from_quat(found["/world/reflective_regions:Boxes3D:quaternions"][0][0])
    centre = np.array(found["/world/reflective_regions:Boxes3D:centers"][0][0])
    halves = found["/world/reflective_regions:Boxes3D:half_sizes"][0][0]
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1], indexing="ij")).reshape(3, 8).T
    np.testing.assert_allclose(centre + turned.apply(signs * halves), box.corners(), atol=SINGLE)


def test_images_are_those_of_the_camera(drawn_run, found: Drawn):
    """Depth bit by bit; infrared where there is one, and cleared where there is none. The principal point is half a
    pixel farther: the viewer counts from the first pixel's corner, where 60 pixels have their middle at 30."""
    for a in drawn_run.run.acquisitions:
        depth = bytes(found["/world/camera/lens/depth:DepthImage:buffer"][a.index][0])
        assert depth == a.burst.median_depth(PARAMETERS.invalid_share).tobytes()
        picture, cleared = infrared(a.index), found["/infrared:Clear:is_recursive"].get(a.index)
        if picture is None:
            assert cleared == [False]
            assert a.index not in found["/infrared:Image:buffer"]
        else:
            assert bytes(found["/infrared:Image:buffer"][a.index][0]) == picture.tobytes()
    lens = np.reshape(found["/world/camera/lens:Pinhole:image_from_camera"][0][0], (3, 3)).T  # columns first
    np.testing.assert_array_equal(lens, [[40.125, 0, 30], [0, 40.125, 20], [0, 0, 1]])
    assert found["/world/camera/lens:Pinhole:resolution"][0] == [[60, 40]]


def test_curves_are_drawn_where_they_are_known(drawn_run, found: Drawn):
    """Coverage and voxels at every step, U from the second on, Gamma at recoveries alone."""
    run = drawn_run.run.acquisitions

    def curve(name: str) -> dict[int, float]:
        return {step: value for step, (value,) in found[f"/curves/{name}:Scalars:scalars"].items()}

    assert curve("coverage") == {a.index: a.index / 100 for a in run}
    assert curve("occupied_voxels") == {a.index: len(a.model.object.occupied) for a in run}
    assert curve("utility") == {a.index: a.utility for a in run if a.kind != "first"}
    assert curve("gamma") == {a.index: a.gamma for a in run if a.kind == "recovery"}
    assert len(curve("gamma")) > 0
