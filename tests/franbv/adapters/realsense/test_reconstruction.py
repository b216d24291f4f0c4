"""A whole reconstruction through librealsense decides as one that is given the same frames directly."""

from collections.abc import Iterator
from dataclasses import dataclass, field, fields

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.acquisition import Acquisition
from franbv.frames import Intrinsics
from franbv.parameters import Parameters
from franbv.planners import fra
from franbv.reconstruction import reconstruct
from franbv.sensing import DepthBurst
from render.d435i import SimulatedD435i
from render.depth.coding import metres_from_z16
from render.depth.decimation import crop_centre, decimate
from render.world.rig import d435i_rig
from tests.franbv.adapters.realsense.software_camera import PERIOD_MS, Bench, SoftwareCamera, Still
from tests.franbv.analytic_camera import AnalyticCamera, FreeArm

FULL = d435i_rig().intrinsics
IN_FLIGHT = 2
"""Frames of the pose before that arrive after the arm has stopped."""
TIMES = {"planning_s", "sensing_s", "motion_s", "model"}
"""Of an acquisition: what a clock says, and the model, which is compared by its map and ellipsoids."""


@dataclass
class Scene:
    """A box that is partly a mirror on a table, at full resolution, as 16-bit depth in millimetres."""

    camera: AnalyticCamera = field(
        default_factory=lambda: AnalyticCamera(
            boxes=(((-0.05, -0.04, 0.0), (0.05, 0.04, 0.08)),),
            hole=lambda points, cosine: (points[:, 2] > 0.03) & (points[:, 2] < 0.07) & (cosine < 0.8),
            intrinsics=FULL,
        )
    )

    def z16(self, pose: RigidTransform, n: int) -> np.ndarray:
        """The next n frames from there."""
        return np.rint(self.camera.capture(pose, n).depths * 1e3).astype(np.uint16)


@dataclass
class Direct:
    """A camera that hands over the scene's frames as the simulator reduces them."""

    intrinsics: Intrinsics
    min_z: float
    scene: Scene = field(default_factory=Scene)

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """Decimated by 8, the middle 60 x 40."""
        small = decimate(self.scene.z16(T_world_cam, n_frames), 8)
        h, w = small.shape[1:]
        z16, _ = crop_centre(small, Intrinsics(w, h, 1.0, 1.0, 0.0, 0.0))
        return DepthBurst(metres_from_z16(z16), self.intrinsics, T_world_cam)


@dataclass
class PosedArm(FreeArm):
    """An arm that knows where it stands."""

    pose: RigidTransform = field(default_factory=RigidTransform.identity)

    def move_to(self, T_world_cam: RigidTransform) -> float:
        """There."""
        self.pose = T_world_cam
        return super().move_to(T_world_cam)


def film(arm: PosedArm, n_frames: int) -> Iterator[Still]:
    """What the camera on the arm shows: a few frames late, and then a burst's worth from where the arm stands."""
    scene, number = Scene(), 0
    late = np.zeros((FULL.height, FULL.width), np.uint16)
    while True:
        for image in [*[late] * IN_FLIGHT, *scene.z16(arm.pose, n_frames)]:
            number += 1
            late = image
            yield Still(image, number, number * PERIOD_MS)


def check_same(ours: Acquisition, theirs: Acquisition) -> None:
    """Every field but the times, to the bit."""
    for name in [one.name for one in fields(Acquisition) if one.name not in TIMES]:
        np.testing.assert_equal(plain(getattr(ours, name)), plain(getattr(theirs, name)), name)
    np.testing.assert_array_equal(ours.model.voxel_map.occupied, theirs.model.voxel_map.occupied)
    np.testing.assert_equal(plain(ours.model.ellipsoids), plain(theirs.model.ellipsoids))


def plain(thing):
    """Dataclasses as dictionaries, poses as matrices, all the way down."""
    if isinstance(thing, RigidTransform):
        return thing.as_matrix()
    if hasattr(thing, "__dataclass_fields__"):
        return {one.name: plain(getattr(thing, one.name)) for one in fields(thing)}
    if isinstance(thing, list | tuple):
        return [plain(one) for one in thing]
    return thing


@pytest.mark.parametrize(("n_frames", "iterations"), [(2, 2), pytest.param(15, 15, marks=pytest.mark.slow)])
def test_decides_as_with_the_same_frames_directly(n_frames, iterations):
    """Poses, utilities, holes, regions, recoveries, Gamma, clouds and the stop are those of the direct run: nothing is
    lost, mixed, shifted or rounded on the way through librealsense's device, filter and queue."""
    parameters = Parameters(n_frames=n_frames, max_iterations=iterations)
    arm = PosedArm()
    bench = Bench([SoftwareCamera()], film(arm, n_frames))
    with bench.camera(settle_frames=IN_FLIGHT) as camera:
        ours = reconstruct(camera, arm, fra(), parameters, seed=3)
        direct = Direct(camera.intrinsics, camera.min_z)
    theirs = reconstruct(direct, PosedArm(), fra(), parameters, seed=3)
    assert ours.stop == theirs.stop
    assert len(ours.acquisitions) == len(theirs.acquisitions) > iterations
    assert any(acquisition.kind == "recovery" for acquisition in ours.acquisitions)
    for a, b in zip(ours.acquisitions, theirs.acquisitions, strict=True):
        check_same(a, b)


def test_the_direct_camera_is_the_simulators():
    """The comparison is with what `SimulatedD435i` would hand over: same reduction, same intrinsics."""
    from materials.catalog import material
    from scenes.coupons import wall

    sim = SimulatedD435i(wall(0.4, material("stainless_austenitic:bright")))
    direct = Direct(sim.intrinsics, sim.min_z)
    pose = RigidTransform.from_translation([0.0, 0.0, -0.4])
    burst = direct.capture(pose, 2)
    np.testing.assert_array_equal(burst.depths, metres_from_z16(sim.reduced(Scene().z16(pose, 2))))
    with Bench([SoftwareCamera()]).camera() as camera:
        assert (camera.intrinsics, camera.min_z) == (sim.intrinsics, sim.min_z)
