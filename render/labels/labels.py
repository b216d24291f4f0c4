"""Labels by intervention: why each pixel has no depth, and which depths are false.

One thing is changed at a time and the same pose measured again, to see whether the pixel comes back. In this order:
what geometry forbids (range, overlap, hidden from the right imager); the projector's shadows; an exposure that drowns
it; what the matcher's window cannot hold, where the matte twin is not right either; the matte twin; dots as strong as
near by. Interventions are made only where they can still decide.

A hole is reflection's only where the twin has *right* depth: a false one is no better than none, and says that no
material would have helped. Such a hole goes the way of one that the twin has as well: beside an edge or on a steep
surface it is the window's, elsewhere out of the dots' reach if strong dots mend it, and otherwise unexplained.

Shadows are lifted from the matte twin: where it is not right and is matched rightly when dots reach it, no material
would have helped. Where it is right in the same shadow, dots were not what was missing. Likewise the twin is exposed
anew where it is not right and white.

The twin convicts a material only where a surface that is not matte lies within the matcher's window, or an
over-exposure drowns the pixel: anywhere else it is the same surface, and whether it comes back in a new measurement of
nearly the same images is chance.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, UInt8
from scipy.spatial.transform import RigidTransform

from render.d435i import Measurement, SimulatedD435i
from render.labels.causes import GROUPS, HOLES, Cause, members
from render.labels.geometric import geometry, near
from render.labels.infrared import WHITE_SHARE, reflection_kinds, true_partners, white_share
from render.labels.interventions import matched_at_first_surface, matched_with_strong_dots
from render.labels.outcome import blocks, burst_outcome
from render.labels.twin import MatteTwin, in_window, measure_twin
from render.world.bsdf import is_diffuse
from render.world.scene_geometry import NO_BODY
from render.world.surface import SurfaceMap
from render.world.truth import Truth


@dataclass(frozen=True, eq=False)
class Labels:
    """Of one burst: at full resolution, and decimated and cropped as the planner gets it.

    A decimated pixel is invalid or false by its own depth: `false_decimated` and `false_by_reflection_decimated` say of
    it what the maps before say of a pixel, and `cause_decimated` is the cause that most of its block share. A cause is
    what was found by changing one thing at a time (head of the module); where several would do, the first one counts.
    """

    cause: UInt8[np.ndarray, "h w"]
    """`Cause` of every invalid pixel; MEASURED where there is depth, UNMEASURED outside the crop."""
    false_depth: Bool[np.ndarray, "h w"]
    """Has depth, and that is false."""
    false_by_reflection: Bool[np.ndarray, "h w"]
    """Those whose depth is right on the matte twin."""
    cause_decimated: UInt8[np.ndarray, "h_d w_d"]
    false_decimated: Bool[np.ndarray, "h_d w_d"]
    false_by_reflection_decimated: Bool[np.ndarray, "h_d w_d"]

    @property
    def picture(self) -> UInt8[np.ndarray, "h w"]:
        """Holes and false depth in one map of `Cause` codes."""
        return _with_false_depth(self.cause, self.false_depth, self.false_by_reflection)

    @property
    def picture_decimated(self) -> UInt8[np.ndarray, "h_d w_d"]:
        """The same after decimation."""
        return _with_false_depth(self.cause_decimated, self.false_decimated, self.false_by_reflection_decimated)


def label_frame(
    camera: SimulatedD435i,
    T_world_cam: RigidTransform,
    measurement: Measurement,
    twin: MatteTwin | None = None,
    truth: Truth | None = None,
) -> Labels:
    """Label a burst that `camera` measured from `T_world_cam`, before the same scene, from layers that it rendered.

    twin: of the same geometry, lights, camera settings, pose and number of frames; measured here if it is not given.
    truth: from the same pose, if it is known already.
    """
    truth = truth or camera.truth(T_world_cam)
    twin = twin or measure_twin(camera, T_world_cam, len(measurement.z16), truth)
    if twin.n_frames != len(measurement.z16):
        raise ValueError(f"twin of {twin.n_frames} frames, burst of {len(measurement.z16)}; measure both alike")
    right = camera.view(T_world_cam).right.surface
    touched = _touched(camera, measurement, truth, right)
    outcome, window = burst_outcome(camera, measurement, truth), in_window(camera)
    cause = _causes(camera, measurement, truth, right, twin, outcome.invalid & window, touched)
    return Labels(
        np.where(window, cause, np.uint8(Cause.UNMEASURED)),
        outcome.is_false & window,
        outcome.is_false & window & twin.outcome.right & touched,
        np.where(outcome.invalid_decimated, most_frequent_cause(blocks(cause, camera)), np.uint8(Cause.MEASURED)),
        outcome.false_decimated,
        outcome.false_decimated & twin.outcome.right_decimated & blocks(touched, camera).any(axis=-1),
    )


def _causes(
    camera: SimulatedD435i,
    measurement: Measurement,
    truth: Truth,
    right: SurfaceMap,
    twin: MatteTwin,
    invalid: Bool[np.ndarray, "h w"],
    touched: Bool[np.ndarray, "h w"],
) -> UInt8[np.ndarray, "h w"]:
    """Cause of every invalid pixel, MEASURED elsewhere. A pixel that is settled stays so."""
    places = geometry(camera, truth)
    cause = np.where(invalid, places.impossible, np.uint8(Cause.MEASURED))

    def settle(pixels: Bool[np.ndarray, "h w"], as_cause: UInt8[np.ndarray, "h w"] | Cause) -> None:
        np.copyto(cause, np.uint8(as_cause), where=pixels & (cause == Cause.MEASURED))

    settle(invalid & twin.lost_to_shadow, Cause.PROJECTOR_SHADOW)
    settle(invalid & twin.lost_to_exposure, Cause.OVER_EXPOSED)
    reflects = invalid & twin.outcome.right & touched & (cause == Cause.MEASURED)
    settle(invalid & ~reflects, places.window)
    settle(invalid & ~reflects & places.near_dark, Cause.OUT_OF_REACH)
    undecided = invalid & ~reflects & (cause == Cause.MEASURED)
    if undecided.any():
        settle(matched_with_strong_dots(camera, measurement, truth, right, undecided), Cause.OUT_OF_REACH)
        settle(undecided, Cause.UNEXPLAINED)
    if reflects.any():
        settle(matched_at_first_surface(camera, measurement, truth, reflects), Cause.REFLECTION_INTERREFLECTION)
        settle(reflects, reflection_kinds(measurement, truth, camera.rig, reflects))
    return cause


def _touched(
    camera: SimulatedD435i, measurement: Measurement, truth: Truth, right: SurfaceMap
) -> Bool[np.ndarray, "h w"]:
    """Pixels whose match a reflecting surface can have spoilt.

    It lies in the matcher's window on the left, or in that around the true partner on the right; or the pixel drowns in
    an exposure that was set for an image with reflections in it.
    """
    glossy = np.zeros(NO_BODY + 1, bool)
    glossy[: len(camera.world.source.bodies)] = [not is_diffuse(b.material) for b in camera.world.source.bodies]
    drowned = white_share(measurement.lefts.mean(axis=0, dtype=np.float32)) >= WHITE_SHARE
    touched = near(glossy[truth.body]) | drowned
    rest = np.argwhere(~touched & (truth.depth > 0))
    partners = np.rint(true_partners(truth.depth, camera.rig, rest)).astype(int)
    touched[tuple(rest.T)] = near(glossy[right.body])[rest[:, 0], partners]
    return touched


def most_frequent_cause(causes: UInt8[np.ndarray, "h w n"]) -> UInt8[np.ndarray, "h w"]:
    """Cause that most of a block's pixels share, sub-kinds counted together, then the most frequent sub-kind of it.

    Among equals the earlier in the order of the causes. MEASURED where no pixel of the block is invalid.
    """
    votes = {cause: np.count_nonzero(causes == cause, axis=-1) for cause in HOLES}
    groups = [np.sum([votes[cause] for cause in members(group)], axis=0) for group in GROUPS]
    group = np.argmax(groups, axis=0)
    winner = np.zeros(group.shape, np.uint8)
    for index, name in enumerate(GROUPS):
        kinds = np.array(members(name), np.uint8)
        best = kinds[np.argmax([votes[cause] for cause in members(name)], axis=0)]
        winner = np.where(group == index, best, winner)
    return np.where(np.max(groups, axis=0) > 0, winner, np.uint8(Cause.MEASURED))


def _with_false_depth(
    cause: UInt8[np.ndarray, "h w"], is_false: Bool[np.ndarray, "h w"], by_reflection: Bool[np.ndarray, "h w"]
) -> UInt8[np.ndarray, "h w"]:
    """A cause map with false depth in it."""
    kinds = [Cause.FALSE_DEPTH_REFLECTION, Cause.FALSE_DEPTH_OTHER]
    return np.select([by_reflection, is_false], kinds, cause).astype(np.uint8)
