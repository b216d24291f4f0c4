"""STL, binary or text: every solid is a body; what is cut off, miscounted or garbled is refused with its place.

The format's word is the counter at byte 80 of the binary kind (3D Systems, StereoLithography Interface
Specification, 1989), and `solid`, `facet`, `vertex`, `endsolid` of the other.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from scenes.cad.cad_file import (
    CadFile,
    RawBody,
    check_triangle_count,
    damaged,
    distinct_names,
    file_stem,
    plain_text,
    shown,
)

HEADER_BYTES, TRIANGLE_BYTES = 84, 50
"""Bytes before the first triangle, and of each."""
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
FACET = [
    *("facet", "normal", "0", "0", "0", "outer", "loop"),
    *(3 * ("vertex", "0", "0", "0")),
    *("endloop", "endfacet"),
]
"""The words of one facet; zeros stand for numbers."""
FACET_WORDS = [i for i, word in enumerate(FACET) if word != "0"]
FACET_NUMBERS = [i for i in range(8, 20) if i not in FACET_WORDS]
"""Where a facet has its corners; the normal is not used."""
FILLING = b"\0 \t\r\n"
"""Bytes that may follow the last triangle: writers fill up blocks with them."""
LONGEST_WORD = 64
"""Characters (choice: the longest number that a double can need has 25; bounds the memory of the table of words)."""
_SOLID_LINE = re.compile(rb"^[ \t]*(end)?solid(?![^\s])([^\n]*)$", re.IGNORECASE | re.MULTILINE)
_CUT_OFF = "the file is cut off"


def read_stl_file(path: Path, data: bytes) -> CadFile:
    """The solids of an STL file."""
    solids, notices = _binary_solids(path, data)
    if solids is None:
        solids, notices = _text_solids(path, data)
    names = distinct_names([name for name, _ in solids])
    bodies = [
        RawBody(name, corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
        for name, (_, corners) in zip(names, solids, strict=True)
        if len(corners)
    ]
    check_triangle_count(path, sum(len(body.faces) for body in bodies))
    return CadFile(tuple(bodies), tuple(notices))


def _binary_solids(path: Path, data: bytes) -> tuple[list[tuple[str, np.ndarray]] | None, list[str]]:
    """Name and corners (n, 3, 3) of each solid, and notices; None if the file is text.

    Some tools set files one after another.
    """
    solids = []
    at = 0
    while data[at:].strip(FILLING):
        count = int.from_bytes(data[at + 80 : at + HEADER_BYTES], "little")
        end = at + HEADER_BYTES + TRIANGLE_BYTES * count
        if at + HEADER_BYTES > len(data) or end > len(data) or (count == 0 and end < len(data)):
            if not solids and _is_text(data):
                return None, []
            raise damaged(path, _miscounted(len(data), at, count, bool(solids)))
        triangles = np.frombuffer(data, TRIANGLE, count, at + HEADER_BYTES)
        solids.append((file_stem(path), triangles["corners"].astype(float)))
        at = end
    left = f"{len(data) - at} bytes without content follow the last triangle; if it was cut off there, export it again"
    return solids, [left] if at < len(data) else []


def _miscounted(size: int, at: int, count: int, follows: bool) -> str:
    """In words: what the header at byte `at` announces, and what the file holds."""
    held = max(size - at - HEADER_BYTES, 0) / TRIANGLE_BYTES
    if follows:
        return f"{size - at} bytes follow after the last of the triangles that the header counts, at byte {at}"
    if size < HEADER_BYTES:
        return f"{_CUT_OFF} in its header: {size} of {HEADER_BYTES} bytes"
    if count == 0:
        return f"the header counts 0 triangles, but {held:.4g} follow"
    return f"{_CUT_OFF} after {int(held)} of {count} triangles, at byte {size}"


def _is_text(data: bytes) -> bool:
    """Whether this is the text kind: `solid` at its start and no zero byte, which binary numbers cannot do without."""
    return data[:512].lstrip(b"\xef\xbb\xbf \t\r\n")[:5].lower() == b"solid" and b"\0" not in data


def _text_solids(path: Path, data: bytes) -> tuple[list[tuple[str, np.ndarray]], list[str]]:
    data = data.removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    check_triangle_count(path, data.count(b"\n") // 7)
    solids: list[tuple[str, np.ndarray]] = []
    notices = []
    for name, body, end in _blocks(path, data):
        corners = _corners(path, name, body)
        if end is None and not len(corners):
            raise damaged(path, f"{_CUT_OFF} at the start of solid {shown(name)}")
        notices += _doubts(name, end, len(corners))
        solids.append((name, corners))
    if not any(len(corners) for _, corners in solids):
        return solids, []  # refused as a whole
    return solids, notices


def _doubts(name: str, end: str | None, facets: int) -> list[str]:
    """Notices on a solid that does not end as it should, which is how a lost piece shows."""
    if end is None:
        return [f"solid {shown(name)} has no `endsolid`; if the file was cut off there, export it again"]
    if not facets:
        return [f"solid {shown(name)} has no facets; export it again if something is missing"]
    if end and not name.lower().startswith(end.lower()):
        return [f"solid {shown(name)} ends as {shown(end)}; export it again if a solid is missing"]
    return []


def _blocks(path: Path, data: bytes) -> Iterator[tuple[str, bytes, str | None]]:
    """Name of every solid, the words between `solid` and `endsolid`, and the name behind the latter, None without."""
    lines = list(_SOLID_LINE.finditer(data))
    opened: re.Match[bytes] | None = None
    outside = 0
    for line in lines:
        if line[1] is None:
            if opened is not None:
                yield _name(path, opened), data[opened.end() : line.start()], None
            else:
                _nothing_between(path, data, outside, line.start())
            opened = line
        elif opened is None:
            raise damaged(path, f"`endsolid` without `solid` in line {_line(data, line.start())}")
        else:
            yield (
                _name(path, opened),
                data[opened.end() : line.start()],
                plain_text(line[2] if opened[2].strip() else b"").strip(),
            )
            opened, outside = None, line.end()
    if opened is not None:
        yield _name(path, opened), data[opened.end() :], None
    else:
        _nothing_between(path, data, outside, len(data))


def _nothing_between(path: Path, data: bytes, start: int, end: int) -> None:
    """InputError for words between one solid and the next, or behind the last."""
    words = data[start:end].split(maxsplit=1)
    if words:
        line = _line(data, start + data[start:end].index(words[0]))
        raise damaged(path, f"{shown(plain_text(words[0]))} in line {line} is outside of any solid")


def _corners(path: Path, name: str, body: bytes) -> np.ndarray:
    """Corners (n, 3, 3) of the facets of a solid."""
    words = body.split()
    whole, rest = divmod(len(words), len(FACET))
    if max(map(len, words), default=0) > LONGEST_WORD:
        raise damaged(path, f"solid {shown(name)} has a word of more than {LONGEST_WORD} letters")
    table = np.array(words[: whole * len(FACET)], bytes).reshape(-1, len(FACET))
    wrong = (np.char.lower(table[:, FACET_WORDS]) != np.array(FACET, bytes)[FACET_WORDS]).any(axis=1)
    first = int(np.argmax(wrong)) if wrong.any() else whole
    if first < whole or rest:
        place = f"facet {first + 1} of solid {shown(name)}"
        raise damaged(path, f"{place} is incomplete or garbled; {_CUT_OFF} or damaged there")
    try:
        return table[:, FACET_NUMBERS].astype(float).reshape(-1, 3, 3)
    except ValueError:
        raise damaged(path, _no_number(name, table[:, FACET_NUMBERS])) from None


def _no_number(name: str, table: np.ndarray) -> str:
    """Where the first word stands that is no number."""
    for number, row in enumerate(table, start=1):
        for word in row:
            try:
                float(word)
            except ValueError:
                text = shown(plain_text(bytes(word)))
                return f"{text} in facet {number} of solid {shown(name)} is no number"
    return f"a corner of solid {shown(name)} is no number"


def _name(path: Path, line: re.Match[bytes]) -> str:
    return plain_text(line[2]).strip() or file_stem(path)


def _line(data: bytes, at: int) -> int:
    return data.count(b"\n", 0, at) + 1
