"""Images on disk and in pages: PNG bytes, 16-bit depth in millimetres, EXR layers, depth in colour."""

import base64
from pathlib import Path

import cv2
import numpy as np
import OpenEXR
from jaxtyping import Float, UInt8, UInt16

from studies.base.atomic_file import write_atomically

MM = 1000.0
"""Millimetres in a metre."""


def png(image: UInt8[np.ndarray, "h w"] | UInt8[np.ndarray, "h w c"] | UInt16[np.ndarray, "h w"]) -> bytes:
    """The image as PNG; three channels are red, green, blue, four have alpha."""
    if image.ndim == 3:
        image = image[..., [2, 1, 0, *range(3, image.shape[2])]]  # OpenCV wants blue first
    _, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 9])
    return data.tobytes()


def write_png(path: Path, image: np.ndarray) -> None:
    """Write the image whole or not at all."""
    write_atomically(path, png(image))


def read_png(path: Path) -> np.ndarray:
    """The image as it was written, (h, w), (h, w, 3) red, green, blue, or (h, w, 4) with alpha."""
    image = cv2.imdecode(np.frombuffer(path.read_bytes(), np.uint8), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise ValueError(f"{path}: not an image")
    return image[..., [2, 1, 0, *range(3, image.shape[2])]] if image.ndim == 3 else image


def millimetres(depth: Float[np.ndarray, "h w"]) -> UInt16[np.ndarray, "h w"]:
    """Depth [m] as whole millimetres, 0 = invalid; what does not fit into 16 bits (65 m) is invalid."""
    rounded = np.rint(np.asarray(depth, float) * MM)
    return np.where(rounded <= 65535, rounded, 0).astype(np.uint16)


def write_exr(path: Path, layer: Float[np.ndarray, "h w"], name: str) -> None:
    """Write one float32 channel `name`, losslessly compressed."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {name: np.ascontiguousarray(layer, np.float32)}) as file:
        file.write(str(path))


def read_exr(path: Path, name: str) -> Float[np.ndarray, "h w"]:
    """The channel `name` of an EXR file."""
    with OpenEXR.File(str(path)) as file:
        return np.array(file.channels()[name].pixels)


def data_uri(image: np.ndarray) -> str:
    """The image as a PNG inside a page."""
    return "data:image/png;base64," + base64.b64encode(png(image)).decode()


def photo_uri(image: UInt8[np.ndarray, "h w"], quality: int = 80) -> str:
    """The image as a JPEG inside a page: to be looked at, not to be measured (a tenth of the PNG's size)."""
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return "data:image/jpeg;base64," + base64.b64encode(data.tobytes()).decode()


def coloured_depth(
    depth: Float[np.ndarray, "h w"], nearest: float, farthest: float, invalid: tuple[int, int, int] = (38, 38, 42)
) -> UInt8[np.ndarray, "h w 3"]:
    """Depth [m] in the viridis map, bright = near; pixels without depth in the colour `invalid`."""
    share = np.clip((farthest - depth) / max(farthest - nearest, 1e-9), 0, 1)
    colours = cv2.applyColorMap(np.rint(share * 255).astype(np.uint8), cv2.COLORMAP_VIRIDIS)[..., ::-1]
    return np.where((depth > 0)[..., None], colours, np.array(invalid)).astype(np.uint8)
