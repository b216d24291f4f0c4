"""A person with the camera: what they are told, what is measured, and that the measured pose is what is used."""

import threading
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.arms.driver import ArmDriver, ArmError
from franbv.adapters.arms.flange_poses import STEP_DEG, STEP_M, pose_distance
from franbv.adapters.arms.manual_arm import GIVE_UP, TAKE, ManualArm, ManualArmSettings, move_words, pose_words
from franbv.frames import look_at, rolled
from tests.franbv.adapters.calibration.board_images import BOARD, CAMERA, FLAT, board_image

START = look_at(np.array([0.25, 0.0, 0.25]), np.zeros(3))
GOAL = look_at(np.array([0.0, -0.22, 0.25]), np.zeros(3))
MEASURED_M, MEASURED_DEG = 0.002, 0.3
"""As `test_charuco` has its worst."""


class Person:
    """Stands at a pose and answers as they are told: with a word, after having gone somewhere."""

    def __init__(self, *answers: tuple[RigidTransform | None, str]) -> None:
        self.pose = START
        self.told: list[str] = []
        self.answers: Iterator[tuple[RigidTransform | None, str]] = iter(answers)
        self.dark = False

    def look(self):
        image = board_image(self.pose.inv() * FLAT)
        return (np.zeros_like(image) if self.dark else image), CAMERA

    def ask(self) -> str:
        pose, word = next(self.answers)
        self.pose = self.pose if pose is None else pose
        return word

    def arm(self, ask: Callable[[], str] | None = None, **settings) -> ManualArm:
        return ManualArm(BOARD, FLAT, self.look, self.told.append, ask or self.ask, ManualArmSettings(**settings))


def near(a: RigidTransform, b: RigidTransform) -> bool:
    """Whether they are the same to what a board tells."""
    metres, degrees = pose_distance(a, b)
    return metres < MEASURED_M and degrees < MEASURED_DEG


def shifted(pose: RigidTransform, metres: float, degrees: float = 0.0) -> RigidTransform:
    """To the camera's right, and turned to the right."""
    return pose * RigidTransform.from_components([metres, 0, 0], Rotation.from_rotvec([0, np.radians(degrees), 0]))


def test_the_measured_pose_is_what_is_used():
    """Asked to one place, a person stands two centimetres beside: accepted, and told as it is."""
    stands = shifted(GOAL, 0.02, 3.0)
    person = Person((stands, ""))
    arm = person.arm()
    assert isinstance(arm, ArmDriver)
    assert near(arm.flange_pose(), START)
    path = arm.plan(GOAL)
    assert path is not None
    assert near(path.poses[0], START)
    assert path.poses[-1] is GOAL
    steps = [pose_distance(a, b) for a, b in zip(path.poses, path.poses[1:], strict=False)]
    assert max(metres for metres, _ in steps) <= STEP_M
    assert max(degrees for _, degrees in steps) <= STEP_DEG
    arm.execute(path, lambda: True)
    assert near(arm.flange_pose(), stands)
    assert not near(arm.flange_pose(), GOAL)
    assert "Taken 20 mm and 3.0 deg from there" in person.told[-1]


def test_a_pose_too_far_off_is_told_and_asked_for_again():
    """How far, and which way; then it is right."""
    person = Person((shifted(GOAL, -0.08), ""), (GOAL, ""))
    arm = person.arm()
    arm.execute(arm.plan(GOAL), lambda: True)
    first, off, taken = person.told
    assert pose_words(GOAL) in first
    assert off.startswith("80 mm and 0.")
    assert "8.0 cm right" in off
    assert taken.startswith("Taken ")


@pytest.mark.parametrize(("answer", "settings"), [(TAKE, {}), ("", {"take_as_it_is": True})])
def test_a_pose_is_taken_as_it_is(answer: str, settings: dict):
    """Far from what was asked, by the person's word or by the settings."""
    stands = shifted(GOAL, 0.06)
    arm = Person((stands, answer)).arm(**settings)
    arm.execute(arm.plan(GOAL), lambda: True)
    assert near(arm.flange_pose(), stands)


def test_a_view_without_the_board_is_asked_for_again():
    """What is wrong is said, and nothing is taken."""
    away = look_at(np.array([0.0, -0.22, 0.25]), np.array([0.0, -2.0, 0.25]))
    person = Person((away, ""), (GOAL, ""))
    arm = person.arm()
    arm.execute(arm.plan(GOAL), lambda: True)
    assert "0 corners found, 8 needed" in person.told[1]


def test_where_the_board_cannot_be_seen_is_out_of_reach():
    """Looking elsewhere, from behind the board, along it: a pose could not be confirmed there."""
    arm = Person().arm()
    assert arm.can_reach(GOAL)
    assert not arm.can_reach(look_at(np.array([0.0, -0.3, 0.3]), np.array([0.0, -2.0, 0.3])))
    assert not arm.can_reach(look_at(np.array([0.0, -0.1, -0.3]), np.zeros(3)))
    assert not arm.can_reach(look_at(np.array([0.5, 0.0, 0.03]), np.zeros(3)))
    assert arm.plan(look_at(np.array([0.0, -0.1, -0.3]), np.zeros(3))) is None


@pytest.mark.parametrize("who", ["guard", "guard's error", "stop", "person", "end of input"])
def test_it_can_be_ended(who: str):
    """While the person is waited for as well; they are told to hold still, and ArmError says why."""
    asked, over = threading.Event(), threading.Event()

    def ask() -> str:
        asked.set()
        if who == "person":
            return GIVE_UP
        if who == "end of input":
            raise EOFError
        over.wait(30)
        return ""

    def may_go_on() -> bool:
        if who == "guard's error" and asked.is_set():
            raise RuntimeError("asleep")
        if who == "stop" and asked.is_set():
            arm.stop()
        return who != "guard" or not asked.is_set()

    person = Person()
    arm = person.arm(ask)
    words = {"person": "gave up", "end of input": "nobody answers .EOFError", "guard's error": "RuntimeError: asleep"}
    with pytest.raises(ArmError, match=words.get(who, "was stopped")):
        arm.execute(arm.plan(GOAL), may_go_on)
    over.set()
    assert person.told[-1] == "Stop: hold the camera still."
    assert len(person.told) == 2


def test_a_camera_that_fails_and_a_board_that_is_dark():
    """Both are ArmError in one line."""
    person = Person()
    person.dark = True
    with pytest.raises(ArmError, match=r"a person with the camera.*0 corners found"):
        person.arm().flange_pose()

    def look():
        raise RuntimeError("unplugged")

    arm = ManualArm(BOARD, FLAT, look, person.told.append, person.ask)
    with pytest.raises(ArmError, match=r"no image came .RuntimeError: unplugged"):
        arm.can_reach(GOAL)
    arm.stop()
    arm.close()


def test_words_for_a_pose_and_a_way():
    """By hand: a camera above the table looking down along +x, rolled by 30 deg; then left, up, back, and turned."""
    pose = rolled(look_at(np.array([-0.3, 0.0, 0.3]), np.zeros(3)), 30.0)
    assert pose_words(pose) == "(-30.0, 0.0, 30.0) cm, looking 45 deg down towards azimuth 0 deg, rolled by 30 deg"
    step = RigidTransform.from_components([-0.03, -0.04, -0.12], Rotation.from_rotvec([0, 0, 0.5 * np.pi]))
    assert move_words(pose, pose * step) == (
        "13.0 cm away: 3.0 cm left, 4.0 cm up, 12.0 cm back, turn 90 deg clockwise"
    )
    turn = RigidTransform.from_rotation(Rotation.from_rotvec([0.0, np.radians(20), 0.0]))
    assert "turn 20 deg right" in move_words(pose, pose * turn)
    assert (pose * turn).rotation.apply([0, 0, 1]) @ pose.rotation.apply([1, 0, 0]) > 0  # it looks to its right then
