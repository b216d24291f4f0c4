"""16-bit PNG against OpenCV's encoder, every filter of the format, and images that lie about themselves."""

import struct
import zlib

import cv2
import numpy as np
import pytest

from franbv.adapters.recording.bags.png_image import png_image

RNG = np.random.default_rng(0)
FILTERS = range(5)
"""None, sub, up, average, Paeth."""


def chunk(kind: bytes, body: bytes) -> bytes:
    """A chunk of the format."""
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png_file(width: int, height: int, bits: int, raw: bytes, colour: int = 0, interlace: int = 0) -> bytes:
    """A file around filtered rows."""
    header = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, interlace)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def filtered(image: np.ndarray, kinds: list[int]) -> bytes:
    """Rows coded by the formulas of the standard, section 9, byte by byte."""
    step, coded = image.dtype.itemsize, image.astype(image.dtype.newbyteorder(">")).view(np.uint8).astype(int)
    out = []
    for y, kind in enumerate(kinds):
        out.append(kind)
        for x in range(coded.shape[1]):
            a = coded[y, x - step] if x >= step else 0
            b = coded[y - 1, x] if y else 0
            c = coded[y - 1, x - step] if y and x >= step else 0
            p = a + b - c
            nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            out.append((coded[y, x] - (0, a, b, (a + b) // 2, nearest)[kind]) % 256)
    return bytes(out)


@pytest.mark.parametrize("kind", FILTERS)
@pytest.mark.parametrize("bits", [np.uint8, np.uint16])
def test_every_filter_is_undone(kind: int, bits: type):
    """Random images coded row by row by the standard's own formulas."""
    image = RNG.integers(0, np.iinfo(bits).max, (7, 9), endpoint=True).astype(bits)
    found = png_image(png_file(9, 7, 8 * image.itemsize, filtered(image, [kind] * 7)))
    assert found.dtype == bits
    assert np.array_equal(found, image)


@pytest.mark.parametrize("strategy", range(5))
def test_images_of_another_encoder_are_read(strategy: int):
    """OpenCV's (libpng's), by each of its strategies, on smooth depth with holes."""
    v, u = np.mgrid[:48, :64]
    image = (300 + 3 * u + 2 * v + RNG.integers(0, 5, (48, 64))).astype(np.uint16) * (RNG.random((48, 64)) > 0.1)
    data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_STRATEGY, strategy])[1].tobytes()
    assert np.array_equal(png_image(data), image)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"no image", "no PNG"),
        (png_file(100_000, 100_000, 16, b""), "100000 x 100000"),
        (png_file(4, 4, 16, bytes(9)), "too few pixels"),
        (png_file(4, 4, 16, bytes(36), colour=2), "not grey"),
        (png_file(4, 4, 16, bytes(36), interlace=1), "not grey"),
        (png_file(4, 4, 16, bytes([9, *bytes(8)]) * 4), "filter 9"),
        (png_file(4, 4, 16, bytes(36))[:-12], "without its end"),
        (png_file(4, 4, 16, bytes(36)).replace(b"IDAT", b"IDAU"), "damaged"),
    ],
)
def test_an_image_that_lies_is_refused(data: bytes, words: str):
    """ValueError with the reason, and before memory is taken for a size that is only said."""
    with pytest.raises(ValueError, match=words):
        png_image(data)


def test_a_bomb_is_not_unpacked():
    """Data that would unpack to far more than the image has pixels is cut off at the image's size."""
    raw = bytes(36) + bytes(50_000_000)
    assert np.array_equal(png_image(png_file(4, 4, 16, raw)), np.zeros((4, 4), np.uint16))
