"""`franbv run` and `franbv record`, also as `python -m franbv.adapters`: a real camera on a real arm."""

import argparse
import contextlib
import json
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8
from pydantic import ValidationError

from franbv.acquisition import Acquisition, Reconstruction
from franbv.adapters.arms.driver import ArmError
from franbv.adapters.arms.opening import open_arm
from franbv.adapters.camera_error import CameraError
from franbv.adapters.first_fault import first_fault
from franbv.adapters.live.by_hand import MANUAL, manual_arm
from franbv.adapters.live.cell import CellError, RobotCell, read_cell, stated_in
from franbv.adapters.live.confirming import Confirm
from franbv.adapters.live.guard import Guard
from franbv.adapters.live.guarded_arm import Beating, GuardedArm, RefusedError
from franbv.adapters.live.keeper import Keeper, NoKeeper
from franbv.adapters.live.obstacles import AvoidsBoxes, cell_obstacles
from franbv.adapters.live.opened_camera import OpenedCamera, open_camera
from franbv.adapters.live.pulse import Pulse
from franbv.adapters.live.resumed import CannotResumeError
from franbv.adapters.live.stated_sensor import contradicted, stated_sensor, stated_words, thresholds_sections
from franbv.adapters.live.switch import StoppedError, StopSwitch
from franbv.adapters.recording.contents import Recording, RecordingError, RunFacts
from franbv.adapters.recording.opening import record_extra
from franbv.adapters.view.opening import shown_live
from franbv.adapters.view.sight import ViewSink
from franbv.candidates import first_view
from franbv.known_planners import PLANNERS
from franbv.parameters import Parameters

ONE_LINE = (CameraError, RecordingError, CellError, ArmError, RefusedError, CannotResumeError, StoppedError)
"""What ends a command in one line and with status 2."""


def add_live_commands(commands: Any) -> None:
    """Tell the parser (of `argparse`) the command and its flags."""
    flags = commands.add_parser("run", help="reconstruct with a real camera on a real arm; dry run by default")
    flags.set_defaults(run=run_live)
    flags.add_argument(
        "--cell", type=Path, required=True, metavar="FILE.yaml", help="the cell, as docs/robot.md has it"
    )
    flags.add_argument("--arm", required=True, help="ros, manual, or package.module:function")
    flags.add_argument("--camera", required=True, help="realsense, or package.module:function")
    flags.add_argument("--out", type=Path, required=True, help="folder; a run that was stopped in it goes on")
    flags.add_argument("--planner", choices=list(PLANNERS), default="fra")
    flags.add_argument("--parameters", type=Path, metavar="FILE.yaml", help="of the method; default: the paper's")
    flags.add_argument("--camera-settings", type=Path, metavar="FILE.yaml", help="of the camera, by its own names")
    flags.add_argument("--seed", type=int, default=0, help="of the planner's randomness; 0")
    flags.add_argument("--azimuth", type=float, default=0.0, help="of the first view [deg]; 0")
    moves = flags.add_mutually_exclusive_group()
    moves.add_argument("--move", action="store_true", help="show each motion, and make it when it is confirmed")
    moves.add_argument("--go", action="store_true", help="show each motion and make it; any key stops the arm")
    flags.add_argument("--view", action="store_true", help="show the run in a browser while it lasts; extra: view")
    flags.add_argument("--json", action="store_true", help="print one JSON object as the last line of stdout")


def run_live(flags: argparse.Namespace) -> int:
    """Reconstruct, or show what would be done; 0 when that was done. What is in ONE_LINE for all else."""
    cell, parameters = read_cell(flags.cell), _parameters(flags.parameters)
    if flags.seed < 0:
        raise CellError("--seed: give 0 or more")
    _check_frame(cell, parameters, flags.cell)
    found = _last_recording(flags.out)
    if found is not None and found.stop is not None:
        return _finished(flags, f"{found.path}: this run is finished ({found.stop})", len(found.bursts), found.stop)
    switch, title, moves = StopSwitch(), f"{flags.planner}, {flags.cell.stem}", flags.move or flags.go
    page = shown_live(
        flags.view and moves, title, parameters.invalid_share, _warn
    )  # ends last: the arm is closed by then
    with page as view, contextlib.ExitStack() as open_things, switch.at_signals():
        opened = open_camera(flags.camera, _camera_settings(flags))
        open_things.callback(opened.close)
        arm = _opened_arm(flags, cell, parameters, opened, switch, open_things)
        if not moves:
            return _dry_run(arm, parameters, flags)
        ended = _reconstructed(flags, parameters, opened, arm, view)
    words = f"{flags.out}: {len(ended.acquisitions)} acquisitions, ended by {ended.stop}"
    return _finished(flags, words, len(ended.acquisitions), str(ended.stop))


def _opened_arm(
    flags: argparse.Namespace,
    cell: RobotCell,
    parameters: Parameters,
    opened: OpenedCamera,
    switch: StopSwitch,
    open_things: contextlib.ExitStack,
) -> GuardedArm:
    """The arm behind its guard; what was opened for it is closed with the stack."""
    by_hand = flags.arm == MANUAL
    driver = manual_arm(cell.arm, opened.look, _say, input) if by_hand else open_arm(flags.arm, cell.arm)
    open_things.callback(driver.close)
    if isinstance(driver, AvoidsBoxes):
        driver.set_obstacles(cell_obstacles(cell))
    keeper: Beating = NoKeeper()
    if (flags.move or flags.go) and not by_hand:
        keeper = Keeper(flags.arm, cell.arm)
    open_things.callback(keeper.close)
    pulse = Pulse(opened.drain)
    confirm = Confirm(switch, not flags.go and not by_hand, pulse.begin, _say, _ask)
    guard = Guard(cell, opened.camera.min_z)
    return GuardedArm(driver, cell, guard, switch, keeper, confirm, pulse, parameters.roll_deg, by_hand)


def _reconstructed(
    flags: argparse.Namespace, parameters: Parameters, opened: OpenedCamera, arm: GuardedArm, view: ViewSink | None
) -> Reconstruction:
    """The run, from where its last recording ends."""
    with record_extra():
        from franbv.adapters.live.run import LiveRun
    facts = RunFacts(
        title=f"{flags.planner} on {arm.driver.name}",
        planner=flags.planner,
        parameters=parameters.model_dump(mode="json"),
        seed=flags.seed,
        azimuth_deg=flags.azimuth,
        sensor=dict(opened.settings),
        versions=_versions(),
    )

    def show(acquisition: Acquisition, infrared: UInt8[np.ndarray, "h w"] | None) -> None:
        if view is not None:
            view.observe(acquisition, infrared=infrared)

    run = LiveRun(
        opened.camera, arm, PLANNERS[flags.planner].build(), parameters, facts, opened.facts, flags.out,
        opened.infrared, opened.times_ns, _say_acquisition, show, _say,
    )  # fmt: skip
    try:
        return run.go()
    except ValueError as error:
        if isinstance(error, ONE_LINE):
            raise
        raise CellError(f"{flags.cell}: {error}; check workspace, object_box and the arm's reach") from error


def _last_recording(out: Path) -> Recording | None:
    with record_extra():
        from franbv.adapters.live.run import last_recording

        return last_recording(out)


def _finished(flags: argparse.Namespace, words: str, acquisitions: int, stop: str) -> int:
    path = _last_recording(flags.out)
    assert path is not None
    _say(f"{words}. Its report: franbv replay {path.path} --out {flags.out / 'report'}")
    if flags.json:
        _say(json.dumps({"recording": str(path.path), "acquisitions": acquisitions, "stop": stop}))
    return 0


def _dry_run(arm: GuardedArm, parameters: Parameters, flags: argparse.Namespace) -> int:
    """Say where the camera is, and whether and how the first view would be reached."""
    here, goal = arm.camera_pose(), first_view(parameters, flags.azimuth)
    place = ", ".join(f"{x:+.3f}" for x in here.translation)
    _say(f"{arm.driver.name}: the camera is at ({place}) m; nothing is moved without --move or --go")
    here_bad = arm.guard.violation(here)
    if here_bad is not None:
        raise RefusedError(here, f"the camera is {here_bad} where it stands; move it by the arm's own means")
    _say(f"first view: {arm.preview(goal).sentence()}")
    if flags.json:
        _say(json.dumps({"dry_run": True}))
    return 0


def _parameters(path: Path | None) -> Parameters:
    """CellError where the file says what no parameter is. They may stand under `parameters`, as in thresholds.yaml."""
    stated, _ = thresholds_sections(stated_in(path))
    try:
        return Parameters.model_validate(stated)
    except ValidationError as error:
        raise CellError(f"{path}: {first_fault(error, 'parameters')}; see franbv/parameters.py") from None


def _camera_settings(flags: argparse.Namespace) -> dict[str, Any]:
    """The camera's own, with what the thresholds hold for; what of that cannot be set here is said.

    CellError where the two contradict each other.
    """
    own, (_, section) = stated_in(flags.camera_settings), thresholds_sections(stated_in(flags.parameters))
    if not isinstance(section, dict):
        raise CellError(f"{flags.parameters}: sensor: has no settings; give names and values")
    stated = stated_sensor(section, flags.camera)
    clash = contradicted(stated.settings, own)
    if clash is not None:
        raise CellError(f"{flags.parameters}: holds for {clash}; leave that out of {flags.camera_settings}")
    if stated.settings:
        _say(f"camera, by {flags.parameters}: {stated_words(stated.settings)}")
    if stated.others:
        _warn(
            f"{flags.parameters}: holds for {stated_words(stated.others)}; nothing here sets that, see to it yourself"
        )
    return own | stated.settings


def _check_frame(cell: RobotCell, parameters: Parameters, path: Path) -> None:
    """Planner and cell must mean the same table, and the object must be where the planner maps."""
    if cell.table_height != parameters.table_height:
        raise CellError(
            f"{path}: table_height is {cell.table_height} m, the planner's {parameters.table_height} m; give the same"
        )
    lower, upper = cell.object_box
    mapped = zip(parameters.workspace_min, parameters.workspace_max, lower, upper, strict=True)
    if not all(
        least <= low + parameters.voxel_size and high <= most + parameters.voxel_size
        for least, most, low, high in mapped
    ):
        raise CellError(
            f"{path}: object_box is not inside what the planner maps; widen workspace_min and workspace_max"
        )


def _versions() -> dict[str, str]:
    try:
        return {"franbv": version("franbv")}
    except PackageNotFoundError:
        return {}


def _say_acquisition(a: Acquisition) -> None:
    found = "" if a.detection is None or not a.detection.boxes else f", {len(a.detection.boxes)} reflective regions"
    _say(f"{a.index + 1}: {a.kind} view taken, {len(a.model.object.occupied)} voxels of object{found}")


def _ask(words: str) -> None:
    sys.stdout.write(words)
    sys.stdout.flush()


def _warn(words: str) -> None:
    sys.stderr.write(words + "\n")
    sys.stderr.flush()


def _say(words: str) -> None:
    sys.stdout.write(words + "\n")
    sys.stdout.flush()
