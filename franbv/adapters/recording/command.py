"""`python -m franbv.adapters replay`: a recording replayed where only the planner is installed; no report is drawn."""

import argparse
import contextlib
import json
import math
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from franbv.adapters.first_fault import first_fault
from franbv.adapters.recording.bags.choices import BagChoices
from franbv.adapters.recording.contents import Recording, RecordingError
from franbv.adapters.recording.decisions import decision_of
from franbv.adapters.recording.opening import open_recording
from franbv.adapters.recording.replay import Replay, replay
from franbv.adapters.view.opening import rrd_file
from franbv.adapters.view.sight import ViewSink
from franbv.known_planners import PLANNERS
from franbv.parameters import Parameters

REPLAY_FILE = "replay.json"
"""What a replay leaves in its folder: figures, decisions and, open-loop, proposals."""
BAG_PLANNER = "fra"
"""Of a recording that no planner made."""


def add_recording_commands(commands: Any) -> None:
    """Tell the parser (of `argparse`) the command and its flags."""
    flags = commands.add_parser("replay", help="detect and plan on a recording, with no robot")
    flags.set_defaults(run=replay_recording)
    flags.add_argument("recording", type=Path, help="file .mcap, .db3 or .bag, or a folder of rosbag2")
    flags.add_argument("--out", type=Path, help=f"folder for {REPLAY_FILE}")
    flags.add_argument("--rrd", type=Path, metavar="FILE.rrd", help="write it for the viewer rerun as well")
    flags.add_argument("--json", action="store_true", help="print one JSON object as the last line of stdout")
    flags.add_argument("--planner", choices=list(PLANNERS), help="default: the recorded one, else fra")
    flags.add_argument("--n-frames", type=int, help="frames of a burst; default: as recorded")
    flags.add_argument("--poses", type=Path, help="poses, `time x y z qx qy qz qw` a line, or a recording of the run")
    flags.add_argument("--depth-topic", help="where there are several")
    flags.add_argument("--pose-topic", help="where there are several")
    flags.add_argument("--world-frame", help="of the transforms; default: their root")
    flags.add_argument("--min-z", type=float, help="smallest depth that the camera measures [m], where no file says it")


def replay_recording(flags: argparse.Namespace) -> int:
    """Replay; exit status 0. RecordingError for bad input."""
    _check_flags(flags)
    n_frames = flags.n_frames or Parameters().n_frames
    named = flags.depth_topic, flags.pose_topic, flags.world_frame
    choices = BagChoices(n_frames, *named, flags.poses, flags.min_z)
    recording = open_recording(flags.recording, choices)
    for notice in recording.notices:
        sys.stderr.write(f"{notice}\n")
    if recording.run.ablation:
        raise RecordingError(
            f"{recording.path}: was planned by a changed method ({', '.join(recording.run.ablation)}); "
            "replay it with `franbv replay`"
        )
    parameters = recorded_parameters(recording)
    if flags.n_frames:
        parameters = parameters.model_copy(update={"n_frames": flags.n_frames})
    planner = flags.planner or recording.run.planner or BAG_PLANNER
    if planner not in PLANNERS:
        raise RecordingError(f"{recording.path}: was planned by {planner}; choose one of {', '.join(PLANNERS)}")
    with _view(flags.rrd, recording, parameters) as view:
        observe = (lambda acquisition: None) if view is None else view.observe
        start = recording.run.seed, recording.run.azimuth_deg
        found = replay(recording, PLANNERS[planner].build(), parameters, *start, observe)
        if view is not None:
            _show_infrared(view, recording, found)
    if flags.out is not None:
        write_replay(flags.out, found)
    sys.stdout.write(replay_sentence(found) + "\n")
    if flags.json:
        sys.stdout.write(json.dumps(replay_figures(found)) + "\n")
    return 0


@contextlib.contextmanager
def _view(file: Path | None, recording: Recording, parameters: Parameters) -> Iterator[ViewSink | None]:
    """What writes the replay for the viewer; None where that is not wanted."""
    if file is None:
        yield None
        return
    with rrd_file(file, recording.run.title or recording.path.stem, parameters.invalid_share) as view:
        yield view


def _show_infrared(view: ViewSink, recording: Recording, found: Replay) -> None:
    for acquisition, number in zip(found.run.acquisitions, found.bursts, strict=True):
        image = recording.bursts[number].read_infrared()
        if image is not None:
            view.infrared(acquisition.index, image)


def _check_flags(flags: argparse.Namespace) -> None:
    """RecordingError for numbers that mean nothing; NaN is one of them."""
    if flags.n_frames is not None and flags.n_frames < 1:
        raise RecordingError(f"--n-frames {flags.n_frames}: a burst has frames; ask for 1 at least")
    if flags.min_z is not None and not 0 < flags.min_z < math.inf:
        raise RecordingError(f"--min-z {flags.min_z:g}: is no distance; give metres above 0, or leave it out")


def recorded_parameters(recording: Recording) -> Parameters:
    """The parameters of the run; RecordingError where this version does not know them."""
    try:
        return Parameters.model_validate(dict(recording.run.parameters))
    except ValidationError as error:
        fault = first_fault(error, "parameters")
        raise RecordingError(f"{recording.path}: parameter {fault}; read it with the version that wrote it") from error


def replay_figures(found: Replay) -> dict[str, Any]:
    """What `--json` prints."""
    difference = found.first_difference
    return {
        "acquisitions": len(found.run.acquisitions),
        "mode": found.mode,
        "decisions": found.n_decisions,
        "decisions_equal": found.decisions_equal,
        "first_difference": None if difference is None else difference.as_dict(),
        "stop": str(found.run.stop),
    }


def replay_sentence(found: Replay) -> str:
    """The same in words."""
    how = {"closed_loop": "closed-loop, as the planner asks", "open_loop": "open-loop, at the poses as recorded"}
    words = f"{len(found.run.acquisitions)} acquisitions replayed {how[found.mode]}"
    difference = found.first_difference
    if difference is not None:
        return (
            f"{words}; it decides otherwise from acquisition {difference.acquisition} on: {difference.what} was "
            f"{difference.recorded} and is {difference.replayed}."
        )
    whole = "every decision is as recorded" if found.n_decisions else "the recording holds no decisions"
    return f"{words}; {whole}."


def write_replay(folder: Path, found: Replay) -> None:
    """Write figures, decisions and proposals; RecordingError where the folder cannot be written."""
    whole = {
        **replay_figures(found),
        "replayed": [decision_of(acquisition) for acquisition in found.run.acquisitions],
        "proposals": [proposal.as_dict() for proposal in found.proposals],
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        temporary = folder / f".{REPLAY_FILE}.tmp"
        temporary.write_text(json.dumps(whole, indent=1))
        os.replace(temporary, folder / REPLAY_FILE)
    except OSError as error:
        raise RecordingError(f"{folder}: cannot be written ({error.strerror}); name another folder") from error
