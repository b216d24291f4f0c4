"""Synthetic rectified pairs of a known disparity, by resampling one band-limited random texture."""

import numpy as np
from jaxtyping import Float, UInt8
from scipy.ndimage import gaussian_filter, map_coordinates


def random_texture(shape: tuple[int, int], seed: int, blur: float = 1.2) -> Float[np.ndarray, "h w"]:
    """Band-limited noise in 40..215 DN; `blur` is the Gaussian sigma [px], 1.2 is about an imaged laser dot."""
    noise = gaussian_filter(np.random.default_rng(seed).normal(size=shape), blur, mode="wrap")
    return np.clip(127 + 40 * noise / noise.std(), 40, 215)


def warped_pair(
    disparity: Float[np.ndarray, "h w"], seed: int, blur: float = 1.2
) -> tuple[UInt8[np.ndarray, "h w"], UInt8[np.ndarray, "h w"]]:
    """Left and right images in which left pixel (v, u) shows what the right one shows at (v, u - disparity).

    The right image is the texture; the left one samples it at u - disparity by cubic splines, so there is no occlusion.
    The texture reaches 200 px beyond the right image on both sides.
    """
    h, w = disparity.shape
    texture = random_texture((h, w + 400), seed, blur)
    rows, columns = np.mgrid[:h, :w].astype(float)
    left = map_coordinates(texture, [rows, columns + 200 - disparity], order=3, mode="nearest")
    right = texture[:, 200 : 200 + w]
    return tuple(np.clip(np.rint(image), 0, 255).astype(np.uint8) for image in (left, right))
