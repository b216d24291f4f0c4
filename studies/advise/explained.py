"""Why surface stays without right depth: causes pixel by pixel, over the part and face by face."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import UInt8

from render.labels.causes import LEGEND, Cause
from render.labels.labels import label_frame
from render.labels.twin import measure_twin, twin_scene
from scenes.scene import Scene
from studies.advise.score_store import ScoredPose, ScoreStore
from studies.advise.scoring import NO_DEPTH, RIGHT_DEPTH, WRONG_DEPTH, MeasuredPart, measured_part
from studies.advise.setup import Setup
from studies.advise.stored_light import FACINGS
from studies.base.case_folder import case_digest
from studies.store.views import read_arrays, write_arrays

EXPLAINED = "explained"
"""Sub-folder of the causes."""
AFTERWARDS = "merge, filters or second look"
"""What loses surface that the plain frame has."""
LEAST_FACE = 0.01
"""Share of the part's surface below which a face is not listed (choice: a few pixels of a view)."""


@dataclass(frozen=True, eq=False)
class ExplainedView:
    """One setup from one pose."""

    infrared: UInt8[np.ndarray, "h w"]
    """Left image [DN]."""
    outcome: UInt8[np.ndarray, "h w"]
    """NO_DEPTH, RIGHT_DEPTH or WRONG_DEPTH on the part."""
    cause: UInt8[np.ndarray, "h w"]
    """`Cause` of the part's pixels without right depth, MEASURED elsewhere; UNMEASURED where `AFTERWARDS` lost it."""
    area: np.ndarray
    """Of the part's surface behind each pixel (h, w) [m^2]."""
    body: UInt8[np.ndarray, "h w"]
    facing: UInt8[np.ndarray, "h w"]


@dataclass(frozen=True)
class FaceRow:
    """One face of the part, over the explained views."""

    name: str
    surface: float
    """Share of the part's surface that was seen [0, 1]."""
    right_before: float
    """Share of the face with right depth as the camera is set [0, 1]."""
    right_after: float
    """As advised [0, 1]."""
    lost_to: str
    """What most of the rest is lost to, as advised; empty where nothing is."""


def explained_view(scores: ScoreStore, setup: Setup, index: int) -> ExplainedView:
    """Read, or found and written."""
    lights, seed = scores.lights, scores.seeds[0]
    named = ScoredPose(
        subject=lights.subject, pose=lights.poses[index], roll_deg=lights.roll_deg, seeds=(seed,), setup=setup
    )
    path = lights.out / EXPLAINED / f"{case_digest('advise causes 2', named)}.npz"
    if not path.exists():
        part = measured_part(lights, setup, index, seed)
        cause = with_outcome(_causes(scores, setup.first_look, index), part)
        seen = part.seen
        view = ExplainedView(part.infrared, part.outcome, cause, seen.area, seen.body, seen.facing)
        write_arrays(path, vars(view))
    return ExplainedView(**read_arrays(path))


def _causes(scores: ScoreStore, setup: Setup, index: int) -> UInt8[np.ndarray, "h w"]:
    """Labels of plain frames of this setup, without merge, filters and second look."""
    lights = scores.lights
    light, before = lights.light(setup.light, index), lights.camera(setup.light)
    camera, pose = before.set_to(setup.sensor, scores.seeds[0]), light.T_world_cam
    layers = light.layers
    twin = None
    if setup.lamp_level != 1:
        layers = (layers[0].with_ambient_scaled(setup.lamp_level), layers[1].with_ambient_scaled(setup.lamp_level))
        dimmed = camera.changed(scene=twin_scene(with_lamps_at(camera.scene, setup.lamp_level)))
        twin = measure_twin(camera, pose, setup.frames, before_twin=dimmed)
    measurement = camera.expose(pose, *layers, setup.frames)
    return label_frame(camera, pose, measurement, twin).picture


def with_lamps_at(scene: Scene, level: float) -> Scene:
    """The scene under its lamps at another strength; without them at 0."""
    lamps = tuple(replace(lamp, radiance=level * lamp.radiance) for lamp in scene.lamps) if level else ()
    return replace(scene, lamps=lamps, ambient_radiance=level * scene.ambient_radiance)


def with_outcome(labels: UInt8[np.ndarray, "h w"], part: MeasuredPart) -> UInt8[np.ndarray, "h w"]:
    """The labels where the part has no right depth: UNMEASURED where the plain frame has it."""
    lost = (part.seen.area > 0) & (part.outcome != RIGHT_DEPTH)
    known = np.where(labels == Cause.MEASURED, np.uint8(Cause.UNMEASURED), labels)
    return np.where(lost, known, np.uint8(Cause.MEASURED)).astype(np.uint8)


def cause_name(cause: int) -> str:
    """For people."""
    return AFTERWARDS if cause == Cause.UNMEASURED else LEGEND[Cause(cause)].name


def losses(views: Sequence[ExplainedView]) -> dict[str, float]:
    """Share of the part's surface that is lost to each cause [0, 1], the largest first."""
    whole = sum(float(view.area.sum(dtype=float)) for view in views)
    lost: dict[str, float] = {}
    for view in views:
        for cause in np.unique(view.cause[view.cause != Cause.MEASURED]).tolist():
            area = float(view.area[view.cause == cause].sum(dtype=float))
            lost[cause_name(cause)] = lost.get(cause_name(cause), 0.0) + area / whole
    return dict(sorted(lost.items(), key=lambda pair: -pair[1]))


def face_rows(
    before: Sequence[ExplainedView], after: Sequence[ExplainedView], body_names: Sequence[str]
) -> list[FaceRow]:
    """Faces by body and by where they look, the largest first."""
    whole = sum(float(view.area.sum(dtype=float)) for view in before)
    rows = []
    for body, name in enumerate(body_names):
        for facing, side in enumerate(FACINGS):
            surface, right_before = _face(before, body, facing)
            _, right_after = _face(after, body, facing)
            if surface >= LEAST_FACE * whole:
                lost = losses([_only(view, body, facing) for view in after if _on_face(view, body, facing).any()])
                worst = next(iter(lost), "")
                rows.append(FaceRow(f"{name}, {side}", surface / whole, right_before, right_after, worst))
    return sorted(rows, key=lambda row: -row.surface)


def _on_face(view: ExplainedView, body: int, facing: int) -> np.ndarray:
    return (view.area > 0) & (view.body == body) & (view.facing == facing)


def _only(view: ExplainedView, body: int, facing: int) -> ExplainedView:
    on = _on_face(view, body, facing)
    return replace(view, area=np.where(on, view.area, 0), cause=np.where(on, view.cause, np.uint8(Cause.MEASURED)))


def _face(views: Sequence[ExplainedView], body: int, facing: int) -> tuple[float, float]:
    """Surface [m^2], and the share of it with right depth."""
    surface = right = 0.0
    for view in views:
        on = _on_face(view, body, facing)
        surface += float(view.area[on].sum(dtype=float))
        right += float(view.area[on & (view.outcome == RIGHT_DEPTH)].sum(dtype=float))
    return surface, right / surface if surface else 0.0


OUTCOME_COLOURS = {NO_DEPTH: (38, 38, 42), RIGHT_DEPTH: (120, 190, 160), WRONG_DEPTH: (217, 95, 70)}
"""Red, green, blue of what becomes of a pixel, in pictures."""
