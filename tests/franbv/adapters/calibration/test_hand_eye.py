"""The hand-eye calibration against closed forms, against OpenCV's test data and against a published calibration."""

import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.adapters.calibration.calibration_error import CalibrationError
from franbv.adapters.calibration.hand_eye import board_misfits, closed_form, hand_eye, refined, rms, turns_deg

X = RigidTransform.from_components([0.03, -0.05, 0.08], Rotation.from_euler("xyz", [10, -20, 95], degrees=True))
Y = RigidTransform.from_components([0.5, 0.1, 0.02], Rotation.from_euler("xyz", [180, 3, 20], degrees=True))
SQUARE = 0.2 * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
EXACT = 1e-9

CHESSBOARD = 0.0285 * np.array([[x, y, 0.0] for y in range(6) for x in range(8)])
"""Inner corners of Tabb and Ahmad Yousef's dataset 1 (8 x 6, 28.5 mm)."""
PUBLISHED_HAND = RigidTransform.from_components(
    [0.00898549, 0.029718, -0.00296242],
    Rotation.from_matrix(
        [[0.997365, -0.0725279, 0.00171889], [0.072544, 0.997283, -0.0128158], [-0.000784715, 0.0129068, 0.999916]]
    ),
)
"""T_cam_flange, their Z, by reprojection of all 88 poses: rwhe_AA_RPI/transformations.txt of the same dataset."""
OPENCV_PARK = [-0.001364806, 0.006659557, 0.019586780], [-0.012701526, -0.004187891, -0.063666274]
"""T_flange_cam of the same poses by OpenCV 4.14.0, calibrateHandEye with CALIB_HAND_EYE_PARK: place [m], rotation
vector."""

# OpenCV, modules/calib3d/test/test_calibration_hand_eye.cpp, regression_24871: target to camera, gripper to base, and
# the camera to gripper that OpenCV's test wants to 1e-12.
OPENCV_TRUTH = [[0, 0, -1, 0.1], [1, 0, 0, 0.2], [0, -1, 0, 0.3], [0, 0, 0, 1]]
OPENCV_BOARDS = """
0.04964505493834381 0.5136826827431226 0.8565427426404346 -0.3923117691818854 0.7987004864191318 -0.4562554205214679
-0.9184916136152514 -0.3133809733274676 0.2411752915926112 -1.588728904724121 0.07843752950429916 -1.002813339233398
-0.3048000068139332 0.6971848192711539 0.6488684640388026 -0.9377589344241749 -0.3387497187353627 -0.07652979135179161
0.1664486009369332 -0.6318084803439735 0.7570422097951847 -1.906493663787842 -0.07281044125556946 0.6088893413543701
-0.590234879685801 -0.7051138289845309 -0.3929850823848928 0.6017371069678565 -0.7088332765096816 0.3680595606834615
-0.5380847896941907 -0.01923211603859842 0.8426712792141644 -0.9809040427207947 -0.2707894444465637 -0.2577074766159058
0.7643667483125168 -0.08523002870239212 0.63912386614923 -0.2583463792779588 0.8676987164647345 0.424683512464778
-0.5907627462764713 -0.489729292214425 0.6412211770980741 -1.58987033367157 -1.924914002418518 -0.3109001517295837
"""
OPENCV_FLANGES = """
-0.4143743581399177 -0.6105088815982459 -0.6749613298595637 -0.1598851232573451 -0.6812625208693498 0.71436554019614
-0.895952364066927 0.4039310376145889 0.1846864320259794 -1.249274406461827 -1.916570771580279 2.005069553422765
0.7262439860936567 -0.201662933718935 -0.6571923111439066 -0.4640017362244384 -0.8491808316335328 -0.2521791108852766
-0.5072199339965884 0.4880819361030014 -0.7102844234575628 -0.7375172846804027 -2.579760910816792 1.336561572270101
0.2541996332132083 0.6186461729765909 0.7434106934499181 0.2194912986375709 0.711701808961156 -0.6673111005698995
-0.9419161938817396 0.3328024155303503 0.04512688689130734 -1.040123533893404 -0.1303773962721222 1.068029475621886
0.116348305340805 -0.9917998080681939 0.0528792261688552 -0.2760629007224059 0.01884966191381591 0.9609547154213178
-0.9540714578526358 -0.1264034452126562 -0.2716060057313114 -2.551899142554571 -2.986937398237611 1.317613923218308
"""


def opencv_poses(text: str) -> RigidTransform:
    """Rotations by rows, then places."""
    numbers = np.array(text.split(), float).reshape(-1, 12)
    return RigidTransform.from_components(numbers[:, 9:], Rotation.from_matrix(numbers[:, :9].reshape(-1, 3, 3)))


def tabb_poses() -> tuple[RigidTransform, RigidTransform]:
    """T_base_flange and T_cam_board [m] of 24 of the dataset's 88 poses."""
    lines = Path(__file__).with_name("tabb_dataset_1.txt").read_text().splitlines()
    rows = [line.split("|")[1:] for line in lines if not line.startswith("#")]
    B = np.array([b.split() for b, _ in rows], float).reshape(-1, 3, 4)
    A = np.array([a.split() for _, a in rows], float)
    hands = RigidTransform.from_components(1e-3 * B[:, :, 3], Rotation.from_matrix(B[:, :, :3]))
    boards = RigidTransform.from_components(1e-3 * A[:, 9:], Rotation.from_matrix(A[:, :9].reshape(-1, 3, 3)))
    return hands.inv(), boards


def flange_poses(n: int, spread_deg: float = 25.0, seed: int = 0) -> RigidTransform:
    """Above the board, turned about all axes."""
    rng = np.random.default_rng(seed)
    turns = Rotation.from_rotvec(np.radians(spread_deg) * rng.normal(size=(n, 3)))
    down = Rotation.from_euler("x", 180, degrees=True)
    return RigidTransform.from_components(np.array([0.4, 0, 0.5]) + 0.1 * rng.normal(size=(n, 3)), down * turns)


def seen(flanges: RigidTransform) -> RigidTransform:
    """T_cam_board without any error."""
    return (flanges * X).inv() * Y


def distance(a: RigidTransform, b: RigidTransform) -> float:
    """Largest difference of a matrix element [m, 1]."""
    return float(np.abs(a.as_matrix() - b.as_matrix()).max())


@pytest.mark.parametrize("n", [3, 4, 15])
def test_exact_poses_give_the_exact_answer(n: int):
    """Closed form and least squares alike, and no misfit."""
    flanges = flange_poses(n)
    found = hand_eye(flanges, seen(flanges), SQUARE)
    assert distance(found.T_flange_cam, X) < EXACT
    assert distance(found.T_flange_cam_closed, X) < EXACT
    assert distance(found.T_base_board, Y) < EXACT
    assert found.misfits.max() < 1e-6
    assert np.isnan(found.left_out).all() == (n == 3)
    assert not np.nanmax(found.left_out, initial=0.0) > 1e-6


def test_opencvs_own_regression():
    """Four poses of OpenCV's tests, for which it wants this result to 1e-12."""
    flanges, boards = opencv_poses(OPENCV_FLANGES), opencv_poses(OPENCV_BOARDS)
    truth = RigidTransform.from_matrix(OPENCV_TRUTH)
    found = closed_form(flanges, boards)
    sys.stdout.write(f"\nOpenCV regression_24871: closed form {distance(found, truth):.1e} from the truth\n")
    assert distance(found, truth) < EXACT


def test_the_closed_form_is_opencvs():
    """On real poses, which contradict each other: Park and Martin's answer to them as OpenCV computes it."""
    place, rotvec = OPENCV_PARK
    found = closed_form(*tabb_poses())
    assert np.allclose(found.translation, place, atol=1e-8)
    assert np.allclose(found.rotation.as_rotvec(), rotvec, atol=1e-8)


def test_a_published_calibration():
    """Tabb and Ahmad Yousef calibrated by reprojection of 88 poses. With 24 of them, whose flange turns by 32 and 16
    deg at most, 2 m from the board, the same camera is found to a few millimetres; the closed form alone is three times
    as far."""
    flanges, boards = tabb_poses()
    found = hand_eye(flanges, boards, CHESSBOARD)
    published = PUBLISHED_HAND.inv()
    apart, closed_apart = published.inv() * found.T_flange_cam, published.inv() * found.T_flange_cam_closed
    mm, closed_mm = (1e3 * np.linalg.norm(T.translation) for T in (apart, closed_apart))
    degrees = np.degrees(apart.rotation.magnitude())
    first, second = turns_deg(flanges)
    fit = f"misfit {rms(found.misfits)}, left out {rms(found.left_out)} (mm, deg)"
    turns = f"{len(flanges)} poses, turns of {first:.0f} and {second:.0f} deg"
    figures = f"{mm:.1f} mm and {degrees:.2f} deg from the published one, closed form {closed_mm:.1f} mm"
    sys.stdout.write(f"\nTabb dataset 1, {turns}: {figures}; {fit}\n")
    assert degrees < 0.15
    assert mm < 15.0
    assert mm < closed_mm / 2
    published_fit = board_misfits(published, found.T_base_board, flanges, boards)
    assert rms(found.misfits)[0] < rms(published_fit)[0]


def noisy(boards: RigidTransform, seed: int, noise_px: float = 0.3) -> RigidTransform:
    """The board's poses as OpenCV solves them from corners with noise, seen by a camera of 321 px."""
    rng = np.random.default_rng(seed)
    K = np.array([[321.0, 0, 319.5], [0, 321.0, 179.5], [0, 0, 1]])
    found = []
    for board in boards:
        cam = board.apply(CHESSBOARD)
        corners = 321.0 * cam[:, :2] / cam[:, 2:] + [319.5, 179.5] + rng.normal(0, noise_px, (len(cam), 2))
        _, rotvec, place = cv2.solvePnP(CHESSBOARD, corners, K, None, flags=cv2.SOLVEPNP_ITERATIVE)
        found.append(RigidTransform.from_components(place.ravel(), Rotation.from_rotvec(rotvec.ravel())))
    return RigidTransform.concatenate(found)


def test_least_squares_are_better_than_the_closed_form():
    """Over twenty calibrations of 15 poses whose corners are noisy: nearer to the truth in the middle."""
    errors, closed_errors = [], []
    flanges = flange_poses(15)
    for seed in range(20):
        boards = noisy(seen(flanges), seed)
        closed = closed_form(flanges, boards)
        found, _ = refined(closed, flanges[0] * closed * boards[0], flanges, boards, CHESSBOARD)
        errors.append(1e3 * np.linalg.norm((X.inv() * found).translation))
        closed_errors.append(1e3 * np.linalg.norm((X.inv() * closed).translation))
    sys.stdout.write(f"\n20 x 15 poses: {np.median(errors):.2f} mm, closed form {np.median(closed_errors):.2f} mm\n")
    assert np.median(errors) < np.median(closed_errors)


def test_left_out_poses_tell_more_than_the_fit():
    """What is foretold from the others misses by more than what was fitted, in every pose."""
    flanges = flange_poses(8)
    found = hand_eye(flanges, noisy(seen(flanges), 0), CHESSBOARD)
    assert rms(found.left_out)[0] > rms(found.misfits)[0] > 0
    assert not np.isnan(found.left_out).any()


def one_axis(n: int) -> RigidTransform:
    """Turned about the flange's z alone."""
    turns = Rotation.from_rotvec(np.radians(np.linspace(0, 90, n))[:, None] * [0.0, 0.0, 1.0])
    down = Rotation.from_euler("x", 180, degrees=True)
    return RigidTransform.from_components(np.random.default_rng(1).normal(size=(n, 3)), down * turns)


@pytest.mark.parametrize(
    ("flanges", "words"),
    [
        (flange_poses(2), "2 flange poses and 2 of the board; give at least 3 pairs, better 15"),
        (
            one_axis(8),
            r"turns about one axis only \(90.0 deg, across it 0.0\); add poses that are turned about another",
        ),
        (flange_poses(8, spread_deg=1.0), r"the flange turns by \d.\d deg at most, 10 are needed; add poses"),
        (flange_poses(8, spread_deg=0.0), r"the flange turns by 0.0 deg at most"),
    ],
)
def test_motions_that_determine_nothing_are_refused(flanges: RigidTransform, words: str):
    """Too few, about parallel axes, hardly turned, only shifted: one line with the mend, and no answer."""
    with pytest.raises(CalibrationError, match=words) as caught:
        hand_eye(flanges, seen(flanges), SQUARE)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("mistake", ["inverted", "shuffled", "moved", "one wrong", "unpaired"])
def test_poses_that_contradict_each_other_are_refused(mistake: str):
    """Poses the other way round, in another order, a board that was moved half-way, one wrong pose: no silent
    result."""
    flanges = flange_poses(12)
    boards = seen(flanges)
    if mistake == "inverted":
        boards = boards.inv()
    elif mistake == "shuffled":
        boards = boards[np.roll(np.arange(12), 1)]
    elif mistake == "moved":
        shift = RigidTransform.from_translation([0.1, 0.0, 0.0])
        boards = RigidTransform.concatenate([boards[:6], boards[6:] * shift])
    elif mistake == "one wrong":
        wrong = boards[4] * RigidTransform.from_components([0.3, 0, 0], Rotation.from_euler("y", 20, degrees=True))
        boards = RigidTransform.concatenate([boards[:4], wrong, boards[5:]])
    else:
        boards = boards[:-1]
    with pytest.raises(CalibrationError, match=r"contradict each other by .* mm|12 flange poses and 11") as caught:
        hand_eye(flanges, boards, SQUARE)
    if mistake == "one wrong":
        assert "without pose 4 (counted from 0) the others fit: take it out" in str(caught.value)
