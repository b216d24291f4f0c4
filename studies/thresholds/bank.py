"""The bank of views: each drawn once, rendered once, labelled once, and kept with all that scoring it anew needs.

`bank/<name>/views/000123.npz` holds the burst and the truth of view 123 of a domain; the name is the domain's, its
camera included, so that another domain begins a bank of its own and other risks or settings use the one that is there.
View 123 of banks that differ by the camera alone is the same draw. Views of the same draws
under a mismatch (`studies.thresholds.stress`) stand in a folder beside `views` that has the mismatch's name.
"""

import json
from dataclasses import dataclass, fields
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float
from pydantic import Field
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from franbv.sensing import DepthBurst, median_depth
from render.d435i import SensorSettings, SimulatedD435i
from render.labels.causes import is_of
from render.labels.labels import label_frame
from render.labels.outcome import INVALID_SHARE, blocks, is_false_depth, perfect_blocks
from render.light.sampling import Sampling
from render.world.mitsuba_scene import LoadedScene
from render.world.truth import looks_at_part
from scenes.scene import Scene
from studies.base.case_folder import case_digest
from studies.base.config import Config
from studies.run.scene_settings import SubjectSettings, build_subject, resolved
from studies.sensitivity.cases import loaded_scene
from studies.store.views import camera_vector, read_arrays, write_arrays
from studies.thresholds.config import Domain
from studies.thresholds.draw import DomainView, subject_settings, view_draw, view_pose
from studies.thresholds.stress import stress_of

BANK, BANKED_VIEWS = "bank", "views"
"""Folders of the banks in a study's, and of the views in a bank's."""
BANK_NAME = "thresholds bank 1"
"""What the hash of a bank calls it; the number rises when a view comes to hold something else."""
SAMPLING = Sampling(glossy_paths=16, refined_share=0.0, indirect_directions=64)
"""Choice: that of datasets, whose pictures differ from the sensor's own by less than its noise."""

STRETCH = 120
"""Views that are sorted by scene before the next ones are begun (choice)."""


class BankSettings(Config):
    """All that decides a bank, but how many views it has."""

    domain: Domain
    seed: int
    n_frames: int
    """Frames of each burst; scoring may use fewer."""
    digests: dict[str, str] = Field(default={})
    """Hashes of the files that the domain names."""

    @property
    def name(self) -> str:
        """Of the bank's folder."""
        return case_digest(BANK_NAME, self)


@dataclass(frozen=True, eq=False)
class BankedView:
    """One view of the bank, as the planner gets it, and the truth of each of its pixels."""

    depths: Float[np.ndarray, "n h w"]
    """[m], 0 = invalid."""
    camera: Float[np.ndarray, "6"]
    """width, height, fx, fy, cx, cy of `depths` [px]."""
    T_world_cam: Float[np.ndarray, "4 4"]
    part: Bool[np.ndarray, "h w"]
    """More than half of the block shows the part."""
    reflective: Bool[np.ndarray, "h w"]
    """Has no depth because of reflection."""
    expected: Float[np.ndarray, "h w"]
    """True depth of the block [m], decimated as the measured one was; 0 = none."""
    focal_baseline: Float[np.ndarray, ""]
    """f B of the full resolution [px m]."""

    def burst(self, n_frames: int) -> DepthBurst:
        """The first frames of the burst."""
        width, height, fx, fy, cx, cy = (float(value) for value in self.camera)
        lens = Intrinsics(int(width), int(height), fx, fy, cx, cy)
        return DepthBurst(self.depths[:n_frames], lens, RigidTransform.from_matrix(self.T_world_cam))

    def is_false(self, depth: Float[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
        """Which depths [m] are wrong by more than noise, by the rule of the labels."""
        return is_false_depth(depth.astype(np.float32), self.expected.astype(np.float32), float(self.focal_baseline))


@dataclass(frozen=True)
class ViewTask:
    """A view to be drawn into a bank."""

    folder: Path
    """Of the bank."""
    settings: BankSettings
    number: int
    stress: str = ""
    """Name of a mismatch; empty = none."""

    @property
    def title(self) -> str:
        """For people, short enough for a progress display."""
        return f"view {self.number}" + (f", {self.stress}" if self.stress else "")

    @property
    def file(self) -> Path:
        """Of the view."""
        return view_file(self.folder, self.number, self.stress)


def bank_folder(out: Path, settings: BankSettings) -> Path:
    """Where a study keeps this bank."""
    return out / BANK / settings.name


def view_file(folder: Path, number: int, stress: str = "") -> Path:
    """Of one view in a bank."""
    return folder / (stress or BANKED_VIEWS) / f"{number:06d}.npz"


def do_view(task: ViewTask) -> bool:
    """For a worker: draw, render, label and keep the view, unless it is there; False where the mismatch changes nothing
    of what was drawn, so that there is no such view."""
    if task.file.exists():
        return True
    domain, stress = task.settings.domain, stress_of(task.stress)
    draw = view_draw(domain, task.settings.seed, task.number)
    alike = {"seed": 0, "sensor": SensorSettings()}  # no scene hangs on them
    scene = _scene(subject_settings(domain, draw).model_copy(update=alike).model_dump_json())
    if not stress.applies(scene):
        return False
    sensor, known = stress.sensor(domain.sensor), loaded_scene(scene)
    view = banked_view(draw, stress.scene(scene), sensor, task.settings.n_frames, known)
    facts = np.frombuffer(json.dumps(draw.model_dump(mode="json")).encode(), np.uint8)
    task.file.parent.mkdir(parents=True, exist_ok=True)
    write_arrays(
        task.file, {field.name: np.asarray(getattr(view, field.name)) for field in fields(view)} | {"draw": facts}
    )
    return True


@lru_cache(1)
def _scene(subject: str) -> Scene:
    """Of the subject that a worker looked at last; `drawn_alike` puts its views one after the other."""
    return build_subject(SubjectSettings.model_validate_json(subject)).scene


def banked_view(
    draw: DomainView, scene: Scene, sensor: SensorSettings, n_frames: int, known: LoadedScene | None = None
) -> BankedView:
    """Render and label one view of a scene. known: a loaded scene whose geometry it may share."""
    camera = SimulatedD435i(scene, sensor, draw.seed, SAMPLING, known=known)
    pose = view_pose(draw, scene, sensor.mount_roll_deg)
    truth = camera.truth(pose)
    measurement = camera.expose(pose, *camera.render(pose), n_frames)
    labels = label_frame(camera, pose, measurement, truth=truth)
    return BankedView(
        measurement.burst.depths,
        camera_vector(measurement.burst.intrinsics),
        pose.as_matrix(),
        blocks(looks_at_part(truth, scene), camera).mean(axis=-1) > 0.5,
        is_of(labels.cause_decimated, "reflection"),
        median_depth(perfect_blocks(camera, measurement.z16, truth.depth), INVALID_SHARE),
        np.array(camera.rig.focal_baseline),
    )


def drawn_alike(task: ViewTask) -> tuple[object, ...]:
    """To sort views by: those of one scene one after the other within a stretch, so that what its surfaces see of one
    another is found once (a third of the time); what was drawn of an unfinished bank still is a fair sample."""
    draw = view_draw(task.settings.domain, task.settings.seed, task.number)
    return task.number // STRETCH, task.stress == "lamp_moved", draw.part, draw.lamps, draw.material, task.number


def read_banked_view(task: ViewTask) -> tuple[DomainView, BankedView]:
    """One view of a bank, and what was drawn for it."""
    arrays = read_arrays(task.file)
    draw = DomainView(**json.loads(arrays.pop("draw").tobytes()))
    return draw, BankedView(**arrays)


def bank_settings(domain: Domain, seed: int, n_frames: int) -> BankSettings:
    """The bank of a domain; InputError where a file that it names cannot be read."""
    files: dict[str, str] = {}
    for name in domain.parts:
        subject = subject_settings(domain, replace_part(view_draw(domain, seed, 0), name))
        files |= {f"{name} {key}": digest for key, digest in resolved(subject).digests.items()}
    return BankSettings(domain=domain, seed=seed, n_frames=n_frames, digests=files)


def with_sensor(settings: BankSettings, sensor: SensorSettings) -> BankSettings:
    """The bank of the same draws before another camera."""
    return settings.model_copy(update={"domain": settings.domain.model_copy(update={"sensor": sensor})})


def replace_part(draw: DomainView, part: str) -> DomainView:
    """The same view of another part."""
    return draw.model_copy(update={"part": part})
