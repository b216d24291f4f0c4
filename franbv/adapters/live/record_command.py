"""`franbv record`: bursts of a real camera with the poses of the arm that carries it, taken when a person says so."""

import argparse
import contextlib
import sys
from pathlib import Path

from franbv.adapters.arms.opening import open_arm
from franbv.adapters.live.cell import CellError, read_cell, stated_in
from franbv.adapters.live.opened_camera import OpenedCamera, open_camera
from franbv.adapters.recording.contents import RunFacts
from franbv.adapters.recording.messages import MOST_FRAMES
from franbv.adapters.recording.opening import record_extra
from franbv.parameters import Parameters


def add_record_command(commands: argparse._SubParsersAction) -> None:
    """Tell the parser the command and its flags."""
    n_frames = Parameters().n_frames
    flags = commands.add_parser("record", help="take bursts of a real camera by hand; nothing is moved")
    flags.set_defaults(run=record_bursts)
    flags.add_argument(
        "--cell", type=Path, required=True, metavar="FILE.yaml", help="the cell, as docs/robot.md has it"
    )
    flags.add_argument("--arm", required=True, help="whose pose is asked: ros, manual, or package.module:function")
    flags.add_argument("--camera", required=True, help="realsense, or package.module:function")
    flags.add_argument("--camera-settings", type=Path, metavar="FILE.yaml", help="of the camera, by its own names")
    flags.add_argument("--frames", type=int, default=n_frames, metavar="N", help=f"of each burst, N_k; {n_frames}")
    flags.add_argument("--out", type=Path, required=True, metavar="FILE.mcap", help="write the recording here")


def record_bursts(flags: argparse.Namespace) -> int:
    """Take a burst for each line of standard input until it ends or says q; 0 when some were taken."""
    if not 1 <= flags.frames <= MOST_FRAMES:
        raise CellError(f"--frames {flags.frames}: a burst has 1 to {MOST_FRAMES} frames")
    if flags.out.suffix != ".mcap":
        raise CellError(f"--out {flags.out}: recordings are MCAP; give a file FILE.mcap")
    cell = read_cell(flags.cell)
    with record_extra():
        from franbv.adapters.recording.writer import RecordingWriter
    with contextlib.ExitStack() as open_things:
        opened: OpenedCamera = open_camera(flags.camera, stated_in(flags.camera_settings))
        open_things.callback(opened.close)
        driver = open_arm(flags.arm, cell.arm)
        open_things.callback(driver.close)
        facts = RunFacts(title=f"Taken by hand on {driver.name}", sensor=dict(opened.settings))
        writer = open_things.enter_context(RecordingWriter(flags.out, facts, opened.facts))
        taken = 0
        while _asked_for(taken):
            T_world_cam = cell.camera_at(driver.flange_pose())
            burst = opened.camera.capture(T_world_cam, flags.frames)
            writer.burst(burst, T_world_cam, 0.0, opened.infrared(), opened.times_ns())
            taken += 1
    sys.stdout.write(f"{flags.out}: {taken} bursts of {flags.frames} frames\n")
    return 0


def _asked_for(taken: int) -> bool:
    """Whether another burst is wanted."""
    sys.stdout.write(f"{taken} taken; Enter takes one from where the camera stands, q ends: ")
    sys.stdout.flush()
    said = sys.stdin.readline()
    sys.stdout.write("\n")
    return bool(said) and said.strip().lower() not in ("q", "quit")
