"""Where the camera stands: poses spread around the part, and what remedies make of each."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.frames import look_at, rolled
from franbv.parameters import Parameters
from materials.input_error import InputError
from scenes.reference_points import part_box, part_half_diagonal
from scenes.scene import Scene
from studies.advise.settings import AdviseSettings
from studies.advise.setup import Stand
from studies.base.pose_text import camera_pose
from studies.safe_angles.views import POLAR_STEP
from studies.sensitivity.cases import azimuth_deg

ELEVATIONS_DEG = (20.0, 65.0)
"""Range of the poses' elevations [deg] (choice: from where a camera looks at upright faces to where it looks at tops;
the planner's candidates lie between 10 and 70)."""
TRIES_A_POSE = 20
"""Poses tried for each that is wanted, before what stands around the part is said to leave none (choice)."""


def pose_texts(settings: AdviseSettings, scene: Scene) -> tuple[str, ...]:
    """The poses as the command line spells them; InputError for one that a camera cannot take.

    Those of fewer poses are the first ones of more; what stands in the way of one is passed over. An inside corner is
    looked into from its open side, as in the sensitivity study.
    """
    roll = settings.sensor.mount_roll_deg
    if settings.pose:
        for text in settings.pose:
            camera_pose(text, scene, roll)
        return settings.pose
    distance = settings.distance or round(Parameters().stand_off + part_half_diagonal(scene), 3)
    low, high = ELEVATIONS_DEG
    found: list[str] = []
    for number in range(settings.seed, settings.seed + TRIES_A_POSE * settings.poses):
        elevation = low + (high - low) * ((0.5 + number * POLAR_STEP) % 1)
        text = f"{azimuth_deg(settings.part or '', number):.2f},{elevation:.2f},{distance:g}"
        try:
            camera_pose(text, scene, roll)
        except InputError:
            continue
        found.append(text)
        if len(found) == settings.poses:
            return tuple(found)
    raise InputError(
        f"--poses {settings.poses}: {len(found)} are free at {distance:g} m from the part; give --distance or fewer"
    )


def stood(text: str, scene: Scene, roll_deg: float, stand: Stand) -> RigidTransform:
    """T_world_cam of a pose, taken up by a stand. scene: as it is without remedies, so that all see the same place."""
    pose = camera_pose(text, scene, roll_deg)
    if stand == Stand():
        return pose
    middle = part_box(scene).mean(axis=0)
    turn = Rotation.from_euler("z", stand.azimuth_deg, degrees=True)
    eye = middle + stand.distance * turn.apply(pose.translation - middle)
    return rolled(look_at(np.asarray(eye), middle), roll_deg + stand.roll_deg)
