"""The header of a PLY file: its byte order, its elements and their properties."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenes.cad.cad_file import damaged, plain_text, shown

TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2"},
    **{"int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8"},
}
"""The format's names of numbers -> numpy's."""
ORDERS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}
LONGEST_HEADER = 65536
"""Bytes (choice: a hundred times what writers need)."""

LONGEST_COUNT = 18
"""Digits (choice: what fits 64 bits)."""


@dataclass(frozen=True)
class Property:
    """A column of an element."""

    name: str
    type: str
    count_type: str | None = None
    """Of the length in front of a list; None for one value a row."""


@dataclass(frozen=True)
class Element:
    """A table of a file."""

    name: str
    count: int
    properties: tuple[Property, ...]

    @property
    def fewest_bytes(self) -> int:
        """Of a row."""
        return max(sum(np.dtype(p.count_type or p.type).itemsize for p in self.properties), 1)

    @property
    def columns(self) -> tuple[tuple[str, bool], ...]:
        """Name of each property, and whether it is a list."""
        return tuple((p.name, p.count_type is not None) for p in self.properties)

    @property
    def scalars(self) -> tuple[str, ...]:
        """Names of the properties that have one value a row."""
        return tuple(name for name, is_list in self.columns if not is_list)

    @property
    def lists(self) -> tuple[str, ...]:
        """Names of the properties that are lists."""
        return tuple(name for name, is_list in self.columns if is_list)

    def cut_off(self, what: str) -> str:
        """In words: the file ends inside this element."""
        return f"the file is cut off: the header announces {self.count} rows of `{shown(self.name)}`, but {what}"


@dataclass(frozen=True)
class Header:
    """What the file announces."""

    order: str | None
    """`<` or `>`; None for text."""
    elements: tuple[Element, ...]
    end: int
    """Byte at which the values begin."""


def read_header(path: Path, data: bytes) -> Header:
    """The header; InputError with its line where it breaks the format."""
    lines, end = _lines(path, data)
    order: str | None = ""
    elements: list[Element] = []
    for number, words in enumerate(lines, start=1):
        match words:
            case ["ply"] | ["comment", *_] | ["obj_info", *_] | []:
                pass
            case ["format", name, "1.0"] if name in ORDERS:
                order = ORDERS[name]
            case ["element", name, count] if count.isascii() and count.isdigit() and len(count) <= LONGEST_COUNT:
                elements.append(Element(name, int(count), ()))
            case ["property", "list", count_type, kind, name] if elements and {count_type, kind} <= TYPES.keys():
                _add(elements, Property(name, TYPES[kind], TYPES[count_type]))
            case ["property", kind, name] if elements and kind in TYPES:
                _add(elements, Property(name, TYPES[kind]))
            case _:
                raise damaged(path, f"line {number} of its header: {shown(' '.join(words))}")
    if order == "":
        raise damaged(path, "its header has no line `format`")
    for element in elements:
        names = [p.name for p in element.properties]
        if len(set(names)) < len(names) or [e.name for e in elements].count(element.name) > 1:
            raise damaged(path, f"its header names something twice in element {shown(element.name)}")
        if any(p.count_type in ("f4", "f8") for p in element.properties):
            raise damaged(path, f"its header counts the lists of {shown(element.name)} in fractions")
    return Header(order, tuple(elements), end)


def _add(elements: list[Element], item: Property) -> None:
    last = elements[-1]
    elements[-1] = Element(last.name, last.count, (*last.properties, item))


def _lines(path: Path, data: bytes) -> tuple[list[list[str]], int]:
    """The words of the lines before `end_header`, and where that line ends."""
    lines: list[list[str]] = []
    at = 0
    while at < min(len(data), LONGEST_HEADER):
        stop = data.find(b"\n", at)
        stop = len(data) if stop < 0 else stop
        words = plain_text(data[at:stop]).split()
        at = stop + 1
        if not lines and words != ["ply"]:
            raise damaged(path, "it does not begin with `ply`")
        if words == ["end_header"]:
            return lines, min(at, len(data))
        lines.append(words)
    raise damaged(path, "the file is cut off: its header has no `end_header`")
