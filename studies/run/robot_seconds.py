"""What a stored run would take on a robot: planning, motion and exposure, and not the simulation of the camera."""

import numpy as np
from jaxtyping import Float

from studies.run.report.timing_figure import SENSING
from studies.run.stored_run import StoredRun

FRAME_S = 1.0 / 30.0
"""Time that a real camera takes for a frame [s]: the D435i's default depth rate of 30 Hz (data sheet). Instead of the
time that it takes to simulate one."""


def robot_seconds(stored: StoredRun) -> dict[str, Float[np.ndarray, "k"]]:
    """Seconds of each acquisition by what they are spent on.

    `planning`: processor time of choosing its pose, of the map with its burst and of what is found in it, on the
    machine that made the run; `motion`: modelled, of the arm to its pose; `exposure`: of its frames at FRAME_S.
    """
    times, rows = stored.timings["acquisitions"], stored.rows
    n_frames = stored.run["config"]["parameters"]["n_frames"]
    return {
        "planning": np.array([sum(s for stage, s in row.items() if stage != SENSING) for row in times]),
        "motion": np.array([row["motion_s"] for row in rows]),
        "exposure": np.full(len(rows), n_frames * FRAME_S),
    }
