"""Bursts shared between runs: nothing is taken twice, nothing is taken over from another subject, all bytes equal."""

import os
from pathlib import Path

import pytest
from scipy.spatial.transform import RigidTransform

from franbv.parameters import Parameters
from studies.run.bursts import KeptCaptures, infrared_path, stored_depths
from studies.run.run_case import RunSettings, write_run
from studies.run.scene_settings import SubjectSettings
from studies.run.shared_bursts import SharedCaptures
from studies.run.stored_run import StoredRun
from tests.studies.run.analytic_ball import CAMERA, Ball, FreeArm, ball_reference

PB = RunSettings(planner="pb", parameters=Parameters(n_frames=3, max_iterations=2))
PB_FURTHER = PB.model_copy(update={"parameters": Parameters(n_frames=3, max_iterations=3)})
"""The same poses and one more."""


def _run(folder: Path, settings: RunSettings, shared: SharedCaptures | None) -> Ball:
    ball = Ball()
    folder.mkdir()
    captures = KeptCaptures(ball.take, CAMERA, 0.128, folder, shared)
    write_run(folder, settings, "Ball", captures, FreeArm(), ball_reference())
    return ball


def _captures(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / "captures").iterdir()}


def test_runs_that_look_from_the_same_poses_take_each_burst_once(tmp_path: Path):
    """A longer run of the same start takes its last view only, and leaves the bytes of a run on its own."""
    shared = SharedCaptures.of(tmp_path / "shared", SubjectSettings(part="A"))
    first = _run(tmp_path / "first", PB, shared)
    second = _run(tmp_path / "second", PB_FURTHER, shared)
    alone = _run(tmp_path / "alone", PB_FURTHER, None)
    assert (len(first.taken), len(second.taken), len(alone.taken)) == (3, 1, 4)
    assert _captures(tmp_path / "second") == _captures(tmp_path / "alone")
    assert StoredRun(tmp_path / "second").rows == StoredRun(tmp_path / "alone").rows
    assert infrared_path(tmp_path / "second", 0).stat().st_nlink == 3  # first, shared, second: no space of its own


def test_another_subject_seed_or_length_shares_nothing(tmp_path: Path):
    """What decides a burst is in its name: part, lamps, seed, frames and pose; what else a run is told is not."""
    folder, pose = tmp_path / "shared", RigidTransform.identity()
    own = tmp_path / "000.npz"
    own.write_bytes(b"burst")
    SharedCaptures.of(folder, SubjectSettings(part="A")).offer(pose, 3, [own])

    def taken(pose: RigidTransform = pose, n: int = 3, **settings) -> bool:
        shared = SharedCaptures.of(folder, SubjectSettings(**{"part": "A", **settings}))
        return shared.take_over(pose, n, [tmp_path / "other.npz"])

    assert taken()
    assert not taken(part="B")
    assert not taken(seed=1)
    assert not taken(lamps="dim")
    assert not taken(n=1)
    assert not taken(pose=RigidTransform.from_translation([0.0, 0.0, 1e-12]))
    assert not SharedCaptures.of(folder, SubjectSettings(part="A")).take_over(
        pose, 3, [tmp_path / "other.npz", tmp_path / "other_ir.png"]
    )


def test_copies_where_there_are_no_hard_links(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The same bytes, as files of their own."""

    def refuse(*paths: Path) -> None:
        raise OSError("no hard links here")

    monkeypatch.setattr(os, "link", refuse)
    shared = SharedCaptures.of(tmp_path / "shared", SubjectSettings(part="A"))
    _run(tmp_path / "first", PB, shared)
    second = _run(tmp_path / "second", PB, shared)
    assert second.taken == []
    assert _captures(tmp_path / "first") == _captures(tmp_path / "second")
    assert (stored_depths(tmp_path / "first", 1) == stored_depths(tmp_path / "second", 1)).all()
    assert infrared_path(tmp_path / "second", 0).stat().st_nlink == 1
