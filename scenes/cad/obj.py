"""Wavefront OBJ: polygons on numbered vertices; each `o` opens a body.

Negative indices count back from the vertices read so far (Wavefront, Advanced Visualizer manual, appendix B1); trimesh
counts from the end of the file (its issue 2364).
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from scenes.cad.cad_file import (
    CadFile,
    RawBody,
    check_triangle_count,
    damaged,
    file_stem,
    one_line,
    plain_text,
    shown,
    unused,
    used_only,
)
from scenes.cad.polygons import triangulated

WITHOUT_SHAPE = {
    "vt", "vn", "vp", "g", "s", "usemtl", "mtllib", "usemap", "maplib", "mg", "lod", "l", "p", "bevel", "c_interp",
    "d_interp", "shadow_obj", "trace_obj",
}  # fmt: skip
"""Statements that change nothing about a surface of polygons."""
FREE_FORM = {
    "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp", "end", "con",
    "ctech", "stech", "bzp", "bsp", "cdc", "cdp", "res",
}  # fmt: skip
"""Statements of free-form curves and surfaces."""


@dataclass
class _Polygons:
    """Of one object: vertex numbers from 0 on, corners of each polygon, and its line."""

    corners: list[int] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)


@dataclass
class _Content:
    """Of a file."""

    coordinates: list[tuple[float, float, float]] = field(default_factory=list)
    objects: dict[str, _Polygons] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    """What was not understood, in words, and the line of the first."""


def read_obj_file(path: Path, data: bytes) -> CadFile:
    """The objects of an OBJ file; an object that is taken up again under its name is one body."""
    if b"\0" in data:
        raise damaged(path, f"it is no text: byte {data.index(0)} is zero")
    content = _Content()
    current = content.objects.setdefault("", _Polygons())
    for number, words in _statements(data):
        word = words[0]
        if word == "v":
            content.coordinates.append(_vertex(path, number, words))
        elif word in ("f", "fo"):  # `fo` is what `f` was called before
            current.corners += _corners(path, number, words, len(content.coordinates))
            current.counts.append(len(words) - 1)
            current.lines.append(number)
        elif word == "o":
            current = content.objects.setdefault(one_line(" ".join(words[1:])), _Polygons())
        elif word not in WITHOUT_SHAPE:
            content.left_out.setdefault(_left_out(word), number)
    vertices = np.array(content.coordinates, float).reshape(-1, 3)
    bodies = [
        _body(path, name or file_stem(path), polygons, vertices)
        for name, polygons in content.objects.items()
        if polygons.counts
    ]
    check_triangle_count(path, sum(len(body.faces) for body in bodies))
    notices = tuple(
        f"line {line}: {what}; export the solid as a mesh if something is missing"
        for what, line in content.left_out.items()
    )
    if bodies and not current.counts:
        notices += ("it ends in an object without a face; if it was cut off there, export it again",)
    if bodies:
        notices += unused(len(vertices), [corner for each in content.objects.values() for corner in each.corners])
    return CadFile(tuple(bodies), notices, points=len(vertices) > 0)


def _statements(data: bytes):
    """Number of the first line and words of every statement; a backslash at a line's end goes on in the next."""
    text = plain_text(data).removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    lines = iter(enumerate(text.split("\n"), start=1))
    for number, line in lines:
        pieces = [line]
        while pieces[-1].endswith("\\"):
            pieces[-1] = pieces[-1][:-1]
            pieces.append(next(lines, (0, ""))[1])
        words = " ".join(pieces).partition("#")[0].split()
        if words:
            yield number, words


def _vertex(path: Path, number: int, words: list[str]) -> tuple[float, float, float]:
    try:
        return float(words[1]), float(words[2]), float(words[3])
    except (IndexError, ValueError):
        raise damaged(path, f"line {number}: {shown(' '.join(words))} is no vertex with three numbers") from None


def _corners(path: Path, number: int, words: list[str], known: int) -> list[int]:
    """Vertex numbers from 0 on of a face; `known` vertices came before it."""
    corners = []
    for word in words[1:]:
        try:
            index = int(word.partition("/")[0])
        except ValueError:
            index = 0
        if index == 0 or index < -known:
            raise damaged(path, f"line {number}: {shown(word)} is no vertex of a face; {known} come before it")
        corners.append(index - 1 if index > 0 else known + index)
    if len(corners) < 3:
        raise damaged(path, f"line {number}: a face with {len(corners)} corners")
    return corners


def _body(path: Path, name: str, polygons: _Polygons, vertices: np.ndarray) -> RawBody:
    corners, counts = np.array(polygons.corners, np.int64), np.array(polygons.counts, np.int64)
    if corners.max() >= len(vertices):
        face = int(np.searchsorted(np.cumsum(counts), np.argmax(corners >= len(vertices)), side="right"))
        last = corners.max() + 1
        raise damaged(
            path, f"line {polygons.lines[face]}: vertex {last} of a face, but the file has {len(vertices)} vertices"
        )
    faces, _ = triangulated(
        vertices,
        corners,
        counts,
        lambda polygon, why: damaged(
            path, f"line {polygons.lines[polygon]}: a face cannot be cut into triangles: {why}"
        ),
    )
    return RawBody(name, *used_only(vertices, faces))


def _left_out(word: str) -> str:
    if word in FREE_FORM:
        return "free-form curves and surfaces (`cstype`) are left out"
    return f"the statement `{shown(word)}` is not known and left out"
