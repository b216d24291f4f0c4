"""A camera pose written on the command line, and whether a camera can be there at all."""

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from franbv.candidates import first_view
from franbv.frames import look_at, rolled
from franbv.parameters import Parameters
from materials.input_error import InputError
from render.arm.solid import Solid
from scenes.reference_points import part_box
from scenes.scene import Scene

HOW = "write azimuth,elevation,distance in deg,deg,m, or eye:x,y,z in m"


def camera_pose(text: str | None, scene: Scene, roll_deg: float = 0.0) -> RigidTransform:
    """The pose T_world_cam that `text` spells; None is the planner's first view.

    `azimuth,elevation,distance` counts from the middle of the part's bounding box, azimuth from world x towards y.
    `eye:x,y,z` is the position. Either way the camera looks at that middle, turned by its roll. InputError for a pose
    under the table, inside a part body or inside what stands around it.
    """
    if text is None:
        pose = first_view(Parameters(roll_deg=roll_deg), 0.0)
    else:
        middle = part_box(scene).mean(axis=0)
        eye = _eye(text, middle)
        if np.linalg.norm(eye - middle) < 1e-6:
            raise InputError(f"--pose {text}: the camera stands where it should look; give a distance")
        pose = rolled(look_at(eye, middle), roll_deg)
    check_free(f"--pose {text or 'first view'}", pose.translation, scene)
    return pose


def _eye(text: str, middle: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    is_position = text.startswith("eye:")
    try:
        a, b, c = (float(word) for word in text.removeprefix("eye:").split(","))
    except ValueError:
        raise InputError(f"--pose {text}: not three numbers; {HOW}") from None
    if not np.isfinite([a, b, c]).all():
        raise InputError(f"--pose {text}: not finite; {HOW}")
    if is_position:
        return np.array([a, b, c])
    if c <= 0:
        raise InputError(f"--pose {text}: the distance {c:g} m is not positive; {HOW}")
    if abs(b) > 90:
        raise InputError(f"--pose {text}: the elevation {b:g} deg is beyond straight up or down; {HOW}")
    azimuth, elevation = np.radians([a, b])
    level = np.cos(elevation)
    return middle + c * np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)])


def check_free(pose: str, eye: Float[np.ndarray, "3"], scene: Scene) -> None:
    """InputError where no camera can be: under the table, inside the part or what stands around it, outside the room.

    pose: how the message names it.
    """
    where = f"{pose}: the camera at ({', '.join(f'{x:.3f}' for x in eye)}) m"
    if eye[2] <= 0:
        raise InputError(f"{where} is under the table (z = 0); raise it")
    for body in scene.part_bodies:
        if Solid.from_mesh(body.mesh).winding_number(eye) > 0.5:
            raise InputError(f"{where} is inside the part (body {body.name}); move it out")
    for body in scene.fixtures:
        if Solid.from_mesh(body.mesh).winding_number(eye) > 0.5:
            raise InputError(f"{where} is inside the {body.name}; move it out")
    for walls in (body.mesh.vertices for body in scene.bodies if body.name == "walls"):
        if np.any(eye < walls.min(axis=0)) or np.any(eye > walls.max(axis=0)):
            raise InputError(f"{where} is outside the room; move it nearer to the part")
