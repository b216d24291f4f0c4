"""Ablations: each changes one thing and no other, equal runs have equal names, and what does not fit is refused."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.ellipsoids import Ellipsoids
from franbv.frames import Intrinsics
from franbv.model import Model
from franbv.object_model import object_model
from franbv.parameters import Parameters
from franbv.sensing import DepthBurst
from franbv.voxel_map import empty_map
from studies.base.case_folder import case_digest
from studies.cli.main import main
from studies.run.ablation import ABLATIONS, Ablation, build_planner
from studies.run.run_case import RUN_COMMAND, RunSettings, ablated
from studies.run.stored_run import StoredRun
from tests.studies.run.analytic_ball import reconstruct_ball

IN_PARAMETERS = {
    "carve_on_missing": {"carve_on_missing": True},
    "n_frames_1": {"n_frames": 1},
    "n_frames_5": {"n_frames": 5},
    "turned_diamond": {"diamond_angle_deg": 45.0},
    "poses_6": {"n_recovery_poses": 6},
    "poses_8": {"n_recovery_poses": 8},
    "random_order": {"recovery_order": "random"},
    "tau_rec_10": {"recovered_share": 0.1},
    "tau_rec_20": {"recovered_share": 0.2},
    "tau_rec_40": {"recovered_share": 0.4},
    "tau_rec_50": {"recovered_share": 0.5},
    "tau_rec_60": {"recovered_share": 0.6},
    "full_covariance": {"covariance": "full"},
    "unweighted": {"weight_base": 1.0},
    "ranked_by_depth": {"rank_by": "depth"},
}
"""What each ablation by numbers must change, from its name alone."""


@pytest.mark.parametrize("name", ABLATIONS)
def test_one_thing_is_changed(name: str):
    """The parameters differ in the one key that the name says, or the functions do and no parameter."""
    change = ABLATIONS[name].change
    before, after = Parameters().model_dump(), change.changed(Parameters()).model_dump()
    assert {key: after[key] for key in after if after[key] != before[key]} == IN_PARAMETERS.get(name, {})
    assert (change.of_functions() == Ablation()) == (name in IN_PARAMETERS)
    assert change.misfit(ABLATIONS[name].planner) is None


def test_equal_runs_have_equal_names():
    """The flag of the ablation and the flag of the parameter lead to one case; a left-out filter leads to another."""
    by_flag = ablated(RunSettings(ablation=Ablation(n_frames=5, random_order=True)))
    by_number = ablated(RunSettings(parameters=Parameters(n_frames=5, recovery_order="random")))
    assert case_digest(RUN_COMMAND, by_flag) == case_digest(RUN_COMMAND, by_number)
    other = ablated(RunSettings(ablation=Ablation(without_filter="erosion")))
    assert case_digest(RUN_COMMAND, other) != case_digest(RUN_COMMAND, ablated(RunSettings()))
    assert ablated(by_flag) == by_flag


@pytest.mark.parametrize(
    ("flags", "complaint"),
    [
        (("--planner", "pb", "--ablation.without-filter", "erosion"), "planner pb has no filters"),
        (("--planner", "re", "--ablation.robust", "map"), "planner re takes over nothing of fra-robust"),
        (("--planner", "fra", "--ablation.gain", "entropy"), "planner fra casts no rays"),
        (("--planner", "pb", "--ablation.within-object"), "planner pb casts no rays"),
        (("--ablation.recovered-share", "0.9"), "--ablation.recovered-share 0.9"),
        (("--ablation.n-frames", "4"), "4"),
        (("--planner", "nbv"), "nbv"),
    ],
)
def test_what_does_not_fit_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path, flags, complaint: str):
    """Exit status 2 and one line that names the flag or the planner."""
    assert main(["reconstruct", "--part", "A", "--out", str(tmp_path / "out"), *flags]) == 2
    err = capsys.readouterr().err
    assert complaint in err
    assert err.count("\n") == 1


SENSOR = Intrinsics(21, 21, 40.0, 40.0, 10.0, 10.0)


def _detection(without: str | None):
    """A frontier sphere (image radius about 8 px) with an occupied one before its right half, seen in three frames.

    Rows 2-18 of the middle column band are invalid, two thirds of the time; one more pixel in the first frame alone.
    """
    bodies = Ellipsoids(
        np.array([[0.0, 0.0, 0.25], [0.03, 0.0, 0.15]]),
        np.array([0.05**2 * np.eye(3), 0.012**2 * np.eye(3)]),
        np.array([True, False]),
    )
    depths = np.full((3, 21, 21), 0.3, np.float32)
    depths[1:, :, 9:12] = 0.0
    depths[1:, 8:13, 16:19] = 0.0
    depths[0, 4, 6] = 0.0
    burst = DepthBurst(depths, SENSOR, RigidTransform.identity())
    grid = empty_map(Parameters())
    planner = build_planner("fra", Ablation(without_filter=without))  # type: ignore[arg-type]
    assert planner.recovery is not None
    return planner.recovery.detect(burst, Model(grid, object_model(grid, Parameters()), bodies), Parameters())


def test_each_filter_can_be_left_out():
    """What a filter alone keeps out comes in, and nothing else."""
    whole = _detection(None)
    assert set(whole.masks) == {"persistent_invalid", "inside_silhouette", "inside_eroded_silhouette"}
    assert whole.retained[10, 10]

    wider = _detection("erosion").retained
    assert np.all(wider >= whole.retained)
    added = wider & ~whole.retained
    assert added.any()
    assert not np.any(added & whole.masks["inside_eroded_silhouette"])  # only what the erosion had taken

    covered = _detection("frontier").retained
    assert covered[10, 17]  # its ray meets the occupied sphere first
    assert not whole.retained[10, 17]

    once = _detection("persistence").retained
    assert np.array_equal(np.argwhere(once), [[4, 6]])  # invalid in the first frame, a third of the time


@pytest.mark.parametrize("planner", ["re", "random"])
def test_runs_without_ellipsoids_are_stored_and_reported(tmp_path: Path, planner: str):
    """Table, figures and page do without ellipsoids; there are no recoveries."""
    settings = RunSettings(planner=planner, parameters=Parameters(n_frames=1, max_iterations=2))  # type: ignore[arg-type]
    reconstruct_ball(tmp_path, settings=settings)
    stored = StoredRun(tmp_path)
    assert [row["occupied_ellipsoids"] for row in stored.rows] == [0, 0, 0]
    assert stored.run["summary"]["recovery_activations"] == 0
    assert stored.run["summary"]["coverage_5mm"] > 0.2
    assert (tmp_path / "report.html").stat().st_size > 10_000
