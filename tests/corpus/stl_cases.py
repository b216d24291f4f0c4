"""STL files of the corpus."""

import struct

from tests.corpus import stl_writer
from tests.corpus.solids import ANGLE, BASE, KNOB
from tests.corpus.table import Case, truth

TWO = {"base plate": truth(BASE), "knob": truth(KNOB)}


def _text(*solids: str) -> bytes:
    return "".join(solids).encode()


def _two(**last: bool) -> str:
    return stl_writer.text(BASE, "base plate") + stl_writer.text(KNOB, "knob", **last)


def _with_nan() -> bytes:
    data = bytearray(stl_writer.binary(ANGLE))
    data[84 + 12 : 84 + 16] = struct.pack("<f", float("nan"))
    return bytes(data)


def _stl(file: str, trouble: str, make, **what) -> Case:
    return Case(f"{file}.stl", trouble, make, units="mm", **what)


STL_CASES = (
    _stl("binary", "plain", lambda: stl_writer.binary(ANGLE, b"made"), bodies={"binary": truth(ANGLE)}),
    _stl(
        "binary_says_solid",
        "the header of a binary file begins like a text file",
        lambda: stl_writer.binary(ANGLE, b"solid made by CAD"),
        bodies={"binary_says_solid": truth(ANGLE)},
    ),
    _stl(
        "binary_latin1_header",
        "the header is no UTF-8",
        lambda: stl_writer.binary(ANGLE, "Körper Ø40".encode("latin-1")),
        bodies={"binary_latin1_header": truth(ANGLE)},
    ),
    _stl(
        "binary_after_binary",
        "two files one after another",
        lambda: stl_writer.binary(BASE) + stl_writer.binary(KNOB),
        bodies={"binary_after_binary": truth(BASE), "binary_after_binary_1": truth(KNOB)},
    ),
    _stl(
        "binary_padded",
        "zeros behind the last triangle",
        lambda: stl_writer.binary(ANGLE) + b"\0" * 428,
        bodies={"binary_padded": truth(ANGLE)},
        notices=("428 bytes without content follow the last triangle",),
    ),
    _stl(
        "binary_count_high",
        "the header counts more than the file has",
        lambda: stl_writer.binary(ANGLE, count=2**31),
        refusal="the file is cut off after 20 of 2147483648 triangles",
    ),
    _stl(
        "binary_count_low",
        "the header counts less than the file has",
        lambda: stl_writer.binary(ANGLE, count=7),
        refusal="bytes follow after the last of the triangles that the header counts",
    ),
    _stl(
        "binary_count_zero",
        "the header counts nothing",
        lambda: stl_writer.binary(ANGLE, count=0),
        refusal="the header counts 0 triangles, but 20 follow",
    ),
    _stl(
        "binary_cut",
        "cut off",
        lambda: stl_writer.binary(ANGLE)[:-77],
        refusal="the file is cut off after 18 of 20 triangles",
    ),
    _stl("binary_nan", "a corner is no number", _with_nan, refusal="vertices that are not finite numbers"),
    _stl("text", "plain", lambda: _text(stl_writer.text(ANGLE, "angle")), bodies={"text": truth(ANGLE)}),
    _stl(
        "text_capitals_crlf",
        "capitals, line ends of another system, no name",
        lambda: stl_writer.text(ANGLE).upper().replace("\n", "\r\n").encode(),
        bodies={"text_capitals_crlf": truth(ANGLE)},
    ),
    _stl(
        "text_latin1_name",
        "the name is no UTF-8",
        lambda: stl_writer.text(ANGLE, "Körper Ø40").encode("latin-1"),
        bodies={"text_latin1_name": truth(ANGLE)},
    ),
    _stl("text_two_solids", "several solids", lambda: _text(_two()), bodies=TWO),
    _stl(
        "text_same_names",
        "two solids of one name",
        lambda: _text(stl_writer.text(BASE, "bolt"), stl_writer.text(KNOB, "bolt")),
        bodies={"bolt": truth(BASE), "bolt_1": truth(KNOB)},
    ),
    _stl(
        "text_no_endsolid",
        "the last line is missing",
        lambda: _text(_two(end=False)),
        bodies=TWO,
        notices=("solid knob has no `endsolid`",),
    ),
    _stl(
        "text_no_endsolid_between",
        "the line between two solids is missing",
        lambda: _text(stl_writer.text(BASE, "base plate", end=False), stl_writer.text(KNOB, "knob")),
        bodies=TWO,
        notices=("solid base plate has no `endsolid`",),
    ),
    _stl(
        "text_empty_solid",
        "a solid without facets",
        lambda: _text(stl_writer.text(ANGLE, "angle"), "solid knob\nendsolid knob\n"),
        bodies={"text_empty_solid": truth(ANGLE)},
        notices=("solid knob has no facets",),
    ),
    _stl(
        "text_other_end",
        "a solid that ends under the name of another, as the end of one and the start of the next are missing",
        lambda: _text(stl_writer.text(BASE, "base plate", end=False), "endsolid knob\n"),
        bodies={"text_other_end": truth(BASE)},
        notices=("solid base plate ends as knob",),
    ),
    _stl(
        "text_cut_in_second",
        "cut off in its second solid",
        lambda: _text(_two())[:-400],
        refusal="of solid knob is incomplete or garbled",
    ),
    _stl(
        "text_infinite",
        "a coordinate is infinite",
        lambda: _text(stl_writer.text(ANGLE, "angle")).replace(b"vertex 40 10 20", b"vertex inf 10 20", 1),
        refusal="vertices that are not finite numbers",
    ),
    _stl(
        "text_comma",
        "decimal commas",
        lambda: _text(stl_writer.text(ANGLE, "angle")).replace(b"vertex 40 10 20", b"vertex 40,0 10 20", 1),
        refusal="40,0 in facet 1 of solid angle is no number",
    ),
)
