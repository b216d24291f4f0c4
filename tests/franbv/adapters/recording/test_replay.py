"""A replay decides as the run did, says where it does not, and looks view by view where nobody knows what is seen."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from franbv.adapters.recording.contents import Recording, RecordingError
from franbv.adapters.recording.decisions import decision_of, first_difference
from franbv.adapters.recording.mcap_recording import read_recording
from franbv.adapters.recording.replay import replay
from franbv.planners import fra, pb
from franbv.reconstruction import reconstruct
from franbv.stopping import StopReason
from tests.franbv.adapters.recording.recorded_run import PARAMETERS, SEED, camera
from tests.franbv.analytic_camera import FreeArm


@pytest.fixture(scope="module")
def recording(recorded) -> Recording:
    """The shared run's."""
    return read_recording(recorded.path)


def test_every_decision_is_reproduced(recorded, recording):
    """The planner on recorded depth decides as it did: every number of every decision, to the bit."""
    seen = []
    found = replay(recording, fra(), PARAMETERS, SEED, observe=seen.append)
    assert (found.mode, found.decisions_equal, found.first_difference) == ("closed_loop", True, None)
    assert found.n_decisions == len(recorded.run.acquisitions)
    again = [decision_of(a) for a in found.run.acquisitions]
    assert json.dumps(again) == json.dumps([decision_of(a) for a in recorded.run.acquisitions])
    assert found.run.stop == recorded.run.stop
    assert seen == list(found.run.acquisitions)
    assert found.bursts == tuple(range(len(seen)))
    maps = [
        (a.model.voxel_map.log_odds, b.model.voxel_map.log_odds)
        for a, b in zip(seen, recorded.run.acquisitions, strict=True)
    ]
    assert all(np.array_equal(one, other) for one, other in maps)


def test_an_earlier_end_is_the_first_difference(recording):
    """With N_max lowered by one, all is as recorded up to where the last iteration would begin."""
    last = next(d["index"] for d in recording.decisions if d["iteration"] == PARAMETERS.max_iterations)
    found = replay(recording, fra(), PARAMETERS.model_copy(update={"max_iterations": 1}), SEED)
    assert (found.mode, found.decisions_equal) == ("closed_loop", False)
    assert found.first_difference is not None
    assert found.first_difference.as_dict() == {
        "acquisition": last,
        "what": "acquisitions",
        "recorded": len(recording.decisions),
        "replayed": last,
    }


def test_more_iterations_use_the_recording_up(recording):
    """With N_max raised the planner asks for a view that nobody took: the replay ends, and the stop differs."""
    found = replay(recording, fra(), PARAMETERS.model_copy(update={"max_iterations": 9}), SEED)
    assert found.run.stop == StopReason.RECORDING_ENDED
    assert found.first_difference is not None
    assert found.first_difference.what == "stop"
    assert found.first_difference.recorded == "max_iterations"


def test_a_changed_weight_differs_in_the_utility_first(recording):
    """Weights do not touch the first view, its map or what is found in it; the next choice is the first to feel them.

    Either its utility is another, or another pose is chosen.
    """
    changed = PARAMETERS.model_copy(update={"weight_base": 0.9})
    found = replay(recording, fra(), changed, SEED)
    assert found.decisions_equal is False
    assert found.first_difference is not None
    assert found.first_difference.acquisition == 1
    assert found.first_difference.what in ("utility", "pose")
    assert found.first_difference.recorded != found.first_difference.replayed


def test_a_planner_that_goes_elsewhere_is_shown_the_recording(recorded, recording):
    """Another seed asks for other poses: every recorded view is looked at, and the planner says where it would go."""
    found = replay(recording, fra(), PARAMETERS, SEED + 1)
    assert found.mode == "open_loop"
    assert found.decisions_equal is False
    assert found.run.stop == StopReason.RECORDING_ENDED
    poses = [a.burst.T_world_cam.as_matrix() for a in found.run.acquisitions]
    assert np.array_equal(poses, [a.burst.T_world_cam.as_matrix() for a in recorded.run.acquisitions])
    assert [a.kind for a in found.run.acquisitions] == [a.kind for a in recorded.run.acquisitions]
    assert [p.acquisition for p in found.proposals] == list(range(len(poses)))
    assert all(a.gamma is None for a in found.run.acquisitions)


def test_open_loop_maps_what_the_run_mapped(recorded, recording):
    """The map depends on bursts alone: the last one is the run's, whatever was proposed."""
    found = replay(replace(recording, decisions=()), fra(), PARAMETERS, SEED)
    assert (found.mode, found.decisions_equal, found.first_difference) == ("open_loop", None, None)
    log_odds = [run.acquisitions[-1].model.voxel_map.log_odds for run in (found.run, recorded.run)]
    assert np.array_equal(*log_odds)


def test_the_first_proposal_is_the_recorded_decision(recorded, recording):
    """From the first view the planner knows as much as in the run, and proposes what it did."""
    assert recorded.run.acquisitions[0].activates
    undecided = replace(recording, decisions=())
    proposed, without_recovery = (
        replay(undecided, planner, PARAMETERS, SEED).proposals[0] for planner in (fra(), pb())
    )
    assert (proposed.kind, without_recovery.kind) == ("recovery", "nbv")
    second = recorded.run.acquisitions[1]
    assert np.array_equal(proposed.T_world_cam.as_matrix(), second.burst.T_world_cam.as_matrix())
    assert proposed.utility == second.utility


@pytest.mark.parametrize("seed", [0, 2, 3])
def test_recovery_poses_in_random_order_are_proposed_so(recording, seed: int):
    """The ablation draws the pose as the loop does: from the first view on, both begin with the same draw.

    Of four poses the best is drawn by all three seeds with a chance of 1 / 64 alone.
    """
    at_random = PARAMETERS.model_copy(update={"recovery_order": "random", "max_iterations": 1})
    made = reconstruct(camera(), FreeArm(), fra(), at_random, seed)
    assert made.acquisitions[0].activates
    first_view = replace(recording, bursts=recording.bursts[:1], decisions=())
    proposed = replay(first_view, fra(), at_random, seed).proposals[0]
    chosen = made.acquisitions[1].burst.T_world_cam.as_matrix()
    assert np.array_equal(proposed.T_world_cam.as_matrix(), chosen)


def test_a_cut_recording_is_replayed_as_far_as_it_goes(recorded, tmp_path: Path):
    """What a killed run leaves is replayed closed-loop, and its decisions are equal as far as they were written."""
    path = tmp_path / "cut.mcap"
    path.write_bytes(recorded.path.read_bytes()[: int(0.7 * recorded.path.stat().st_size)])
    cut = read_recording(path)
    assert 0 < len(cut.bursts) < len(recorded.run.acquisitions)
    found = replay(cut, fra(), PARAMETERS, SEED)
    assert (found.mode, found.decisions_equal) == ("closed_loop", True)
    assert len(found.run.acquisitions) == len(cut.bursts)
    assert found.run.stop == StopReason.RECORDING_ENDED


def test_fewer_frames_can_be_asked_for_and_more_cannot(recording):
    """A burst has what it has."""
    with pytest.raises(RecordingError, match="ask for at most 3"):
        replay(recording, fra(), PARAMETERS.model_copy(update={"n_frames": 4}), SEED)
    found = replay(recording, fra(), PARAMETERS.model_copy(update={"n_frames": 1}), SEED)
    assert all(len(a.burst.depths) == 1 for a in found.run.acquisitions)


def test_differences_are_found_where_they_are():
    """The first place in which two decisions differ by more than rounding; a missing one counts."""
    one = [{"index": 0, "boxes": [{"centre": [0.1, 0.2]}], "utility": None}]
    assert first_difference(one, [{"index": 0, "boxes": [{"centre": [0.1, 0.2 + 1e-12]}], "utility": None}]) is None
    found = first_difference(one, [{"index": 0, "boxes": [{"centre": [0.1, 0.3]}], "utility": None}])
    assert found is not None
    assert (found.acquisition, found.what, found.recorded, found.replayed) == (0, "boxes.0.centre.1", 0.2, 0.3)
    for other, what in [
        ([{"index": 0, "boxes": [], "utility": None}], "boxes.length"),
        ([{"index": 0, "boxes": [{"centre": [0.1, 0.2]}], "utility": 0.0}], "utility"),
        ([{"index": True, "boxes": [{"centre": [0.1, 0.2]}], "utility": None}], "index"),
        ([{**one[0], "T_world_cam": [[0.0]]}], "pose"),
        ([], "acquisitions"),
    ]:
        found = first_difference(one, other)
        assert found is not None
        assert found.what == what
