"""How a depth camera errs, in numbers that can be taken of real and of simulated frames alike.

Each function takes the disparity that was measured (px, 0 = hole) and the truth at the same pixels. They are those of
published statistics of real D400 frames with a laser scanner's truth: noise of smooth surfaces and how far it is
correlated, what half-occluded pixels show, holes beside edges, sizes of holes, holes and noise by incidence and by
contrast.
"""

from dataclasses import dataclass, field
from itertools import pairwise

import cv2
import numpy as np
from jaxtyping import Bool, Float, UInt8

PATCH_PX = 96
"""Side of the patches on which noise is measured [px] (of the published numbers)."""
STRIDE_PX = 48
"""From one patch to the next [px]; choice: half a patch, so that hardly a surface is missed."""
FLAT_PX = 0.02
"""Largest departure of a smooth surface's true disparity from a plane inside a patch [px]; choice: far below noise."""
LEAST_FILLED = 0.8
"""Of a patch, for its noise to be measured; choice."""
MAD_TO_SIGMA = 1.4826
"""Of a normal distribution."""
OUTLIER_SIGMAS = 5.0
"""Residuals beyond this many robust sigmas are false matches, not noise; choice."""
LAGS = (1, 2, 4, 8, 12, 16)
"""At which the autocorrelation is published [px]."""
SAME_PX = 1.0
"""A disparity this near to that of a surface is that surface's [px]; choice: seven sigmas of the real noise."""
EDGE_PX = 5.0
"""Least disparity step of a depth edge in profiles [px]; choice, as the published profiles do not name theirs: well
above what a tilted surface rises by from pixel to pixel. The band without a partner is as wide as the step, so the
shares at 12 px depend on it."""
PROFILE = (0, 4, 8, 12)
"""Distances from an edge at which shares are published [px]."""
BEND_PX = 1.0
"""Second difference of true disparity between neighbours that ends a surface [px]; choice."""
AWAY_PX = 16
"""From such an end, to count as on a surface [px]; choice: as far as a census in a support cross reaches."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A measured frame and what is really there."""

    left: UInt8[np.ndarray, "h w"]
    """Left infrared image [DN]."""
    found: Float[np.ndarray, "h w"]
    """Measured disparity [px], 0 = hole."""
    true: Float[np.ndarray, "h w"]
    """True disparity [px], 0 = nothing there."""
    incidence: Float[np.ndarray, "h w"]
    """[rad]"""
    in_right: Bool[np.ndarray, "h w"]
    """Whether the point falls on the right imager's pixels, hidden or not."""
    visible: Bool[np.ndarray, "h w"]
    """Whether the right imager sees the point, too."""
    counted: Bool[np.ndarray, "h w"]
    """Pixels that statistics are about: within the range of depth and lit as the published frames were."""
    on_surface: Bool[np.ndarray, "h w"] = field(init=False)
    """Counted, seen by both imagers and away from every end of its surface."""

    def __post_init__(self) -> None:
        """Find the ends of surfaces."""
        object.__setattr__(self, "on_surface", self.visible & self.counted & ~near_bend(self.true))


def near_bend(true: Float[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Within `AWAY_PX` of a step of true disparity, along rows or columns."""
    bends = np.zeros(true.shape, bool)
    bends[:, 1:-1] |= np.abs(np.diff(true, 2, axis=1)) > BEND_PX
    bends[1:-1] |= np.abs(np.diff(true, 2, axis=0)) > BEND_PX
    return np.asarray(cv2.dilate(bends.astype(np.uint8), np.ones((2 * AWAY_PX + 1,) * 2, np.uint8))) > 0


def robust_sigma(values: Float[np.ndarray, "*n"]) -> float:
    """1.4826 times the median distance from the median, NaN without values."""
    return float(MAD_TO_SIGMA * np.median(np.abs(values - np.median(values)))) if values.size else float("nan")


def plane_residual(disparity: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h w"]:
    """What is left of a patch after its plane, fitted without false matches; NaN at holes (0) and false matches."""
    rows, columns = np.mgrid[: disparity.shape[0], : disparity.shape[1]]
    basis = np.stack([np.ones(disparity.size), rows.ravel(), columns.ravel()], axis=1)
    values, kept = disparity.ravel(), disparity.ravel() > 0
    rest = values - np.median(values[kept])
    for _ in range(4):
        plane, *_ = np.linalg.lstsq(basis[kept], values[kept], rcond=None)
        rest = values - basis @ plane
        limit = OUTLIER_SIGMAS * max(robust_sigma(rest[kept]), 1e-3)
        kept = (values > 0) & (np.abs(rest - np.median(rest[kept])) <= limit)
    return np.where(kept, rest, np.nan).reshape(disparity.shape)


def smooth_patches(frame: Frame) -> list[Float[np.ndarray, "p p"]]:
    """Residuals about their planes of all patches that show one flat surface, seen by both imagers."""
    h, w = frame.found.shape
    found = []
    for top in range(0, h - PATCH_PX + 1, STRIDE_PX):
        for left in range(0, w - PATCH_PX + 1, STRIDE_PX):
            at = np.s_[top : top + PATCH_PX, left : left + PATCH_PX]
            if not (frame.visible[at] & frame.counted[at]).all():
                continue
            if np.nanmax(np.abs(plane_residual(frame.true[at]))) > FLAT_PX or np.abs(np.diff(frame.true[at])).max() > 1:
                continue
            if np.mean(frame.found[at] > 0) >= LEAST_FILLED:
                found.append(plane_residual(frame.found[at]))
    return found


def autocorrelation(residual: Float[np.ndarray, "h w"], axis: int) -> Float[np.ndarray, " l"]:
    """Of a patch's residuals at `LAGS` along an axis (1: x), over the pairs of which both are measured."""
    x = residual if axis == 1 else residual.T
    x = x - np.nanmean(x)
    variance = np.nanmean(x**2)
    return np.array([np.nanmean(x[:, lag:] * x[:, :-lag]) for lag in LAGS]) / variance


def half_occluded_shares(frames: list[Frame]) -> tuple[float, float, float, float]:
    """Of pixels that the right imager would have to see but something hides: hole, foreground, background, other.

    Foreground: at the disparity of what hides them, the nearest surface to the right in the same row that covers their
    place in the right image; background: at their own.
    """
    counts = np.zeros(4)
    for frame in frames:
        hidden = frame.counted & frame.in_right & ~frame.visible
        cover = hiding_disparity(frame.true)[hidden]
        found, true = frame.found[hidden], frame.true[hidden]
        hole = found == 0
        front = ~hole & (np.abs(found - cover) <= SAME_PX)
        back = ~hole & ~front & (np.abs(found - true) <= SAME_PX)
        counts += [hole.sum(), front.sum(), back.sum(), (~hole & ~front & ~back).sum()]
    hole, front, back, other = counts / counts.sum()
    return float(hole), float(front), float(back), float(other)


def hiding_disparity(true: Float[np.ndarray, "h w"], reach: int = 126) -> Float[np.ndarray, "h w"]:
    """Disparity of the first pixel to the right that lands in the right image at or left of each pixel, or NaN."""
    columns = np.arange(true.shape[1])
    landing = np.where(true > 0, columns - true, np.inf)
    cover = np.full(true.shape, np.nan)
    for k in range(1, min(reach, true.shape[1] - 1) + 1):
        here = cover[:, :-k]
        covers = np.isnan(here) & (landing[:, k:] <= landing[:, :-k])
        here[covers] = true[:, k:][covers]
    return cover


def edge_profile(frames: list[Frame], side: str, step: float = EDGE_PX) -> Float[np.ndarray, "k 2"]:
    """Shares of holes and of the foreground's disparity in the background beside near edges, at `PROFILE` px.

    side: `left` of the near thing, where the right imager does not see the background, or `right` of it. Pixel 0 is the
    first of the background. step: of an edge [px]. A place counts as long as the background goes on
    without a further edge.
    """
    sums, numbers = np.zeros((len(PROFILE), 2)), np.zeros(len(PROFILE))
    for frame in frames:
        true, found, inside = frame.true, frame.found, frame.in_right & frame.counted
        if side == "right":
            true, found, inside = true[:, ::-1], found[:, ::-1], inside[:, ::-1]
        for y, x in np.argwhere(np.diff(true, axis=1) >= step):  # x: background, x + 1: near
            near = true[y, x + 1]
            for i, k in enumerate(PROFILE):
                if x < k or not inside[y, x - k] or np.any(near - true[y, x - k : x + 1] < step):
                    break
                hole = found[y, x - k] == 0
                sums[i] += [hole, not hole and abs(found[y, x - k] - near) <= SAME_PX]
                numbers[i] += 1
    return sums / numbers[:, None]


def hole_blobs(frames: list[Frame], large: int = 1000) -> tuple[float, float]:
    """Median size of connected holes [px], and the share of their area in those of `large` px or more.

    Holes that the right imager cannot see, in the left band, are left out.
    """
    sizes = []
    for frame in frames:
        holes = ((frame.found == 0) & frame.in_right & frame.counted).astype(np.uint8)
        sizes.append(cv2.connectedComponentsWithStats(holes, connectivity=4)[2][1:, cv2.CC_STAT_AREA])
    areas = np.concatenate(sizes)
    return float(np.median(areas)), float(areas[areas >= large].sum() / areas.sum())


def by_incidence(frames: list[Frame], edges_deg: tuple[float, ...]) -> Float[np.ndarray, "b 3"]:
    """Per bin of incidence, on surfaces that both imagers see: pixels, share of holes, sigma of the error [px]."""
    degrees = np.concatenate([np.degrees(frame.incidence[frame.on_surface]) for frame in frames])
    return _by_bin(frames, degrees, edges_deg)


def by_contrast(frames: list[Frame], edges_dn: tuple[float, ...]) -> Float[np.ndarray, "b 3"]:
    """The same by the standard deviation of the left image over 9 x 9 pixels [DN]."""
    return _by_bin(frames, np.concatenate([contrast(frame.left)[frame.on_surface] for frame in frames]), edges_dn)


def contrast(image: UInt8[np.ndarray, "h w"]) -> Float[np.ndarray, "h w"]:
    """Standard deviation over 9 x 9 pixels [DN]."""
    grey = image.astype(np.float64)
    mean, square = cv2.blur(grey, (9, 9)), cv2.blur(grey**2, (9, 9))
    return np.sqrt(np.maximum(square - mean**2, 0))


def _by_bin(frames: list[Frame], of: Float[np.ndarray, " n"], edges: tuple[float, ...]) -> Float[np.ndarray, "b 3"]:
    found = np.concatenate([frame.found[frame.on_surface] for frame in frames])
    true = np.concatenate([frame.true[frame.on_surface] for frame in frames])
    rows = []
    for low, high in pairwise(edges):
        inside = (of >= low) & (of < high)
        filled = inside & (found > 0)
        holes = np.mean(found[inside] == 0) if inside.any() else np.nan
        rows.append([inside.sum(), holes, robust_sigma((found - true)[filled])])
    return np.array(rows, float)
