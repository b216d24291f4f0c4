"""An arm that is a person: it says where the camera should go, waits, and measures where it went by a ChArUco board.

The flange is the camera itself and the base is the world, so that the hand-eye calibration is the identity and every
T_base_flange here is a T_world_cam. Nobody holds a camera to the millimetre: what counts is where it is, so
`flange_pose` is always measured anew, and after `execute` it is that pose, not the one that was asked for, which
belongs to the images."""

import threading
from collections.abc import Callable
from typing import Annotated

import numpy as np
from jaxtyping import UInt8
from pydantic import BaseModel, ConfigDict, Field
from scipy.spatial.transform import RigidTransform

from franbv.adapters.arms.driver import POLL_S, ArmError, FlangePath
from franbv.adapters.arms.flange_poses import pose_distance
from franbv.adapters.arms.straight import straight_poses
from franbv.adapters.calibration.calibration_error import CalibrationError
from franbv.adapters.calibration.charuco import CharucoBoard, ViewRules, find_board
from franbv.frames import Intrinsics, project
from franbv.parameters import Count, Positive

TakesImage = Callable[[], tuple[UInt8[np.ndarray, "h w"], Intrinsics]]
"""Takes a rectified infrared image with the projector off."""
TAKE, GIVE_UP = "t", "q"
"""Answers beside Enter: take the camera as it stands, give up."""
STEEPEST_DEG = 75.0
"""Between a line of sight and the board's normal where markers are still read [deg] (choice: a square is a quarter as
high as wide)."""


class ManualArmSettings(BaseModel):
    """Settings of `ManualArm`. Frozen; unknown keys and numbers out of range raise pydantic's ValidationError."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    position_tolerance_m: Positive = 0.03
    """From the pose that was asked for, at most [m] (choice: a tripod's patience)."""
    angle_tolerance_deg: Positive = 8.0
    """The same of its orientation [deg] (choice: at 0.4 m it moves what is looked at by 56 mm)."""
    take_as_it_is: bool = False
    """Take the camera wherever it stands, without a tolerance; the planner gets its true pose in any case."""
    min_corners: Annotated[int, Field(ge=6)] = 8
    """Corners of the board that must be seen [-] (`ViewRules`)."""
    max_reprojection_px: Positive = 1.0
    """How well they must fit [px] (`ViewRules`)."""
    looks: Count = 3
    """Images that are tried before a view counts as bad [-] (choice: one may be blurred by a knock)."""


class ManualArm:
    """An `ArmDriver` whose motor is a person.

    board, T_world_board: what lies in the world, and where. look: takes an image. say: shows a line to the person. ask:
    waits for a line from them, such as `input`; while it waits, `may_go_on` is asked as everywhere.
    """

    def __init__(
        self,
        board: CharucoBoard,
        T_world_board: RigidTransform,
        look: TakesImage,
        say: Callable[[str], None],
        ask: Callable[[], str],
        settings: ManualArmSettings | None = None,
    ) -> None:
        self.board = board
        self.T_world_board = T_world_board
        self.settings = settings or ManualArmSettings()
        self._look, self._say, self._ask = look, say, ask
        self._rules = ViewRules(self.settings.min_corners, self.settings.max_reprojection_px)
        self._intrinsics: Intrinsics | None = None
        self._stopped = threading.Event()
        self._waiting: _Question | None = None

    @property
    def name(self) -> str:
        """For people."""
        return "a person with the camera and a board"

    def flange_pose(self) -> RigidTransform:
        """Where the camera is now, T_world_cam, measured; ArmError where the board is not seen well."""
        try:
            return self._measured()
        except CalibrationError as error:
            raise self._stopped_with(f"{self.name}: {error}") from error

    def can_reach(self, T_base_flange: RigidTransform) -> bool:
        """Whether the board would be seen from there; a person reaches everything else."""
        if self._intrinsics is None:
            _, self._intrinsics = self._image()
        T_cam_board = T_base_flange.inv() * self.T_world_board
        points = T_cam_board.apply(self.board.points())
        normal = T_cam_board.rotation.apply([0.0, 0.0, 1.0])  # into the board, away from who sees it
        slant = np.degrees(np.arccos(np.clip(points @ normal / np.linalg.norm(points, axis=1), -1.0, 1.0)))
        pixels = project(points, self._intrinsics)
        u_max, v_max = self._intrinsics.width - 1, self._intrinsics.height - 1
        with np.errstate(invalid="ignore"):
            inside = (pixels[:, 0] >= 0) & (pixels[:, 0] <= u_max) & (pixels[:, 1] >= 0) & (pixels[:, 1] <= v_max)
        return bool((inside & (slant < STEEPEST_DEG)).sum() >= self.settings.min_corners)

    def plan(self, T_base_flange: RigidTransform) -> FlangePath | None:
        """The straight way there, which is what the person is told; None where the board would not be seen at its
        end."""
        begin = self.flange_pose()
        if not self.can_reach(T_base_flange):
            return None
        return FlangePath(straight_poses(begin, T_base_flange), 0.0)

    def execute(self, path: FlangePath, may_go_on: Callable[[], bool]) -> None:
        """Ask the person to bring the camera to the path's end, until it is there or they take it as it stands.

        ArmError when they give up, and when `may_go_on` ends it: they are told to hold still then.
        """
        self._stopped.clear()
        goal, now = path.poses[-1], path.poses[0]
        self._say(
            f"Camera to {pose_words(goal)}; {move_words(now, goal)}. Then Enter, or {TAKE} as it is, {GIVE_UP} to end."
        )
        while True:
            answer = self._answered(may_go_on).strip().lower()
            if answer == GIVE_UP:
                raise self._stopped_with("the person with the camera gave up")
            try:
                now = self._measured()
            except CalibrationError as error:
                self._say(f"{error}. Then Enter.")
                continue
            metres, degrees = pose_distance(now, goal)
            s = self.settings
            close = metres <= s.position_tolerance_m and degrees <= s.angle_tolerance_deg
            if close or s.take_as_it_is or answer == TAKE:
                self._say(f"Taken {1e3 * metres:.0f} mm and {degrees:.1f} deg from there: hold still.")
                return
            self._say(
                f"{1e3 * metres:.0f} mm and {degrees:.1f} deg off; {move_words(now, goal)}. Then Enter, or {TAKE}."
            )

    def stop(self) -> None:
        """Tell the person to hold still, once; never raises."""
        if not self._stopped.is_set():
            self._stopped.set()
            try:
                self._say("Stop: hold the camera still.")
            except Exception:
                return  # nobody is there to be told

    def close(self) -> None:
        """Nothing is held that could be let go."""
        self.stop()

    def _image(self) -> tuple[UInt8[np.ndarray, "h w"], Intrinsics]:
        try:
            return self._look()
        except Exception as error:
            raise self._stopped_with(f"{self.name}: no image came ({type(error).__name__}: {error})") from error

    def _measured(self) -> RigidTransform:
        for left in reversed(range(self.settings.looks)):
            image, self._intrinsics = self._image()
            try:
                view = find_board(image, self._intrinsics, self.board, self._rules)
            except CalibrationError:
                if not left:
                    raise
                continue
            return self.T_world_board * view.T_cam_board.inv()
        raise CalibrationError("board: was not looked at")

    def _answered(self, may_go_on: Callable[[], bool]) -> str:
        """What the person answers; a question that an earlier motion left open is still open."""
        question = self._waiting = self._waiting or _Question(self._ask)
        while not question.answered.wait(POLL_S):
            try:
                goes_on = may_go_on()
            except Exception as error:
                raise self._stopped_with(f"{type(error).__name__}: {error}") from error
            if self._stopped.is_set() or not goes_on:
                raise self._stopped_with("the motion was stopped: whoever watches it said so")
        self._waiting = None
        if question.error is not None:
            raise self._stopped_with(f"nobody answers ({type(question.error).__name__})")
        return question.words

    def _stopped_with(self, words: str) -> ArmError:
        self.stop()
        return ArmError(" ".join(words.split()))


class _Question:
    """Waits for a line in a thread of its own, since reading a key cannot be interrupted."""

    def __init__(self, ask: Callable[[], str]) -> None:
        self.words = ""
        self.error: BaseException | None = None
        self.answered = threading.Event()
        self._ask = ask
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self) -> None:
        try:
            self.words = self._ask()
        except BaseException as error:  # the end of the input, above all
            self.error = error
        self.answered.set()


def pose_words(T_world_cam: RigidTransform) -> str:
    """Where a camera stands and looks, for a person: place, elevation above the horizon, azimuth, roll."""
    x, y, z = 100 * T_world_cam.translation
    right, _, forward = T_world_cam.rotation.as_matrix().T
    tilt = np.degrees(np.arcsin(np.clip(forward[2], -1.0, 1.0)))
    azimuth = np.degrees(np.arctan2(forward[1], forward[0]))
    level = np.cross(forward, [0.0, 0.0, 1.0])  # where an upright camera has its right
    if np.linalg.norm(level) < 1e-6:  # straight up or down, as `franbv.frames.look_at`
        level = np.cross(forward, [0.0, 1.0, 0.0])
    level = level / np.linalg.norm(level)
    roll = np.degrees(np.arctan2(right @ np.cross(forward, level), right @ level))
    return (
        f"({x:.1f}, {y:.1f}, {z:.1f}) cm, looking {abs(tilt):.0f} deg {'up' if tilt > 0 else 'down'} towards azimuth "
        f"{azimuth:.0f} deg, rolled by {roll:.0f} deg"
    )


def move_words(now: RigidTransform, goal: RigidTransform) -> str:
    """How to get from one pose to the other, as the camera sees it: shifts first, then turns."""
    step = now.inv() * goal
    x, y, z = 100 * step.translation
    pitch, yaw, roll = step.rotation.as_rotvec(degrees=True)
    shifts = [(x, "right", "left"), (y, "down", "up"), (z, "forward", "back")]
    turns = [(yaw, "right", "left"), (pitch, "up", "down"), (roll, "clockwise", "anticlockwise")]
    words = [f"{abs(cm):.1f} cm {more if cm > 0 else less}" for cm, more, less in shifts if abs(cm) >= 0.05]
    words += [f"turn {abs(deg):.0f} deg {more if deg > 0 else less}" for deg, more, less in turns if abs(deg) >= 0.5]
    return f"{100 * pose_distance(now, goal)[0]:.1f} cm away" + (f": {', '.join(words)}" if words else "")
