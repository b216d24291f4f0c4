"""Depth images as bytes and back, to the last bit: 16-bit steps where depth is such a number, else 32-bit floats."""

import numpy as np
from jaxtyping import Float32, UInt8

STEPS_16, METRES_32, GREY_8 = "16UC1", "32FC1", "mono8"
"""Encodings by the names that ROS and Foxglove have for them (little-endian rows without padding)."""
PIXEL_TYPES = {STEPS_16: np.dtype("<u2"), METRES_32: np.dtype("<f4"), GREY_8: np.dtype("u1")}
DEFAULT_UNIT = 1e-3
"""Depth of one step [m] where nothing else is said: librealsense's default, and REP 118's for 16-bit images."""


def coding_of(depths: Float32[np.ndarray, "n h w"], unit: float | None) -> str:
    """The encoding that gives these frames [m] back to the bit; unit: of one 16-bit step [m]."""
    unit = unit or DEFAULT_UNIT
    steps = np.rint(depths / np.float32(unit))
    if not np.all((steps >= 0) & (steps <= np.iinfo(np.uint16).max)):
        return METRES_32
    back = metres(steps.astype("<u2"), unit)
    return STEPS_16 if np.array_equal(back.view(np.uint32), depths.view(np.uint32)) else METRES_32


def image_bytes(depth: Float32[np.ndarray, "h w"], coding: str, unit: float | None) -> bytes:
    """Pixels of one frame [m], row by row."""
    if coding == METRES_32:
        return depth.astype("<f4").tobytes()
    return np.rint(depth / np.float32(unit or DEFAULT_UNIT)).astype("<u2").tobytes()


def image_of(data: bytes, width: int, height: int, coding: str) -> np.ndarray:
    """The pixels (height, width) as they were coded; ValueError for another number of bytes."""
    if len(data) != width * height * PIXEL_TYPES[coding].itemsize:
        raise ValueError(f"{len(data)} bytes are no {coding} image of {width} x {height} pixels")
    return np.frombuffer(data, PIXEL_TYPES[coding]).reshape(height, width)


def metres(pixels: np.ndarray, unit: float | None) -> Float32[np.ndarray, "*n h w"]:
    """Z-depth [m], 0 = invalid, of 16-bit steps; floats are metres already."""
    if pixels.dtype.kind == "f":
        return pixels.astype(np.float32)
    return pixels * np.float32(unit or DEFAULT_UNIT)


def grey_bytes(image: UInt8[np.ndarray, "h w"]) -> bytes:
    """An infrared image, row by row."""
    return np.ascontiguousarray(image).tobytes()
