"""librealsense's decimation filter, bit for bit, and the crop that makes the paper's 60 x 40 sensor.

Blocks do not overlap and start at the top left; pixels right of and below the last whole block are dropped. Zeros are
ignored; a block is 0 only if all of it is. librealsense then appends zero columns and rows until both sides are
multiples of 4, and divides the intrinsics by the factor.

Watch the principal point: the centre of block i lies at f i + (f - 1) / 2, so after a plain division every decimated
pixel points (f - 1) / (2 f) px too far to the top left: 0.44 px at factor 8, which at 640 x 360 displaces points by
1.1 % of their depth along x and as much along y. `decimated_intrinsics` of `franbv.frames` copies that, because a real
camera's software does it; `block_centre_intrinsics` beside it is right, and what every camera here uses.
"""

import numpy as np
from jaxtyping import Shaped, UInt16

from franbv.frames import Intrinsics, centre_corner
from materials.input_error import InputError

FACTORS = range(2, 9)
"""Factors that librealsense accepts (1 passes through)."""
MEDIAN_FACTORS = (2, 3)
"""Factors with a median; larger ones take the mean."""
PADDING = 4
"""librealsense pads both sides of the result to multiples of this."""
PAPER_SIZE = (60, 40)
"""Width and height of the paper's sensor: 640 x 360, decimated by 8 to 80 x 45, middle cropped."""


def decimate(z16: UInt16[np.ndarray, "n h w"], factor: int) -> UInt16[np.ndarray, "n h_f w_f"]:
    """Depth images of floor(h / f) x floor(w / f) blocks in the same depth units, 0 = invalid. No padding.

    Factors 2 and 3 take the lower median of a block's non-zero values, 4 to 8 the truncated mean.
    """
    if factor not in FACTORS:
        raise InputError(f"decimation factor {factor}: librealsense has {FACTORS[0]} to {FACTORS[-1]}; use one of them")
    _, h, w = z16.shape
    whole = z16[:, : h // factor * factor, : w // factor * factor]
    return _lower_median(whole, factor) if factor in MEDIAN_FACTORS else _truncated_mean(whole, factor)


def _lower_median(z16: UInt16[np.ndarray, "n h w"], f: int) -> UInt16[np.ndarray, "n h_f w_f"]:
    """Of k non-zero values the one of rank ceil(k / 2) from below."""
    n, h, w = z16.shape
    blocks = z16.reshape(n, h // f, f, w // f, f).swapaxes(2, 3).reshape(n, h // f, w // f, f * f)
    ordered = np.sort(blocks, axis=-1)  # zeros first
    zeros = np.count_nonzero(ordered == 0, axis=-1)
    rank = np.minimum(zeros + (f * f - zeros - 1) // 2, f * f - 1)
    return np.take_along_axis(ordered, rank[..., None], axis=-1)[..., 0]


def _truncated_mean(z16: UInt16[np.ndarray, "n h w"], f: int) -> UInt16[np.ndarray, "n h_f w_f"]:
    """Integer part of the mean of the non-zero values."""
    n, h, w = z16.shape
    rows = (n, h // f, f, w)
    # Rows first: that sum runs along memory and leaves 1 / f of the pixels for the second one.
    sums = z16.reshape(rows).sum(axis=2, dtype=np.uint32).reshape(n, h // f, w // f, f).sum(axis=3, dtype=np.uint32)
    valid = (z16 != 0).view(np.uint8).reshape(rows).sum(axis=2, dtype=np.uint8)
    counts = valid.reshape(n, h // f, w // f, f).sum(axis=3, dtype=np.uint32)
    return (sums // np.maximum(counts, 1)).astype(np.uint16)


def pixel_blocks(image: Shaped[np.ndarray, "h w"], factor: int) -> Shaped[np.ndarray, "h_f w_f n"]:
    """The n = factor^2 pixels behind each decimated one; a rest at the right and below is left out."""
    h, w = (side // factor for side in image.shape)
    whole = image[: h * factor, : w * factor].reshape(h, factor, w, factor)
    return whole.swapaxes(1, 2).reshape(h, w, factor * factor)


def padded(decimated: UInt16[np.ndarray, "n h w"]) -> UInt16[np.ndarray, "n h_4 w_4"]:
    """The same with librealsense's zero padding at the right and the bottom."""
    _, h, w = decimated.shape
    return np.pad(decimated, ((0, 0), (0, -h % PADDING), (0, -w % PADDING)))


def crop_centre(
    depths: UInt16[np.ndarray, "n h w"], intrinsics: Intrinsics, size: tuple[int, int] = PAPER_SIZE
) -> tuple[UInt16[np.ndarray, "n h_c w_c"], Intrinsics]:
    """The middle `size` (width, height) of unpadded images and its intrinsics.

    80 x 45 to 60 x 40 leaves out 10 columns on either side, 2 rows at the top and 3 at the bottom.
    """
    width, height = size
    if width > intrinsics.width or height > intrinsics.height:
        have = f"{intrinsics.width}x{intrinsics.height}"
        raise InputError(f"depth crop {width}x{height}: larger than the decimated image, {have}; choose a smaller one")
    left, top = centre_corner((intrinsics.width, intrinsics.height), size)
    return depths[:, top : top + height, left : left + width], intrinsics.cropped(left, top, width, height)
