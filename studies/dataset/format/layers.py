"""The images of a view: folder, coding, meaning. One table for the writer, the reader, the check and the card."""

from dataclasses import dataclass

import numpy as np

NOTHING_16 = 65535
"""Stands for `nothing there`, or `no such number`, where 0 is a value."""


@dataclass(frozen=True)
class Layer:
    """One image per view, `FOLDER/000000.png`."""

    folder: str
    dtype: type
    channels: int
    meaning: str
    """What a pixel says, with unit and the value for nothing."""
    scale: float | None = None
    """Multiply by this for the unit of `unit`; None = codes or grey values, used as they are."""
    unit: str = ""
    nothing: int | None = None
    """Raw value that becomes NaN; 0 stays 0 in depth."""
    decimated: bool = False


LAYERS = (
    Layer("gray", np.uint8, 1, "left infrared image, grey values 0 to 255"),
    Layer("gray_right", np.uint8, 1, "right infrared image, grey values 0 to 255"),
    Layer("depth", np.uint16, 1, "Z-depth of the left imager [mm], 0 = none", 1e-3, "m"),
    Layer("depth_decimated", np.uint16, 1, "the same after librealsense's decimation", 1e-3, "m", None, True),
    Layer("depth_true", np.uint16, 1, "true Z-depth [0.1 mm], 0 = nothing there", 1e-4, "m"),
    Layer(
        "normal",
        np.uint16,
        3,
        "true unit normal in the camera frame, towards the camera: value / 32767 - 1; 65535 = nothing there",
        1 / 32767,
        "-",
        NOTHING_16,
    ),
    Layer(
        "incidence",
        np.uint16,
        1,
        "true angle between normal and view ray [0.01 deg], 65535 = nothing there",
        np.pi / 18000,
        "rad",
        NOTHING_16,
    ),
    Layer("body", np.uint8, 1, "1 + number of the body in `scene.json`, 0 = nothing there"),
    Layer("material", np.uint8, 1, "1 + number of the material in `dataset.json`, 0 = nothing there"),
    Layer(
        "roughness_u",
        np.uint16,
        1,
        "roughness (GGX alpha) along the marks of machining [1e-4], 65535 = matte or nothing there",
        1e-4,
        "-",
        NOTHING_16,
    ),
    Layer("roughness_v", np.uint16, 1, "the same across them", 1e-4, "-", NOTHING_16),
    Layer("cause", np.uint8, 1, "why depth is missing, by the codes of `dataset.json`; 0 = has depth"),
    Layer("false_depth", np.uint8, 1, "0 = none or right; 20 = false, right on a matte surface; 21 = false otherwise"),
    Layer("cause_decimated", np.uint8, 1, "why decimated depth is missing", None, "", None, True),
    Layer("false_depth_decimated", np.uint8, 1, "the same as false_depth, decimated", None, "", None, True),
)
MISSING = Layer("missing_frames", np.uint8, 1, "number of the view's frames in which the pixel has no depth")
FRAMES = Layer("depth_frames", np.uint16, 1, "Z-depth of each single frame [mm], 0 = none", 1e-3, "m")
"""Kept only where the configuration asks for it, `depth_frames/000000_000000.png`."""
BY_FOLDER = {layer.folder: layer for layer in (*LAYERS, MISSING, FRAMES)}
MASKS = ("mask", "mask_visib")
"""Silhouette of each object as if it were alone, and what of it is seen; `mask/000000_000000.png`, 0 or 255."""


def layers(n_frames: int) -> tuple[Layer, ...]:
    """Those of a dataset with this many frames a view."""
    return LAYERS if n_frames == 1 else (*LAYERS, MISSING)


def decoded(layer: Layer, raw: np.ndarray) -> np.ndarray:
    """The image in SI units, NaN for nothing; codes and grey values as they are."""
    if layer.scale is None:
        return raw
    values = raw.astype(np.float32) * np.float32(layer.scale)
    if layer.folder == "normal":
        values -= 1
    return values if layer.nothing is None else np.where(raw == layer.nothing, np.float32(np.nan), values)


def decoded_layer(folder: str, raw: np.ndarray) -> np.ndarray:
    """`decoded`, of the layer in this folder."""
    return decoded(BY_FOLDER[folder], raw)
