"""librealsense's temporal filter: a moving average of each pixel over frames, which can keep the last depth over holes.

A pixel that comes within `delta` of what is remembered is averaged with it; one that does not is taken as it is and its
history begins anew. Depth is cut to whole units, not rounded, so that the average of a noisy pixel lies too near, by
about a unit at the default alpha. A hole gets the remembered value if this pixel was valid in enough of the frames
before this one, by the persistence mode. Holes do not change what is remembered: mode 8 keeps for ever what was seen
once.

Source: librealsense, `src/proc/temporal-filter.h` and `.cpp`.
"""

from functools import cache
from typing import no_type_check

import numba
import numpy as np
from jaxtyping import Bool, Shaped, UInt8
from pydantic import BaseModel, ConfigDict, Field

from render.depth.filters.disparity import DepthOrDisparity

HISTORY = 8
"""Number of frames of which it is known where they were valid."""
PERSISTENCE = ((9, 8), (8, 8), (2, 3), (2, 4), (2, 8), (1, 2), (1, 5), (1, 8), (0, 8))
"""Modes 0 to 8: a hole is filled if at least so many of the last so many frames were valid; 9 of 8 never, 0 always."""


class TemporalSettings(BaseModel):
    """The options of `rs2::temporal_filter`, in librealsense's ranges and with its defaults.

    Unknown keys and numbers out of range raise pydantic's ValidationError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    alpha: float = Field(default=0.4, ge=0.0, le=1.0)
    """Weight of a frame against what is remembered (`filter_smooth_alpha`); 1 averages nothing."""
    delta: int = Field(default=20, ge=1, le=100)
    """A change that is not averaged [depth units, or 1/32 px of disparity] (`filter_smooth_delta`)."""
    persistence: int = Field(default=3, ge=0, le=len(PERSISTENCE) - 1)
    """Which of the modes of `PERSISTENCE` fills holes (`holes_fill`)."""


class TemporalFilter:
    """The filter with its memory of one stream: empty at first, and after a change of size or domain."""

    def __init__(self, settings: TemporalSettings | None = None) -> None:
        """settings: librealsense's defaults if None."""
        self._settings = settings or TemporalSettings()
        self._seen = 0
        self._remembered: Shaped[np.ndarray, "h w"] = np.zeros((0, 0), np.uint16)
        self._history: UInt8[np.ndarray, "h w"] = np.zeros((0, 0), np.uint8)

    def process(self, frames: DepthOrDisparity) -> DepthOrDisparity:
        """The next n frames of the stream, filtered in their order."""
        if (self._remembered.shape, self._remembered.dtype) != (frames.shape[1:], frames.dtype):
            self._remembered = np.zeros(frames.shape[1:], frames.dtype)
            self._history = np.zeros(frames.shape[1:], np.uint8)
        alpha, delta = np.float32(self._settings.alpha), np.float32(self._settings.delta)
        credible = _credible(self._settings.persistence)
        filtered = np.array(frames, order="C")
        for frame in filtered:
            phase = self._seen % HISTORY
            _average(frame, self._remembered, self._history, alpha, delta, np.uint8(1 << phase), credible[phase])
            self._seen += 1
        return filtered


@cache
def _credible(persistence: int) -> Bool[np.ndarray, "8 256"]:
    """Whether a hole is filled, by phase and history.

    Bit k of a history is the last frame whose number is k modulo 8; phase is this frame's number modulo 8.
    """
    least, last = PERSISTENCE[persistence]
    phase, age = np.arange(HISTORY)[:, None, None], np.arange(1, last + 1)
    valid = np.arange(256)[:, None] >> ((phase - age) % HISTORY) & 1
    return valid.sum(axis=-1) >= least


@no_type_check
@numba.njit(nogil=True, cache=True)
def _average(
    frame: Shaped[np.ndarray, "h w"],
    remembered: Shaped[np.ndarray, "h w"],
    history: UInt8[np.ndarray, "h w"],
    alpha: np.float32,
    delta: np.float32,
    this: np.uint8,
    credible: Bool[np.ndarray, "256"],
) -> None:
    """Filter `frame` in place and remember it; `this` is its bit in the history."""
    rest, others = np.float32(1.0) - alpha, np.uint8(~this)
    height, width = frame.shape
    for v in range(height):
        for u in range(width):
            now, before = np.float32(frame[v, u]), np.float32(remembered[v, u])
            if now == 0:
                if before != 0 and credible[history[v, u]]:
                    frame[v, u] = remembered[v, u]
                history[v, u] &= others
            elif before != 0 and abs(now - before) < delta:
                frame[v, u] = alpha * now + rest * before  # which cuts depth to whole units
                remembered[v, u] = frame[v, u]
                history[v, u] |= this
            else:
                remembered[v, u] = frame[v, u]
                history[v, u] = this
