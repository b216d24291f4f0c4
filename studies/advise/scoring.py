"""What a setup measures of the part's surface from one pose: right depth, false depth or none, by area."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Int, UInt8, UInt16

from franbv.frames import project
from franbv.sensing import median_depth
from render.d435i import SimulatedD435i
from render.depth.coding import metres_from_z16
from render.depth.decimation import decimate, padded
from render.depth.filters.chain import FilterChain
from render.depth.filters.hdr_merge import HdrFrame, hdr_merged
from render.depth.filters.temporal import HISTORY
from render.labels.outcome import INVALID_SHARE, is_false_depth
from studies.advise.setup import Setup
from studies.advise.stored_light import LightStore, PoseLight, SeenPart

NO_DEPTH, RIGHT_DEPTH, WRONG_DEPTH = 0, 1, 2
"""What becomes of a pixel of the part."""
AROUND_PX = 64
"""Around the part's pixels that is measured with them [px] (choice: farther than hole filling of 16 px, a filter's
reach and a block of eight see)."""
SEEN_TOLERANCE = 0.003
"""Up to which a second look's truth at a point's pixel is the point's [m] (choice: a pixel's slope at half a metre)."""


@dataclass(frozen=True)
class SurfaceCount:
    """Of one pose and one draw of noise."""

    seen: float
    """Surface of the part before the camera [m^2]."""
    right: float
    """With right depth [m^2]."""
    false: float
    """With false depth [m^2]."""
    error_mm: float | None
    """Median of |Z - truth| over the part's pixels with depth [mm]; None without any."""


@dataclass(frozen=True, eq=False)
class MeasuredPart:
    """Pixel by pixel, at the stream's full resolution; counts on the part alone."""

    seen: SeenPart
    outcome: UInt8[np.ndarray, "h w"]
    """NO_DEPTH, RIGHT_DEPTH or WRONG_DEPTH."""
    depth: Float32[np.ndarray, "h w"]
    """[m], 0 = none; of decimated depth that of the pixel's block."""
    error: Float32[np.ndarray, "h w"]
    """|Z - truth| [m]."""
    infrared: UInt8[np.ndarray, "h w"]
    """The first frame's left image [DN]."""

    @property
    def count(self) -> SurfaceCount:
        """Summed over the part."""
        area = self.seen.area.astype(float)
        measured = (area > 0) & (self.outcome != NO_DEPTH)
        error = 1e3 * float(np.median(self.error[measured])) if measured.any() else None
        right, false = (float(area[self.outcome == one].sum()) for one in (RIGHT_DEPTH, WRONG_DEPTH))
        return SurfaceCount(float(area.sum()), right, false, error)


def measured_part(store: LightStore, setup: Setup, index: int, seed: int) -> MeasuredPart:
    """From one of the store's poses. A pixel is false where it differs from the truth by more than 5 mm and three sigma
    of the noise law (`render.labels.outcome`)."""
    first = _one_look(store, setup.first_look, index, seed)
    other = setup.second_look
    return first if other is None else _fused(store, setup, first, _one_look(store, other, index, seed), index)


def _one_look(store: LightStore, setup: Setup, index: int, seed: int) -> MeasuredPart:
    light = store.light(setup.light, index)
    before = store.camera(setup.light)
    before.seen(light.T_world_cam)  # traced once for all cameras that are set from this one
    camera = before.set_to(setup.sensor, seed)
    shape = light.seen.depth.shape
    if not light.seen.area.any():
        nothing = np.zeros(shape, np.float32)
        return MeasuredPart(light.seen, np.zeros(shape, np.uint8), nothing, nothing, np.zeros(shape, np.uint8))
    z16, infrared = frames_of(camera, light, setup)
    depth, truth = processed(z16, light.seen.depth, camera, setup)
    false = is_false_depth(depth, truth, camera.rig.focal_baseline)
    outcome = np.where(depth == 0, NO_DEPTH, np.where(false, WRONG_DEPTH, RIGHT_DEPTH)).astype(np.uint8)
    factor = setup.sensor.decimation
    outcome, depth, error = (_full(image, factor, shape) for image in (outcome, depth, np.abs(depth - truth)))
    return MeasuredPart(light.seen, outcome, depth, error, infrared)


def frames_of(
    camera: SimulatedD435i, light: PoseLight, setup: Setup
) -> tuple[UInt16[np.ndarray, "n h w"], UInt8[np.ndarray, "h w"]]:
    """Depth frames around the part as the camera sends them [units], HDR pairs merged, and the first left image."""
    layers = light.layers
    if setup.lamp_level != 1:
        layers = (layers[0].with_ambient_scaled(setup.lamp_level), layers[1].with_ambient_scaled(setup.lamp_level))
    n, pixels = frames_needed(setup), near_part(light.seen)
    if setup.hdr_us is None:
        taken = camera.expose(light.T_world_cam, *layers, n, pixels)
        return taken.z16, taken.lefts[0]
    long, short = (
        camera.changed(imager=camera.settings.imager.model_copy(update={"exposure_us": exposure_us}))
        for exposure_us in setup.hdr_us
    )
    first = long.expose(light.T_world_cam, *layers, n, pixels)
    second = short.expose(light.T_world_cam, *layers, 2 * n, pixels)  # the later half: frames of their own noise
    merged = [
        hdr_merged(HdrFrame(first.z16[k], first.lefts[k]), HdrFrame(second.z16[n + k], second.lefts[n + k]))
        for k in range(n)
    ]
    return np.stack(merged), first.lefts[0]


def frames_needed(setup: Setup) -> int:
    """Frames of which the median is taken, and those by which a temporal filter has settled before."""
    settling = HISTORY - 1 if setup.filters is not None and setup.filters.temporal is not None else 0
    return setup.frames + settling


def near_part(seen: SeenPart) -> Bool[np.ndarray, "h w"]:
    """The box of the part's pixels and AROUND_PX around it."""
    rows, columns = (np.flatnonzero(seen.area.any(axis=axis)) for axis in (1, 0))
    near = np.zeros(seen.area.shape, bool)
    top, left = max(rows[0] - AROUND_PX, 0), max(columns[0] - AROUND_PX, 0)
    near[top : rows[-1] + AROUND_PX + 1, left : columns[-1] + AROUND_PX + 1] = True
    return near


def processed(
    z16: UInt16[np.ndarray, "n h w"], truth: Float32[np.ndarray, "h w"], camera: SimulatedD435i, setup: Setup
) -> tuple[Float32[np.ndarray, "h_d w_d"], Float32[np.ndarray, "h_d w_d"]]:
    """Depth after decimation, filters and the median over frames, and the truth that it is held against [m].

    The truth of a block is what decimation makes of the true depth of those of its pixels that had depth, as in
    `render.labels.outcome.perfect_blocks`; of all of its pixels where none had.
    """
    coding, factor = camera.settings.depth, setup.sensor.decimation
    true = truth
    if factor > 1:
        units = np.rint(truth / coding.unit)
        true_z16 = np.where(units <= np.iinfo(np.uint16).max, units, 0).astype(np.uint16)
        with_depth = decimate(np.where(z16 > 0, true_z16, np.uint16(0))[-setup.frames :], factor)
        whole = decimate(true_z16[None], factor)
        frames = metres_from_z16(np.where(with_depth > 0, with_depth, whole), coding)
        true = median_depth(frames, INVALID_SHARE)
        z16 = decimate(z16, factor)
    if setup.filters is not None:
        height, width = z16.shape[1:]
        chain = FilterChain(setup.filters, camera.rig.intrinsics.fx / factor, 1e3 * camera.rig.baseline, coding.unit)
        z16 = chain.process(padded(z16) if factor > 1 else z16)[:, :height, :width]
    return median_depth(metres_from_z16(z16[-setup.frames :], coding), INVALID_SHARE), true


def _full(image: np.ndarray, factor: int, shape: tuple[int, ...]) -> np.ndarray:
    """Blocks as the pixels that they are made of; what lies beyond the last whole block is 0."""
    if factor == 1:
        return image
    spread = np.repeat(np.repeat(image, factor, axis=0), factor, axis=1)
    return np.pad(spread, [(0, whole - part) for whole, part in zip(shape, spread.shape, strict=True)])


def _fused(store: LightStore, setup: Setup, first: MeasuredPart, second: MeasuredPart, index: int) -> MeasuredPart:
    """What two looks say together of the surface that the first one sees.

    Where one has no depth, the other counts; where both have, right and right stay right, and false and false false;
    right and false contradict each other by more than noise, and nothing is known there.
    """
    on_part = np.argwhere(first.seen.area > 0)
    outcome, error, depth = first.outcome.copy(), first.error.copy(), first.depth.copy()
    places, seen = _seen_again(store, setup, first.seen, second.seen, on_part, index)
    here, there = tuple(on_part[seen].T), tuple(places[seen].T)
    mine, other = outcome[here], second.outcome[there]
    outcome[here] = fused_outcome(mine, other)
    takes = (mine == NO_DEPTH) & (other != NO_DEPTH)
    error[here] = np.where(takes, second.error[there], error[here])
    depth[here] = np.where(outcome[here] == NO_DEPTH, 0, np.where(takes, first.seen.depth[here], depth[here]))
    return MeasuredPart(first.seen, outcome, depth, error, first.infrared)


def fused_outcome(mine: UInt8[np.ndarray, "n"], other: UInt8[np.ndarray, "n"]) -> UInt8[np.ndarray, "n"]:
    """Of two looks at the same points."""
    alone = np.where(mine == NO_DEPTH, other, mine)
    disagree = (mine != NO_DEPTH) & (other != NO_DEPTH) & (mine != other)
    return np.where(disagree, NO_DEPTH, alone).astype(np.uint8)


def _seen_again(
    store: LightStore,
    setup: Setup,
    first: SeenPart,
    second: SeenPart,
    pixels: Int[np.ndarray, "n 2"],
    index: int,
) -> tuple[np.ndarray, Bool[np.ndarray, "n"]]:
    """Pixels (n, 2) of the second look at which these of the first are, row first, and which of them it sees."""
    look = setup.second_look
    assert look is not None
    intrinsics = store.camera(setup.light).rig.intrinsics
    points = intrinsics.pixel_directions()[tuple(pixels.T)] * first.depth[tuple(pixels.T)][:, None]
    world = store.stands(setup.light, index).apply(points)
    there = store.stands(look.light, index).inv().apply(world)
    uv = np.rint(project(there, intrinsics)).astype(int)
    height, width = second.depth.shape
    inside = (there[:, 2] > 0) & (uv >= 0).all(axis=1) & (uv[:, 0] < width) & (uv[:, 1] < height)
    places = np.where(inside[:, None], uv[:, ::-1], 0)
    same = np.abs(second.depth[tuple(places.T)] - there[:, 2]) < SEEN_TOLERANCE + 0.01 * there[:, 2]
    return places, inside & same & (second.area[tuple(places.T)] > 0)
