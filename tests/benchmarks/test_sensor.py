"""Time of one full sensor burst at 640x360, whole and by stage, of matching, and of the reconstruction of part D."""

import json
import resource
import subprocess
import sys
from pathlib import Path

import cv2
import pytest

from franbv.candidates import first_view
from franbv.parameters import Parameters
from render.d435i import SimulatedD435i
from render.matcher.d4.matcher import D4Matcher
from scenes.build import part_scene
from tests.benchmarks.stopwatch import Stopwatch

pytestmark = pytest.mark.benchmark

N_FRAMES = 15
"""N_k of the paper."""


@pytest.fixture(scope="module")
def camera() -> SimulatedD435i:
    """Before part D1, the part with most metal."""
    return SimulatedD435i(part_scene("D1"))


def test_burst(camera: SimulatedD435i, stopwatch: Stopwatch):
    """Both layers of both imagers, 15 noisy pairs, matched, decimated."""
    pose = first_view(Parameters(), 0.0)
    layers = camera.render(pose)
    stopwatch.time("sensor burst, part D1, 15 frames", lambda: camera.measure(pose, N_FRAMES), goal=1.0)
    stopwatch.time("  of which both layers of both imagers", lambda: camera.render(pose))
    stopwatch.time("  of which exposure, matching, decimation", lambda: camera.expose(pose, *layers, N_FRAMES))
    stopwatch.time("truth maps", lambda: camera.truth(pose))


def test_matcher(camera: SimulatedD435i, stopwatch: Stopwatch):
    """One pair on one core, the D4-like matcher beside OpenCV's StereoSGBM with 3 and with all 8 paths.

    Ratios are of processor times: those of one run on one machine compare, whatever else it does.
    """
    pair = camera.measure(first_view(Parameters(), 0.0), 1)
    left, right = pair.lefts[0], pair.rights[0]
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        d4 = stopwatch.time("one pair, D4-like matcher", lambda: D4Matcher().match(left, right), n=9, goal=0.05)
        for name, mode in (("3-way", cv2.STEREO_SGBM_MODE_SGBM_3WAY), ("8-path", cv2.STEREO_SGBM_MODE_HH)):
            sgbm = cv2.StereoSGBM.create(numDisparities=128, blockSize=5, P1=200, P2=800, mode=mode)
            other = stopwatch.time(f"  the same, StereoSGBM {name}", lambda sgbm=sgbm: sgbm.compute(left, right), n=9)
            ratio = min(d4.cpu_seconds) / min(other.cpu_seconds)
            stopwatch.note(f"D4-like matcher over StereoSGBM {name}: {ratio:.2f} (processor time, least of 9)")
    finally:
        cv2.setNumThreads(threads)


def test_reconstruction_of_part_d(stopwatch: Stopwatch, tmp_path):
    """The whole of `franbv reconstruct --part D --planner fra`, start of the program included."""
    command = [
        str(Path(sys.executable).with_name("franbv")),
        "reconstruct",
        "--part",
        "D",
        "--planner",
        "fra",
        "--json",
    ]
    results = []

    def run() -> None:
        out = tmp_path / str(len(results))
        done = subprocess.run([*command, "--out", str(out)], capture_output=True, text=True, check=True)
        results.append(json.loads(done.stdout.splitlines()[-1]))

    stopwatch.time("reconstruct part D with FRA, from the command line", run, n=1, goal=90.0, warm_up=0)
    result = results[0]
    stopwatch.note(
        f"that run: {result['acquisitions']} acquisitions, coverage {result['coverage_5mm']:.3f}, medians of planning "
        f"{result['planning_s_median']:.3f} s and sensing {result['sensing_s_median']:.3f} s"
    )
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    stopwatch.note(f"peak memory of that run: {peak:.0f} MiB")
