"""Whether a JSON message is what ROS 2 would take for its type: every field known, every value of the field's type."""

import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

DEFINITIONS = Path(__file__).with_name("moveit_2.msgs.txt")
HUMBLE, LATER = "humble", "later"
VERSIONS = (HUMBLE, LATER)
WHOLE = {"int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "byte", "char", "octet"}


@cache
def fields_of(version: str) -> dict[str, dict[str, Any]]:
    """Type -> name of a field -> its type as rosbags describes it."""
    store = get_typestore({HUMBLE: Stores.ROS2_HUMBLE, LATER: Stores.LATEST}[version])
    found = {name: dict(fields) for name, (_, fields) in store.fielddefs.items()}
    (other,) = set(VERSIONS) - {version}
    for section in DEFINITIONS.read_text().split("=== ")[1:]:
        name, *lines = section.splitlines()
        text = "\n".join(line.split(" #")[0] for line in lines if not line.endswith(f"# {other}"))
        ((_, fields),) = get_types_from_msg(text, name).values()
        found[name] = dict(fields)
    return found


def faults(value: Any, type_name: str, version: str, *, complete: bool) -> list[str]:
    """What is wrong with a message; complete: whether every field must be there, as in what rosbridge sends."""
    return list(_object_faults(value, type_name, type_name, fields_of(version), complete))


def _object_faults(
    value: Any, name: str, place: str, types: dict[str, dict[str, Any]], complete: bool
) -> Iterator[str]:
    fields = types[name]
    if not isinstance(value, dict):
        yield f"{place}: {value!r} is no {name}"
        return
    yield from (f"{place}.{key}: no such field" for key in value if key not in fields)
    if complete:
        yield from (f"{place}.{key}: missing" for key in fields if key not in value)
    for key, field in fields.items():
        if key in value:
            yield from _faults(value[key], field, f"{place}.{key}", types, complete)


def _faults(value: Any, field: Any, place: str, types: dict[str, dict[str, Any]], complete: bool) -> Iterator[str]:
    kind, of = field
    if kind is Nodetype.NAME:
        yield from _object_faults(value, of, place, types, complete)
    elif kind is Nodetype.BASE:
        if not _fits(value, of[0]):
            yield f"{place}: {value!r} is no {of[0]}"
    else:
        element, length = of
        if not isinstance(value, list):
            yield f"{place}: {value!r} is no list"
            return
        too_many = kind is Nodetype.SEQUENCE and length and len(value) > length
        if too_many or (kind is Nodetype.ARRAY and len(value) != length):
            yield f"{place}: {len(value)} elements, {length} at most"
        for k, one in enumerate(value):
            yield from _faults(one, element, f"{place}[{k}]", types, complete)


def _fits(value: Any, base: str) -> bool:
    if base in WHOLE:
        return isinstance(value, int) and not isinstance(value, bool) and (value >= 0 or not base.startswith("u"))
    if base.startswith("float"):
        return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    return isinstance(value, {"bool": bool, "string": str}[base])


def filled(value: dict[str, Any], type_name: str, version: str) -> dict[str, Any]:
    """The message with every field that is not said at its default, as rosbridge sends messages."""
    types = fields_of(version)
    return {
        key: _filled(value[key], field, version) if key in value else _default(field, version)
        for key, field in types[type_name].items()
    } | {key: one for key, one in value.items() if key not in types[type_name]}


def _filled(value: Any, field: Any, version: str) -> Any:
    kind, of = field
    if kind is Nodetype.NAME:
        return filled(value, of, version)
    if kind is Nodetype.BASE:
        return value
    return [_filled(one, of[0], version) for one in value]


def _default(field: Any, version: str) -> Any:
    kind, of = field
    if kind is Nodetype.NAME:
        whole = filled({}, of, version)
        return whole | {"w": 1.0} if of == "geometry_msgs/msg/Quaternion" else whole
    if kind is Nodetype.BASE:
        return "" if of[0] == "string" else False if of[0] == "bool" else 0.0 if of[0].startswith("float") else 0
    return [_default(of[0], version)] * of[1] if kind is Nodetype.ARRAY else []
