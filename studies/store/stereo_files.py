"""Reading what `franbv match` is given: an infrared pair, and the depth that the camera itself made of it."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Bool, Float, UInt8, UInt16

from materials.input_error import InputError
from studies.store.images import MM, read_png

SMALLEST_SIDE_PX = 32
"""Sides below this leave nothing between the margins [px]; choice."""
Y10_BITS = 10
"""Of the deepest infrared stream that a D400 gives (librealsense: Y10 and Y16 hold 10 bits)."""


@dataclass(frozen=True, eq=False)
class ReferenceDepth:
    """A camera's own depth, at the pair's resolution or at half of it."""

    depth: Float[np.ndarray, "h w"]
    """Z-depth [m], 0 = hole. Where `metric` is False, a quantity that grows with depth, in [0, 1] instead."""
    metric: bool
    """False for a picture in false colours: its holes are exact, its depth has an unknown scale."""
    factor: int
    """Pixels of the pair per pixel of this image, 1 or 2."""

    @property
    def holes(self) -> Bool[np.ndarray, "h w"]:
        """Pixels without depth."""
        return self.depth == 0


def read_pair(left: Path, right: Path) -> tuple[UInt8[np.ndarray, "h w"], UInt8[np.ndarray, "h w"], str]:
    """Two images of one size, 8 bits each, and what was done to make them so ("" = nothing).

    Equal channels count as one and alpha is dropped. 16-bit images that hold 8 bits (Y8) are taken as they are; those
    that hold 10 bits (Y10) lose their lowest two.
    """
    images = [_read_infrared(path) for path in (left, right)]
    if images[0].shape != images[1].shape:
        sizes = " and ".join(_size(image) for image in images)
        raise InputError(f"{left}, {right}: the images are {sizes}; give a rectified pair of one size")
    if np.array_equal(images[0], images[1]):
        raise InputError(f"{left}, {right}: both images are the same; give the left and the right imager's")
    if min(images[0].shape) < SMALLEST_SIDE_PX:
        raise InputError(
            f"{left}: {_size(images[0])} is too small; give at least {SMALLEST_SIDE_PX}x{SMALLEST_SIDE_PX}"
        )
    deep = [image for image in images if image.dtype == np.uint16]
    if not deep:
        return images[0], images[1], ""
    largest = max(int(image.max()) for image in deep)  # both of a pair hold the same number of bits
    drop = 0 if largest < 2**8 else Y10_BITS - 8
    eight = [(image >> drop if image.dtype == np.uint16 else image).astype(np.uint8) for image in images]
    how = f"values up to {largest} in 16 bits: {'scaled from 10 bits to 8' if drop else 'taken as 8 bits'}"
    return eight[0], eight[1], how


def read_reference(path: Path, pair_shape: tuple[int, ...], unit: float = 1 / MM) -> ReferenceDepth:
    """16-bit depth in steps of `unit` [m], or a picture in jet colours whose black is a hole; alpha is dropped."""
    image = _without_alpha(_read(path))
    h, w = pair_shape
    sizes = {(h, w): 1, (h // 2, w // 2): 2}
    if image.shape[:2] not in sizes:
        raise InputError(f"{path}: the reference is {_size(image)}; give {w}x{h} or {w // 2}x{h // 2}, as the pair")
    factor = sizes[image.shape[:2]]
    if image.dtype == np.uint16 and image.ndim == 2:
        return ReferenceDepth(image * unit, True, factor)
    if image.dtype == np.uint8 and image.ndim == 3:
        return ReferenceDepth(_jet_position(image), False, factor)
    raise InputError(f"{path}: neither 16-bit depth nor a colour picture; give the camera's depth as a 16-bit PNG")


def _read_infrared(path: Path) -> UInt8[np.ndarray, "h w"] | UInt16[np.ndarray, "h w"]:
    image = _without_alpha(_read(path))
    if image.ndim == 3:
        raise InputError(f"{path}: a colour image; give the infrared one")
    if image.dtype == np.uint16 and image.max() >= 2**Y10_BITS:
        raise InputError(f"{path}: holds {image.max()}, more than 10 bits a pixel; give the 8-bit infrared stream (Y8)")
    if image.dtype not in (np.uint8, np.uint16):
        raise InputError(f"{path}: {8 * image.dtype.itemsize} bits a pixel; give the 8-bit infrared stream (Y8)")
    return np.ascontiguousarray(image)


def _without_alpha(image: np.ndarray) -> np.ndarray:
    """The image (h, w, 3) without its alpha, or (h, w) where its channels are equal."""
    if image.ndim == 2:
        return image
    colours = image[..., :3]
    return colours[..., 0] if np.all(colours == colours[..., :1]) else colours


def _read(path: Path) -> np.ndarray:
    try:
        return read_png(path)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; give a PNG image") from None
    except (OSError, ValueError, cv2.error):
        raise InputError(f"{path}: cannot be read as an image; give a PNG image") from None


def _jet_position(picture: UInt8[np.ndarray, "h w 3"]) -> Float[np.ndarray, "h w"]:
    """Place of every pixel's colour along OpenCV's jet map, in (0, 1]; 0 where the picture is black."""
    steps = np.arange(256, dtype=np.uint8)[:, None]
    jet = np.asarray(cv2.applyColorMap(steps, cv2.COLORMAP_JET))[:, 0, ::-1].astype(np.float32)
    flat = picture.reshape(-1, 3)
    colours, inverse = np.unique(flat, axis=0, return_inverse=True)
    distance = np.linalg.norm(colours[:, None].astype(np.float32) - jet[None], axis=-1)
    nearest = (np.argmin(distance, axis=1) + 1) / 256
    return np.where(np.any(flat > 0, axis=1), nearest[inverse.ravel()], 0.0).reshape(picture.shape[:2])


def _size(image: np.ndarray) -> str:
    return f"{image.shape[1]}x{image.shape[0]}"
