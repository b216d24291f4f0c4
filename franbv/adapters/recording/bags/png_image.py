"""A grey PNG image decoded within bounds: depth in ROS and librealsense recordings comes as 16-bit PNG.

ISO/IEC 15948 (w3.org/TR/png): the file's chunks, zlib, and five filters that predict a byte from its neighbours. Only
what depth images use: grey, 8 or 16 bits, not interlaced.
"""

import struct
import zlib

import numpy as np

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
HEADER_CHUNK = struct.Struct(">IIBBBBB")
"""Width, height [px], bits, kind of colour, compression, filter, interlace."""
MOST_PNG_PIXELS = 4096 * 4096
"""Choice: ten times those of any depth camera; what says more is damaged."""


def png_image(data: bytes) -> np.ndarray:
    """The image (h, w), uint8 or uint16; ValueError for anything else, and before memory is taken for it."""
    if data[:8] != PNG_SIGNATURE:
        raise ValueError("no PNG image")
    header, packed, at = b"", [], 8
    while at + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8 : at + 8 + length]
        if data[at + 8 + length : at + 12 + length] != struct.pack(">I", zlib.crc32(kind + body)):
            raise ValueError("a PNG image that is damaged")
        if kind == b"IHDR":
            header = body
        elif kind == b"IDAT":
            packed.append(body)
        elif kind == b"IEND":
            return _pixels(header, b"".join(packed))
        at += 12 + length
    raise ValueError("a PNG image without its end")


def _pixels(header: bytes, packed: bytes) -> np.ndarray:
    if len(header) != HEADER_CHUNK.size:
        raise ValueError("a PNG image without its header")
    width, height, bits, *kinds = HEADER_CHUNK.unpack(header)
    if bits not in (8, 16) or any(kinds):
        raise ValueError("a PNG image that is not grey of 8 or 16 bits")
    if not 0 < width * height <= MOST_PNG_PIXELS:
        raise ValueError(f"a PNG image of {width} x {height} px")
    step = bits // 8
    size = height * (1 + width * step)
    unpacker = zlib.decompressobj()
    try:
        raw = unpacker.decompress(packed, size)
    except zlib.error as error:
        raise ValueError(f"a PNG image that is damaged ({error})") from error
    if len(raw) != size:
        raise ValueError("a PNG image with too few pixels")
    rows = np.frombuffer(raw, np.uint8).reshape(height, 1 + width * step)
    image = _unfiltered(rows[:, 0], rows[:, 1:], step)
    return image if bits == 8 else image.view(">u2").astype(np.uint16)


def _unfiltered(filters: np.ndarray, coded: np.ndarray, step: int) -> np.ndarray:
    """Bytes (h, w step) with the prediction added back, row by row; step: bytes of a pixel."""
    image = np.zeros(coded.shape, np.uint8)
    above = np.zeros(coded.shape[1], np.uint8)
    for k, (kind, row) in enumerate(zip(filters.tolist(), coded, strict=True)):
        if kind == 0:
            image[k] = row
        elif kind == 1:  # the sum along the row, for each byte of a pixel
            image[k] = np.cumsum(row.reshape(-1, step), axis=0, dtype=np.uint8).ravel()
        elif kind == 2:
            image[k] = row + above
        elif kind in (3, 4):
            image[k] = _predicted_from_both(row.tolist(), above.tolist(), step, paeth=kind == 4)
        else:
            raise ValueError(f"a PNG image with filter {kind}")
        above = image[k]
    return image


def _predicted_from_both(row: list[int], above: list[int], step: int, paeth: bool) -> list[int]:
    """A row whose bytes are predicted from those at the left and above."""
    out = [0] * step + row
    up = [0] * step + above
    for i in range(step, len(out)):
        left, over, corner = out[i - step], up[i], up[i - step]
        if paeth:
            toward = left + over - corner
            from_left, from_over, from_corner = abs(toward - left), abs(toward - over), abs(toward - corner)
            guess = left if from_left <= min(from_over, from_corner) else over if from_over <= from_corner else corner
        else:
            guess = (left + over) // 2
        out[i] = (out[i] + guess) & 0xFF
    return out[step:]
