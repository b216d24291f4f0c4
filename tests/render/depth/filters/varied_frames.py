"""Depth images of many kinds, on which a filter and librealsense's are to agree."""

import numpy as np

SIZE = (45, 79)
"""Rows and columns; neither is a multiple of 4."""
FRAMES = 50
"""Of a sequence."""


def varied_frames(seed: int = 0, size: tuple[int, int] = SIZE, count: int = FRAMES) -> np.ndarray:
    """Noise, tilted and rough surfaces, steps, blobs, the ends of the range; every other one with holes."""
    rng = np.random.default_rng(seed)
    kinds = (_anything, _tiny, _rough, _noisy_wall, _steps, _far_end, _holes_alone, _saturated, _blobs, _sparse)
    frames = []
    for number in range(count):
        z16 = kinds[number % len(kinds)](rng, *size).astype(np.uint16)
        if number % 2:
            z16[rng.random(size) < rng.choice([0.02, 0.2, 0.7])] = 0
        frames.append(z16)
    return np.stack(frames)


def _anything(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    return rng.integers(0, 2**16, (height, width))


def _tiny(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    return rng.integers(0, 60, (height, width))


def _rough(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    return 900 + np.cumsum(rng.integers(-14, 16, (height, width)), axis=1) + 5 * np.arange(height)[:, None]


def _noisy_wall(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    return 600 + rng.integers(-25, 26, (height, width))


def _steps(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    stripes = np.add.outer(np.arange(height), np.arange(width)) // 7 % 3
    return 500 + 18 * stripes + rng.integers(0, 4, (height, width))


def _far_end(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    return 2**16 - 1 - rng.integers(0, 40, (height, width))


def _holes_alone(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    return np.zeros((height, width))


def _saturated(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    return np.full((height, width), 2**16 - 1)


def _blobs(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    z16 = 700 + rng.integers(-3, 4, (height, width))
    for _ in range(12):
        top, left = rng.integers(0, height), rng.integers(0, width)
        z16[top : top + rng.integers(1, 12), left : left + rng.integers(1, 30)] = rng.choice([0, 0, 690, 730, 2000])
    return z16


def _sparse(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    return np.where(rng.random((height, width)) < 0.9, 0, rng.integers(300, 330, (height, width)))
