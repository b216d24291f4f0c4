"""The matte twin: the same pose, meshes and lights with every surface diffuse, measured by the same camera.

The twin keeps the camera's *behaviour*, not the real frame's exposure: where the camera chooses its exposure it does so
for the twin too. An exposure long enough for dark metal would drown the twin, and its holes would acquit the metal; and
only so does the twin depend on nothing but geometry, lights and camera, so that one serves every material. All other
interventions hold the exposure of the frame that they are compared with.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool
from scipy.spatial.transform import RigidTransform

from materials.catalog import matte_twin
from render.d435i import SimulatedD435i
from render.labels.causes import Cause
from render.labels.geometric import geometry
from render.labels.infrared import is_white
from render.labels.interventions import matched_when_exposed_for, matched_without_shadows
from render.labels.outcome import Outcome, burst_outcome, is_matched_rightly
from render.world.truth import Truth
from scenes.scene import Scene


@dataclass(frozen=True, eq=False)
class MatteTwin:
    """What the camera sees of the twin from one pose; any material of the same geometry may share it.

    Every surface that is not matte reflects diffusely with `materials.catalog.TWIN_REFLECTANCE`; the noise has the same
    seed, and the exposure is chosen anew where the camera chooses it.
    """

    outcome: Outcome
    lost_to_shadow: Bool[np.ndarray, "h w"]
    """Invalid or matched wrongly, and matched rightly once the projector's shadows are lifted."""
    lost_to_exposure: Bool[np.ndarray, "h w"]
    """White, invalid or matched wrongly, and matched rightly at a shorter exposure."""
    n_frames: int
    """Length of the burst: the noise of a shorter one would differ at the margin."""


def twin_scene(scene: Scene) -> Scene:
    """The scene with every material replaced by its matte twin; matte ones stay as they are."""
    return scene.with_materials(lambda body: matte_twin(body.material))


def twin_camera(camera: SimulatedD435i) -> SimulatedD435i:
    """The same camera before the matte twin of its scene."""
    return camera.changed(scene=twin_scene(camera.scene))


def measure_twin(
    camera: SimulatedD435i,
    T_world_cam: RigidTransform,
    n_frames: int,
    truth: Truth | None = None,
    before_twin: SimulatedD435i | None = None,
) -> MatteTwin:
    """Measure the twin of the camera's scene.

    truth: from the same pose, if it is known already. before_twin: `twin_camera(camera)`, loaded once for many poses.

    What was lost or matched wrongly near a shadow is measured again without shadows, and what was in white at a shorter
    exposure.
    """
    truth = truth or camera.truth(T_world_cam)
    twin = before_twin or twin_camera(camera)
    measurement = twin.measure(T_world_cam, n_frames)
    outcome = burst_outcome(twin, measurement, truth)
    places = geometry(camera, truth)
    lost = ~outcome.right & in_window(camera) & (places.impossible == Cause.MEASURED)
    lost &= ~is_matched_rightly(twin, measurement, truth)  # what comes back must have been away
    in_shadow = lost & places.near_shadow
    if in_shadow.any():
        in_shadow &= matched_without_shadows(twin, measurement, truth)
    white = lost & is_white(measurement, truth, camera.rig)
    if white.any():
        white &= matched_when_exposed_for(twin, measurement, truth, white)
    return MatteTwin(outcome, in_shadow, white, n_frames)


def in_window(camera: SimulatedD435i) -> Bool[np.ndarray, "h w"]:
    """Full-resolution pixels that the camera's matcher is asked for."""
    inside = np.zeros((camera.rig.intrinsics.height, camera.rig.intrinsics.width), bool)
    inside[camera.window.slices if camera.window else ...] = True
    return inside
