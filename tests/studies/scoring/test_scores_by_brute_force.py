"""Detection and recovery scores of ten frames against the same numbers computed pixel by pixel and pair by pair."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from franbv.planners import fra
from franbv.sensing import DepthBurst, DepthCamera
from render.arm.arm import SimulatedArm
from studies.scoring.detection import DetectionScores, score_detection
from studies.scoring.recovery import State, ViewGain, burst_points, score_recovery, still_missing
from studies.sensitivity.cases import CaseConfig, plain_paths, sweep_cases
from studies.sensitivity.planning import Planned, first_look, signalled_surface
from studies.sensitivity.preset import SensitivityPreset, Sweep
from studies.sensitivity.views import LitView, lit_views
from tests.studies.scoring import brute_force_scores as brute

pytestmark = pytest.mark.slow

SWEEPS = (
    Sweep(
        name="plate", metals=("stainless_austenitic",), finishes=("polished", "brushed", "blasted"), polar_deg=(20, 40)
    ),
    Sweep(name="coupons", subjects=("inside_corner", "lying_cylinder"), metals=("aluminium",), finishes=("bright",)),
    Sweep(name="parts", subjects=("C1", "D1"), materials=("own",)),
)
"""Ten frames: five surfaces, four shapes, with regions and without."""
Frame = tuple[CaseConfig, LitView, Planned]


@cache
def frames() -> list[Frame]:
    """Measured, labelled and run through the detector."""
    preset = SensitivityPreset(title="ten frames", sweeps=SWEEPS)
    with TemporaryDirectory() as folder:
        return list(_frames([case.config for case in sweep_cases(preset)], Path(folder)))


def _frames(configs: list[CaseConfig], twins: Path) -> Iterator[Frame]:
    for config in configs:
        for view in lit_views(config, twins):
            yield config, view, first_look(view.measurement.burst, config.parameters, config.seed)


def scored(frame: Frame) -> DetectionScores:
    """By the code under test."""
    _, view, planned = frame
    return score_detection(view.camera, view.measurement.T_world_cam, view.truth, view.labels, planned.detection)


def test_frames_hold_something_to_score():
    """Ten frames; in some the detector finds regions, in others none, and all hold reflective pixels of some kind."""
    regions = [len(planned.detection.boxes) for _, _, planned in frames()]
    assert len(regions) == 10
    assert sum(n > 0 for n in regions) >= 3
    assert 0 in regions
    assert sum(np.isin(view.labels.cause, list(brute.REFLECTION)).any() for _, view, _ in frames()) >= 8


def test_pixel_scores():
    """Every stage's counts, precision, recall and IoU, and what each stage loses."""
    for frame in frames():
        _, view, planned = frame
        expected, scores = brute.stages(view.labels, planned.detection), scored(frame)
        assert {n: (s.n_found, s.n_true, s.n_both) for n, s in scores.stages.items()} == expected
        assert {name: lost for name, (lost, _) in scores.losses.items()} == brute.lost_between(expected)
        for name, (found, true, both) in expected.items():
            score, either = scores.stages[name], found + true - both
            shares = ((score.precision, both, found), (score.recall, both, true), (score.iou, both, either))
            for theirs, part, whole in shares:
                assert brute.same(part / whole if whole else float("nan"), theirs)


def test_what_decimation_hides():
    """Where reflective holes and false depths end up."""
    for frame in frames():
        _, view, _ = frame
        hidden, expected = scored(frame).hidden, brute.fates(view.labels)
        for fates, counts in ((hidden.reflective_holes, expected["holes"]), (hidden.false_depths, expected["false"])):
            assert (fates.hole, fates.false_depth, fates.right_depth) == counts


def test_region_scores():
    """Areas, IoU and offsets of every region, areas and found shares of every patch."""
    compared = 0
    for frame in frames():
        _, view, planned = frame
        pose, scores = view.measurement.T_world_cam, scored(frame)
        boxes, patches = brute.regions(view.truth, pose, view.labels, planned.detection)
        assert len(boxes) == len(scores.regions)
        for box, region in zip(boxes, scores.regions, strict=True):
            theirs = (region.found_area, region.patch_area, region.both_area, region.iou, region.in_front)
            mine = (box["found"], box["patch"], box["both"], box["iou"], box["in_front"])
            assert all(brute.same(1e6 * a, 1e6 * b) for a, b in zip(mine[:3], theirs[:3], strict=True))  # [mm^2]
            assert all(brute.same(a, b) for a, b in zip(mine[3:], theirs[3:], strict=True))
            compared += 1
        key = sorted((1e6 * patch["area"], patch["found"] / patch["area"]) for patch in patches)
        for mine, theirs in zip(key, sorted((1e6 * p.area, p.found_share) for p in scores.patches), strict=True):
            assert brute.same(mine[0], theirs[0])
            assert brute.same(mine[1], theirs[1])
    assert compared >= 3


class Recorder:
    """A camera that keeps what it captured."""

    def __init__(self, camera: DepthCamera) -> None:
        self._camera = camera
        self.bursts: list[DepthBurst] = []
        self.intrinsics, self.min_z = camera.intrinsics, camera.min_z

    def capture(self, T_world_cam, n_frames: int) -> DepthBurst:
        """Capture and keep."""
        self.bursts.append(self._camera.capture(T_world_cam, n_frames))
        return self.bursts[-1]


def test_recovery_scores():
    """For every frame with a region: what each recovery pose and each PB view regains alone, what they regain
    together, and how their angles differ, from the bursts that the camera took meanwhile. One frame of them also tries
    poses all around: the best of those that were measured again is the best."""
    compared = 0
    for config, view, planned in frames():
        missing = signalled_surface(view, planned.detection)
        if missing is None or missing.area == 0:
            continue
        pose, camera = view.measurement.T_world_cam, Recorder(view.camera.changed(**plain_paths(8)))
        arm = SimulatedArm.around(view.camera.world.source.part_mesh())
        recovery = fra().recovery
        assert recovery is not None
        poses = recovery.poses(planned.detection.boxes[0], pose, config.parameters, arm.reachable, camera.min_z)
        n_poses = 12 if compared == 0 else 0
        scout = Recorder(view.camera.changed(**plain_paths(4)))
        with threadpool_limits(1):
            score = score_recovery(
                State(planned.model, pose, missing), poses, camera, arm, config.parameters, 0, scout, n_poses
            )
        n = len(poses.poses)
        diamond, pb, again = camera.bursts[:n], camera.bursts[n : n + len(score.pb.gains)], camera.bursts[2 * n :]
        for views, bursts in ((score.diamond, diamond), (score.pb, pb)):
            check_gains(missing, pose, views.gains, bursts)
            if bursts:
                assert brute.same(brute.regained(missing, bursts), views.regained)
        if n_poses:
            shares = [brute.regained(missing, [burst]) for burst in again]
            assert brute.same(max(shares), score.best.regained)
            assert score.n_tried == len(scout.bursts)
        assert still_missing(missing, burst_points(view.measurement.burst)).area == missing.area
        compared += 1
    assert compared >= 3


def check_gains(missing, pose, gains: tuple[ViewGain, ...], bursts: list[DepthBurst]) -> None:
    """Every view by itself."""
    assert len(gains) == len(bursts)
    for gain, burst in zip(gains, bursts, strict=True):
        assert brute.same(brute.regained(missing, [burst]), gain.regained)
        incidence, turn = brute.mean_angles(missing, pose, burst.T_world_cam)
        assert brute.same(incidence, gain.incidence_deg)
        assert brute.same(turn, gain.turn_deg)
        before, _ = brute.mean_angles(missing, pose, pose)
        assert brute.same(before, gain.incidence_before_deg)
