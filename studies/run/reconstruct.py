"""A part reconstructed with the simulated camera and arm, from the first view to the last."""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from scipy.spatial.transform import RigidTransform

from franbv.adapters.recording.contents import CameraFacts
from franbv.adapters.view.sight import ViewSink
from franbv.parameters import Parameters
from franbv.sensing import DepthBurst
from materials.input_error import InputError
from render.arm.arm import SimulatedArm
from render.d435i import SimulatedD435i
from render.depth.coding import DepthFormat
from render.world.visibility import seen_from_above
from scenes.reference_points import part_box
from scenes.scene import Scene
from studies.run.bursts import KeptCaptures, Take
from studies.run.recording import recording_of
from studies.run.reference import reference_surface
from studies.run.run_case import RunSettings, ablated, write_run
from studies.run.scene_settings import Subject, SubjectSettings, mounted, resolved
from studies.run.shared_bursts import SharedCaptures

CLEARANCE_SHARE = 2 / 3
"""Of a voxel, that is table: the share of the default parameters, which removes the layer of the table top alone."""


class ReconstructSettings(RunSettings, SubjectSettings):
    """What decides a reconstruction: the subject and the run."""


def resolved_run(settings: ReconstructSettings) -> ReconstructSettings:
    """The settings that decide the result, as `resolved` and `ablated` give them, the planner's roll from the mount."""
    run = ablated(resolved(settings))
    return run.model_copy(update={"parameters": mounted(run.parameters, run.sensor)})


def simulate(
    folder: Path,
    config: ReconstructSettings,
    subject: Subject,
    watched: bool = True,
    shared: SharedCaptures | None = None,
    record: Path | None = None,
    view: ViewSink | None = None,
) -> None:
    """Run the loop with the simulated camera and arm; `watched` as in `write_run`, `shared` as in `KeptCaptures`.

    record: file to record the run in; view: what shows it while it lasts.
    """
    camera = SimulatedD435i(subject.scene, config.sensor, config.seed)
    captures = KeptCaptures(take_with(camera), camera.intrinsics, camera.min_z, folder, shared)
    reference = reference_surface(subject.scene, lambda points, normals: seen_from_above(camera.world, points, normals))
    arm = SimulatedArm.around(
        subject.scene.part_mesh(),
        model=config.sensor.model,
        roll_deg=config.sensor.mount_roll_deg,
        fixtures=subject.scene.fixtures,
    )
    facts = CameraFacts(captures.intrinsics, captures.min_z, camera.settings.depth.unit, config.sensor.model)
    with recording_of(record, config, subject.title, facts, folder, config.sensor.model_dump(mode="json")) as watch:
        write_run(folder, config, subject.title, captures, arm, reference, watched, watch, view)


def take_with(camera: SimulatedD435i) -> Take:
    """The camera as `studies.run.bursts.Take`; the infrared image is cut to what the depth image covers."""
    covered = camera.window.slices if camera.window else np.s_[:, :]

    def take(T_world_cam: RigidTransform, n_frames: int) -> tuple[DepthBurst, UInt8[np.ndarray, "h w"]]:
        measurement = camera.measure(T_world_cam, n_frames)
        return measurement.burst, measurement.lefts[0][covered]

    return take


def check_workspace(scene: Scene, parameters: Parameters) -> tuple[str, ...]:
    """InputError when the part does not fit into the box that the planner maps, or no depth can tell it from the table.

    Returns a notice when it is so flat that the map counts it as table.
    """
    low, high = part_box(scene)
    if np.any(low[:2] < parameters.workspace_min[:2]) or np.any(high > parameters.workspace_max):
        size = _millimetres(high - low)
        room = _millimetres(np.subtract(parameters.workspace_max, parameters.workspace_min))
        raise InputError(
            f"{scene.name}: {size} mm do not fit into the mapped box of {room} mm around the origin; "
            "raise --parameters.workspace-min and --parameters.workspace-max"
        )
    height = float(high[2]) - parameters.table_height
    step = DepthFormat().unit
    if height < step:
        raise InputError(
            f"{scene.name}: it is {1000 * height:.3g} mm tall on the table, less than one step of the camera's depth "
            f"({1000 * step:g} mm), so no view can tell it from the table; stand it up with --up, or take a taller part"
        )
    return _too_flat(scene.name, height, parameters)


def _too_flat(name: str, height: float, parameters: Parameters) -> tuple[str, ...]:
    """A notice when the part ends below the lowest voxels that count as object: those above the table's clearance.

    The advice puts the part's top into the middle of the lowest of them: voxels as large as it is tall.
    """
    size, clearance = parameters.voxel_size, parameters.table_clearance
    lowest = (np.floor((parameters.table_height + clearance) / size) + 1) * size - parameters.table_height
    if height >= lowest - size / 2:
        return ()
    return (
        f"{name}: it is {1000 * height:.3g} mm tall, and the map takes all below {1000 * (lowest - size / 2):.3g} mm "
        f"for table (voxels of {1000 * size:.3g} mm, table clearance {1000 * clearance:.3g} mm), so coverage will be "
        f"low whatever the material; set --parameters.voxel-size {height:.2g} "
        f"--parameters.table-clearance {height * CLEARANCE_SHARE:.2g}, which takes longer",
    )


def _millimetres(sides: np.ndarray) -> str:
    return " x ".join(f"{1000 * side:.0f}" for side in sides)
