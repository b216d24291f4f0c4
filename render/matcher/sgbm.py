"""OpenCV's semi-global block matcher behind the matcher interface (Hirschmueller, PAMI 2008), as a plain reference."""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, UInt8

from render.matcher.interface import N_DISPARITIES, PATH_MARGIN, StereoMatcher, Window

OPENCV_STEPS = 16
"""StereoSGBM returns int16 disparities in 1/16 px, a subset of the interface's 1/32 px grid."""

OPENCV_MULTIPLE = 16
"""StereoSGBM searches whole multiples of 16 disparities; what is beyond the wanted ones is thrown away."""


@dataclass(frozen=True)
class SgbmMatcher(StereoMatcher):
    """StereoSGBM with left-right check, uniqueness, speckle filter and a texture gate.

    Finds 1/16 px. P1 and P2 are 8 and 32 times the block's area (OpenCV's documentation). A reference whose workings
    are public; its settings are not fitted to any camera.
    """

    block_size: int = 5
    """Side of the matched block [px]; OpenCV's documentation advises 3..11."""
    uniqueness_percent: int = 10
    """Margin by which the best cost must beat the second best [%]; OpenCV's documentation advises 5..15."""
    left_right_px: int = 1
    """Largest left-right difference [px]; the smallest check OpenCV offers, near the D4 chip's 24/32 px."""
    speckle_size: int = 100
    """Segments smaller than this are dropped [px]; OpenCV's documentation advises 50..200."""
    speckle_step: int = 2
    """Largest disparity step inside a segment [px]; OpenCV's documentation: 1 or 2 is good enough."""
    texture_range: int = 4
    """Smallest intensity range in the 9 x 9 neighbourhood [DN]. Choice: the range of 81 pixels of pure image noise
    of 0.5 DN is about 2.5 DN, and without this gate StereoSGBM fills empty background with nonsense."""
    full_paths: bool = False
    """Eight paths (MODE_HH, slow, whole volume in memory) instead of three (MODE_SGBM_3WAY)."""

    def match_burst(
        self,
        lefts: UInt8[np.ndarray, "n h w"],
        rights: UInt8[np.ndarray, "n h w"],
        window: Window | None = None,
        min_disparity: int = 0,
        n_disparities: int = N_DISPARITIES,
    ) -> Float32[np.ndarray, "n h w"]:
        """Disparities [px], 0 = invalid; see `StereoMatcher.match_burst`."""
        window = window or Window.whole(lefts.shape)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            frames = pool.map(
                lambda left, right: self._match(left, right, window, min_disparity, n_disparities), lefts, rights
            )
            return np.stack(list(frames))

    def _match(
        self,
        left: UInt8[np.ndarray, "h w"],
        right: UInt8[np.ndarray, "h w"],
        window: Window,
        min_disparity: int,
        n_disparities: int,
    ) -> Float32[np.ndarray, "h w"]:
        h, w = left.shape
        searched = -(-n_disparities // OPENCV_MULTIPLE) * OPENCV_MULTIPLE
        reach = min_disparity + searched
        rows = slice(max(window.top - PATH_MARGIN, 0), min(window.top + window.height + PATH_MARGIN, h))
        # The left-right check asks every left column that a right pixel may belong to, hence `reach` on both sides.
        first = max(window.left - PATH_MARGIN - reach, 0)
        columns = slice(first, min(window.left + window.width + reach, w))
        # StereoSGBM leaves its leftmost `reach` columns unmatched; padding keeps only the true left band invalid.
        pair = [
            cv2.copyMakeBorder(image[rows, columns], 0, 0, reach, 0, cv2.BORDER_REPLICATE) for image in (left, right)
        ]
        found = self._stereo(min_disparity, searched).compute(*pair)[:, reach:].astype(np.float32) / OPENCV_STEPS
        has_partner = np.arange(found.shape[1])[None, :] + first >= found
        in_range = (found > 0) & (found >= min_disparity) & (found <= min_disparity + n_disparities - 1)
        disparity = np.zeros((h, w), np.float32)
        disparity[rows, columns] = np.where(
            in_range & has_partner & _textured(left[rows, columns], self.texture_range), found, 0
        )
        outside = np.ones((h, w), bool)
        outside[window.slices] = False
        disparity[outside] = 0
        return disparity

    def _stereo(self, min_disparity: int, searched: int) -> cv2.StereoSGBM:
        area = self.block_size**2
        return cv2.StereoSGBM.create(
            minDisparity=min_disparity,
            numDisparities=searched,
            blockSize=self.block_size,
            P1=8 * area,  # OpenCV's documentation: 8 and 32 times channels times block area
            P2=32 * area,
            disp12MaxDiff=self.left_right_px,
            uniquenessRatio=self.uniqueness_percent,
            speckleWindowSize=self.speckle_size,
            speckleRange=self.speckle_step,
            mode=cv2.STEREO_SGBM_MODE_HH if self.full_paths else cv2.STEREO_SGBM_MODE_SGBM_3WAY,
        )


def _textured(image: UInt8[np.ndarray, "h w"], smallest_range: int) -> Bool[np.ndarray, "h w"]:
    """Whether the 9 x 9 neighbourhood spans at least `smallest_range` [DN]."""
    window = np.ones((9, 9), np.uint8)
    return cv2.subtract(cv2.dilate(image, window), cv2.erode(image, window)) >= smallest_range
