"""Detection and planning on a recording, with no robot: as the run was planned, or view by view where it was not.

Closed loop: the planner runs as it does on a robot, and is given the recorded burst of each pose that it asks for. That
works as long as it decides as in the recording. As soon as it asks for a pose that the recording does not hold, what
would have been seen there is not known: then the replay is open-loop (`franbv.adapters.recording.open_loop`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from franbv.acquisition import Acquisition, Reconstruction
from franbv.adapters.recording.contents import Recording, RecordingError
from franbv.adapters.recording.decisions import DecisionDifference, decision_of, first_difference
from franbv.adapters.recording.open_loop import Proposal, open_loop
from franbv.adapters.recording.tape import OffTapeError, Tape
from franbv.parameters import Parameters
from franbv.planners import Planner
from franbv.reconstruction import reconstruct
from franbv.stopping import StopReason

ReplayMode = Literal["closed_loop", "open_loop"]


@dataclass(frozen=True, eq=False)
class Replay:
    """What a replay found."""

    run: Reconstruction
    """Its acquisitions, as of any run."""
    mode: ReplayMode
    first_difference: DecisionDifference | None
    """Where the planner first decided otherwise than in the recording; None: nowhere, or that holds no decisions."""
    n_decisions: int
    """Decisions that the recording holds [-]."""
    bursts: tuple[int, ...]
    """Number of the recorded burst of each acquisition."""
    proposals: tuple[Proposal, ...] = ()
    """Open-loop: where the planner would have gone from each burst."""

    @property
    def decisions_equal(self) -> bool | None:
        """Whether all decisions are those of the recording; None where it holds none."""
        return None if self.n_decisions == 0 else self.first_difference is None


def replay(
    recording: Recording,
    planner: Planner,
    parameters: Parameters,
    seed: int,
    first_azimuth_deg: float = 0.0,
    observe: Callable[[Acquisition], None] = lambda acquisition: None,
) -> Replay:
    """Plan on the recorded bursts; the arguments are those of `franbv.reconstruction.reconstruct`.

    observe: called with each acquisition of the result once it is settled which kind of replay it is.
    """
    check_frames(recording, parameters)
    seen: list[Acquisition] = []
    tape = Tape(recording)
    try:
        if not recording.decisions:
            raise OffTapeError(at_end=False)
        ended = reconstruct(tape, tape, planner, parameters, seed, first_azimuth_deg, seen.append)
    except OffTapeError as left:
        ended = Reconstruction(tuple(seen), StopReason.RECORDING_ENDED) if left.at_end else None
    difference = _difference(recording, seen, ended, tape)
    if ended is not None:
        for acquisition in seen:
            observe(acquisition)
        return Replay(ended, "closed_loop", difference, len(recording.decisions), tuple(tape.given))
    run, proposals = open_loop(recording, planner, parameters, seed, tape.reachable, observe)
    bursts = tuple(range(len(recording.bursts)))
    return Replay(run, "open_loop", difference, len(recording.decisions), bursts, proposals)


def check_frames(recording: Recording, parameters: Parameters) -> None:
    """RecordingError where bursts have fewer frames than are asked for."""
    fewest = min(burst.n_frames for burst in recording.bursts)
    if fewest < parameters.n_frames:
        raise RecordingError(
            f"{recording.path}: has bursts of {fewest} frames, and n_frames is {parameters.n_frames}; "
            f"ask for at most {fewest}"
        )


def _difference(
    recording: Recording, seen: list[Acquisition], ended: Reconstruction | None, tape: Tape
) -> DecisionDifference | None:
    """Between the recorded decisions and those that the planner took until the replay left them."""
    recorded, replayed = recording.decisions, [decision_of(a) for a in seen]
    if not recorded:
        return None
    both = min(len(recorded), len(replayed))
    found = first_difference(recorded[:both], replayed[:both])
    if found is not None:
        return found
    if ended is None:
        was = recorded[both]["T_world_cam"] if both < len(recorded) else None
        now = None if tape.asked_elsewhere is None else tape.asked_elsewhere.as_matrix().tolist()
        return DecisionDifference(both, "pose", was, now)
    if both < len(recorded) or (recording.stop is not None and both < len(replayed)):
        return DecisionDifference(both, "acquisitions", len(recorded), len(replayed))
    if recording.stop in (None, ended.stop):
        return None
    return DecisionDifference(both, "stop", recording.stop, str(ended.stop))
