"""PLY (Turk, The PLY Polygon File Format, 1994), text and both byte orders: one body of polygons on vertices."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenes.cad.cad_file import (
    CadFile,
    RawBody,
    check_triangle_count,
    damaged,
    file_stem,
    plain_text,
    shown,
    unused,
    used_only,
)
from scenes.cad.ply_header import Element, Header, read_header
from scenes.cad.polygons import triangulated

CORNER_LISTS = ("vertex_indices", "vertex_index")
"""Names that writers give to the corners of a face."""


@dataclass(frozen=True, eq=False)
class ElementRows:
    """The values of an element."""

    scalars: dict[str, np.ndarray]
    """One value a row, by property."""
    lists: dict[str, tuple[np.ndarray, np.ndarray]]
    """By property: all values one after another, and how many of them each row has."""


def read_ply_file(path: Path, data: bytes) -> CadFile:
    """The polygons of a PLY file."""
    header = read_header(path, data)
    reader = _TextReader(path, data[header.end :]) if header.order is None else _BinaryReader(path, data, header)
    rows = {element.name: reader.rows(element) for element in header.elements}
    reader.check_end()
    if "tristrips" in rows and len(rows["tristrips"].lists.get("vertex_indices", ((), ()))[1]):
        raise damaged(path, "it holds triangle strips, which are not read; write faces instead")
    vertex, face = rows.get("vertex"), rows.get("face")
    if vertex is None or not all(axis in vertex.scalars for axis in "xyz"):
        raise damaged(path, "the header has no element `vertex` with x, y and z")
    vertices = np.column_stack([vertex.scalars[axis].astype(float) for axis in "xyz"])
    corner_list = next((face.lists[name] for name in CORNER_LISTS if name in face.lists), None) if face else None
    if corner_list is None or not len(corner_list[1]):
        return CadFile((), points=len(vertices) > 0)
    corners, counts = _whole(path, corner_list[0]), corner_list[1]
    _check_faces(path, corners, counts, len(vertices))
    faces, _ = triangulated(
        vertices,
        corners,
        counts,
        lambda face, why: damaged(path, f"face {face} cannot be cut into triangles: {why}"),
    )
    check_triangle_count(path, len(faces))
    body = RawBody(file_stem(path), *used_only(vertices, faces))
    return CadFile((body,), unused(len(vertices), corners))


def _whole(path: Path, values: np.ndarray) -> np.ndarray:
    """The values as int64; InputError unless they are whole numbers."""
    if values.dtype.kind == "f" and not np.all(np.isfinite(values) & (values == np.round(values))):
        raise damaged(path, "a face names vertices in fractions")
    return values.astype(np.int64)


def _check_faces(path: Path, corners: np.ndarray, counts: np.ndarray, known: int) -> None:
    short = np.flatnonzero(counts < 3)
    if len(short):
        raise damaged(path, f"face {short[0]} has {counts[short[0]]} corners")
    wrong = np.flatnonzero((corners < 0) | (corners >= known))
    if len(wrong):
        face = int(np.searchsorted(np.cumsum(counts), wrong[0], side="right"))
        raise damaged(path, f"face {face} names vertex {corners[wrong[0]]}, but there are {known}, from 0 on")


class _TextReader:
    """Takes the elements of a text file off its lines, one a row."""

    def __init__(self, path: Path, body: bytes) -> None:
        self.path = path
        self.lines = [words for words in (line.split() for line in body.splitlines()) if words]
        self.at = 0

    def rows(self, element: Element) -> ElementRows:
        """The values of the next element."""
        left = len(self.lines) - self.at
        if element.count > left:
            raise damaged(self.path, element.cut_off(f"{left} lines are left for them"))
        lines = self.lines[self.at : self.at + element.count]
        self.at += element.count
        scalars: dict[str, list[float]] = {name: [] for name in element.scalars}
        lists: dict[str, tuple[list[float], list[int]]] = {name: ([], []) for name in element.lists}
        for row, words in enumerate(lines):
            values = self._numbers(element, row, words)
            at = 0
            for name, is_list in element.columns:
                count = self._length(element, row, words, at) if is_list else 1
                taken = values[at + is_list : at + is_list + count]
                at += is_list + count
                if is_list:
                    lists[name][0].extend(taken)
                    lists[name][1].append(count)
                else:
                    scalars[name] += taken
            if at != len(words):
                raise damaged(self.path, f"{element.name} {row}: its line has {len(words)} values, not {at}")
        return ElementRows(
            {name: np.array(values, float) for name, values in scalars.items()},
            {name: (np.array(v, float), np.array(counts, np.int64)) for name, (v, counts) in lists.items()},
        )

    def _length(self, element: Element, row: int, words: list[bytes], at: int) -> int:
        """Of the list that begins with word `at`; more than the line has is more than any line has."""
        word = words[at] if at < len(words) else b""
        if not word.isdigit():
            raise damaged(self.path, f"{element.name} {row}: {shown(plain_text(word))} is no count of a list")
        return int(word) if len(word) < 10 else 10**10

    def _numbers(self, element: Element, row: int, words: list[bytes]) -> list[float]:
        try:
            return [float(word) for word in words]
        except ValueError:
            text = shown(plain_text(b" ".join(words[:20])))
            raise damaged(self.path, f"{element.name} {row}: {text}: not all of it are numbers") from None

    def check_end(self) -> None:
        """InputError if lines are left."""
        if self.at < len(self.lines):
            left = len(self.lines) - self.at
            raise damaged(self.path, f"{left} lines follow after all that the header announces")


class _BinaryReader:
    """Takes the elements of a binary file off its bytes, one after another."""

    def __init__(self, path: Path, data: bytes, header: Header) -> None:
        self.path, self.data, self.at = path, data, header.end
        self.order = header.order or "<"

    def rows(self, element: Element) -> ElementRows:
        """The values of the next element."""
        left = len(self.data) - self.at
        if element.count * element.fewest_bytes > left:
            raise damaged(self.path, element.cut_off(f"{left} bytes are left for it"))
        lengths = self._first_lengths(element)
        table = self._table(element, lengths)
        if table is None:
            return self._row_by_row(element)
        self.at += table.nbytes
        scalars = {p.name: table[p.name] for p in element.properties if p.count_type is None}
        lists = {
            p.name: (table[p.name].reshape(-1), table[f"{p.name} count"].astype(np.int64))
            for p in element.properties
            if p.count_type is not None
        }
        return ElementRows(scalars, lists)

    def _first_lengths(self, element: Element) -> dict[str, int]:
        """Lengths of the lists of the first row; most writers use the same in all."""
        lengths: dict[str, int] = {}
        at = self.at
        for item in element.properties:
            if element.count and item.count_type is not None:
                lengths[item.name] = self._number(element, 0, item.count_type, at)
                at += np.dtype(item.count_type).itemsize
            at += np.dtype(item.type).itemsize * lengths.get(item.name, 1)
        return lengths

    def _table(self, element: Element, lengths: dict[str, int]) -> np.ndarray | None:
        """All rows at once, if every list has the length of the first."""
        fields = []
        for item in element.properties:
            if item.count_type is not None:
                fields.append((f"{item.name} count", self.order + item.count_type))
                fields.append((item.name, self.order + item.type, (lengths.get(item.name, 0),)))
            else:
                fields.append((item.name, self.order + item.type))
        row = sum(np.dtype(f[1]).itemsize * (f[2][0] if len(f) == 3 else 1) for f in fields)
        if row * element.count > len(self.data) - self.at:
            return None
        table = np.frombuffer(self.data, np.dtype(fields), element.count, self.at)
        same = all(np.all(table[f"{name} count"] == length) for name, length in lengths.items())
        return table if same else None

    def _row_by_row(self, element: Element) -> ElementRows:
        scalars: dict[str, list[np.ndarray]] = {name: [] for name in element.scalars}
        lists: dict[str, tuple[list[np.ndarray], list[int]]] = {name: ([], []) for name in element.lists}
        for row in range(element.count):
            for item in element.properties:
                count = 1
                if item.count_type is not None:
                    count = self._number(element, row, item.count_type, self.at)
                    self.at += np.dtype(item.count_type).itemsize
                    lists[item.name][1].append(count)
                values = self._values(element, row, item.type, count)
                (scalars[item.name] if item.count_type is None else lists[item.name][0]).append(values)
        return ElementRows(
            {name: np.concatenate(values) for name, values in scalars.items()},
            {name: (np.concatenate(values), np.array(counts, np.int64)) for name, (values, counts) in lists.items()},
        )

    def _number(self, element: Element, row: int, kind: str, at: int) -> int:
        size = np.dtype(kind).itemsize
        if at + size > len(self.data):
            raise damaged(self.path, element.cut_off(f"the file ends in row {row}"))
        count = int(np.frombuffer(self.data, self.order + kind, 1, at)[0])
        if count < 0:
            raise damaged(self.path, f"{element.name} {row} has a list of {count} values")
        return count

    def _values(self, element: Element, row: int, kind: str, count: int) -> np.ndarray:
        size = np.dtype(kind).itemsize * count
        if self.at + size > len(self.data):
            raise damaged(
                self.path, element.cut_off(f"row {row} needs {size} bytes, {len(self.data) - self.at} are left")
            )
        values = np.frombuffer(self.data, self.order + kind, count, self.at)
        self.at += size
        return values

    def check_end(self) -> None:
        """InputError if bytes are left."""
        left = self.data[self.at :]
        if left.strip():
            raise damaged(self.path, f"{len(left)} bytes follow after all that the header announces")
