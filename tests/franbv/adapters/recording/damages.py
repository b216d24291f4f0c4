"""Damaged copies of a recording: cut off, bits flipped, chunks in the wrong order, sizes that are not there."""

import struct
import zlib
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import zstandard

MAGIC_SIZE, RECORD_HEAD_SIZE = 8, 9
CHUNK = 6
"""Opcode of MCAP's chunks."""
HUGE = (2**31 - 1, 2**32 - 1, 2**40, 2**63 - 1, 2**64 - 1)


class Damage(NamedTuple):
    """What was done, and the damaged file."""

    words: str
    data: bytes


def records(data: bytes) -> list[tuple[int, int, int]]:
    """(opcode, begin, end) of every record at the file's top."""
    found, at = [], MAGIC_SIZE
    while at + RECORD_HEAD_SIZE <= len(data) - MAGIC_SIZE:
        opcode, length = struct.unpack_from("<BQ", data, at)
        found.append((opcode, at, at + RECORD_HEAD_SIZE + length))
        at = found[-1][2]
    return found


def chunks(data: bytes) -> tuple[bytes, list[bytes], bytes]:
    """The file before its chunks, each chunk without its index, and nothing else: a file without an end."""
    parts = [data[begin:end] for opcode, begin, end in records(data) if opcode == CHUNK]
    return data[: records(data)[0][2]], parts, b""


def cut(data: bytes, rng: np.random.Generator) -> Damage:
    """Anywhere."""
    at = int(rng.integers(0, len(data)))
    return Damage(f"cut at {at}", data[:at])


def flipped(data: bytes, rng: np.random.Generator) -> Damage:
    """One to eight bits, anywhere."""
    changed, places = bytearray(data), rng.integers(0, 8 * len(data), rng.integers(1, 9)).tolist()
    for place in places:
        changed[place // 8] ^= 1 << place % 8
    return Damage(f"bits {places}", bytes(changed))


def shuffled(data: bytes, rng: np.random.Generator) -> Damage:
    """Chunks moved, doubled or left out; without an end, so that no checksum over all of them speaks of it."""
    head, parts, _ = chunks(data)
    how = rng.integers(3)
    k, other = rng.integers(0, len(parts), 2).tolist()
    if how == 0:
        parts[k], parts[other] = parts[other], parts[k]
    elif how == 1:
        parts.insert(other, parts[k])
    else:
        del parts[k]
    return Damage(f"{('swapped', 'doubled', 'left out')[how]} {k} {other}", head + b"".join(parts))


def oversized(data: bytes, rng: np.random.Generator) -> Damage:
    """A length that claims far more than is there: of a record, of a chunk unpacked, of a chunk's content."""
    changed = bytearray(data)
    opcode, begin, _ = records(data)[int(rng.integers(len(records(data))))]
    size = int(rng.choice(np.array(HUGE, np.uint64)))
    offset = begin + 1
    if opcode == CHUNK:
        offset = begin + RECORD_HEAD_SIZE + int(rng.choice([-8, 16, 28]))
    struct.pack_into("<Q", changed, offset, size)
    end = len(changed) - MAGIC_SIZE * int(rng.integers(2))
    return Damage(f"{size} at {offset}, {len(changed) - end} bytes less", bytes(changed[:end]))


def rewritten(data: bytes, rng: np.random.Generator) -> Damage:
    """A number inside a message is another one, and chunk and checksum are made to fit: no checksum tells."""
    head, parts, _ = chunks(data)
    k = int(rng.integers(len(parts)))
    body = parts[k][RECORD_HEAD_SIZE:]
    start, stop, size, _, length = struct.unpack_from("<QQQII", body)
    packed = body[32 + length + 8 :]
    inner = bytearray(zstandard.decompress(packed, max_output_size=size))
    digits = [i for i, value in enumerate(inner) if 48 <= value <= 57]
    at = digits[int(rng.integers(len(digits)))]
    inner[at] = int(rng.choice(list(b'0123456789-.eNa"}')))
    again = zstandard.compress(bytes(inner))
    new = struct.pack("<QQQII", start, stop, len(inner), zlib.crc32(inner), 4) + b"zstd" + struct.pack("<Q", len(again))
    parts[k] = struct.pack("<BQ", CHUNK, len(new) + len(again)) + new + again
    return Damage(f"byte {at} of chunk {k} is {chr(inner[at])}", head + b"".join(parts))


KINDS_OF_DAMAGE: tuple[Callable[[bytes, np.random.Generator], Damage], ...] = (
    cut,
    flipped,
    shuffled,
    oversized,
    rewritten,
)


def damaged(data: bytes, n: int, seed: int) -> Iterator[Damage]:
    """n damaged copies, of each kind as many."""
    rng = np.random.default_rng(seed)
    for k in range(n):
        damage = KINDS_OF_DAMAGE[k % len(KINDS_OF_DAMAGE)]
        words, changed = damage(data, rng)
        yield Damage(f"{damage.__name__}: {words}", changed)
