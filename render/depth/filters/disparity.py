"""Depth to disparity and back, as librealsense's disparity transform does it: the domain that its other filters run in.

Disparities are float32 in 1/32 px and 0 where there is none, never -0 or negative. librealsense asks for nothing else:
a frame of float32 is disparity, one of uint16 is depth, and each filter has its own rules for either.

Source: librealsense, `src/proc/disparity-transform.h`.
"""

import numpy as np
from jaxtyping import Float32, UInt16

DepthOrDisparity = UInt16[np.ndarray, "n h w"] | Float32[np.ndarray, "n h w"]
"""n frames of depth [units] or of disparity [1/32 px], 0 = invalid."""
FRACTIONS = 32
"""Steps of one pixel of disparity."""


def disparity_factor(focal: float, baseline: float, unit: float) -> np.float32:
    """Disparity times depth [1/32 px x units], rounded where librealsense rounds.

    focal: of the stream, in x [px]. baseline: of the two imagers [mm]. unit: of depth [m].
    """
    metres = np.float32(baseline) * np.float32(1e-3)
    return metres * np.float32(focal) * np.float32(FRACTIONS) / np.float32(unit)


def disparity_from_depth(z16: UInt16[np.ndarray, "n h w"], factor: np.float32) -> Float32[np.ndarray, "n h w"]:
    """`factor` / depth; 0 stays 0."""
    depth = z16.astype(np.float32)
    return np.divide(factor, depth, out=np.zeros_like(depth), where=z16 != 0)


def depth_from_disparity(disparity: Float32[np.ndarray, "n h w"], factor: np.float32) -> UInt16[np.ndarray, "n h w"]:
    """`factor` / disparity, rounded half up; 0 stays 0.

    What exceeds 16 bits loses its upper bits, as in librealsense. Depth that came from 16 bits never does.
    """
    units = np.divide(factor, disparity, out=np.full_like(disparity, -0.5), where=disparity > 0)
    return (units + np.float32(0.5)).astype(np.int32).astype(np.uint16)
