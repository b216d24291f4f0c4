"""A STEP file as text (ISO 10303-21): whether it is whole, its unit of length, how many faces it has."""

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from scenes.cad.cad_file import damaged, plain_text, shown

BEGIN, END = b"ISO-10303-21;", b"END-ISO-10303-21;"
FACES = ("ADVANCED_FACE", "FACE_SURFACE")
"""Entities of which Open CASCADE makes a face each."""
USE, PLACE = "NEXT_ASSEMBLY_USAGE_OCCURRENCE", "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"
"""Entities that use a part in an assembly, and that say where; mapped items are another way to say it."""
SI = {"": "m", "MILLI": "mm", "CENTI": "cm", "DECI": "dm", "MICRO": "um", "NANO": "nm", "KILO": "km"}
"""Prefix of the metre (ISO 10303-41, si_prefix) -> unit."""
CONVERTED = {"INCH": "in", "INCHES": "in", "IN": "in", "MILLIMETRE": "mm", "CENTIMETRE": "cm", "METRE": "m"}
"""Names of conversion-based units, as writers spell them -> unit; any other goes by its own name."""
_QUIET = re.compile(rb"'(?:[^']|'')*'|/\*.*?\*/", re.DOTALL)
"""Strings and comments, in which anything may stand."""
_ENTITY = re.compile(rb"#\s*(\d{1,18})\s*=([^;]*);")
_REFERENCE = re.compile(rb"#\s*(\d{1,18})")
_SI_METRE = re.compile(rb"SI_UNIT\s*\(\s*(?:\$|\.(\w+)\.)\s*,\s*\.METRE\.")
_CONVERSION = re.compile(rb"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'")
_UNITS = re.compile(rb"GLOBAL_UNIT_ASSIGNED_CONTEXT\s*\(\s*\(([^)]*)\)")


@dataclass(frozen=True)
class StepText:
    """What the text says of itself."""

    unit: str | None
    """Of lengths: `mm`, `in` ..., or several; None where none was found."""
    face_count: int
    dangling: int | None
    """An entity that is referred to, yet is not there."""
    use_count: int
    """Uses of parts in assemblies."""
    place_count: int
    """Places for them."""


def read_step_text(path: Path, data: bytes) -> StepText:
    """The text checked: InputError where it is no STEP file, or cut off."""
    if not data.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(BEGIN):
        raise damaged(path, f"it does not begin with `{BEGIN.decode()}`")
    quiet = _QUIET.sub(lambda found: b" " * len(found[0]), data)
    if END not in quiet:
        raise damaged(path, f"the file is cut off: it has no `{END.decode()}`")
    entities = [(int(found[1]), found.span(2)) for found in _ENTITY.finditer(quiet)]
    spans = dict(entities)
    if not spans:
        raise damaged(path, "it has no entities")
    if len(spans) < len(entities):
        twice = next(number for number, count in Counter(number for number, _ in entities).items() if count > 1)
        raise damaged(path, f"entity #{twice} is there more than once")
    referred = {int(number) for start, end in spans.values() for number in _REFERENCE.findall(quiet, start, end)}
    kinds = Counter(quiet[start:end].partition(b"(")[0].strip().decode("latin-1") for start, end in spans.values())
    found = (_unit(data[slice(*spans[number])]) for number in _unit_entities(quiet, spans))
    units = sorted({unit for unit in found if unit is not None})
    return StepText(
        unit=" and ".join(units) or None,
        face_count=sum(kinds[face] for face in FACES),
        dangling=min(referred - spans.keys(), default=None),
        use_count=kinds[USE],
        place_count=kinds[USE] if kinds["MAPPED_ITEM"] else kinds[PLACE],
    )


def doubts(text: StepText, faces: int, nodes: int) -> list[str]:
    """Notices where something of the file is missing, given how many faces and nodes Open CASCADE made of it."""
    notices = []
    if text.use_count != text.place_count or nodes <= text.use_count:
        notices.append(
            f"its assemblies use {text.use_count} parts, of which Open CASCADE finds {min(nodes - 1, text.use_count)}, "
            f"and give {text.place_count} places, so a part may be missing or out of place"
        )
    if text.unit is None:
        notices.append("it states no unit of length that is known, so its size may be wrong")
    if text.dangling is not None:
        notices.append(f"entity #{text.dangling} is referred to, but is not there, so something may be missing")
    if faces < text.face_count:
        notices.append(
            f"{text.face_count - faces} of its {text.face_count} faces could not be made, so the surface has holes or "
            "a body is missing; mend it in CAD and export it again"
        )
    return notices


def _unit_entities(quiet: bytes, spans: dict[int, tuple[int, int]]) -> list[int]:
    """Numbers of the units that the file's contexts name."""
    contexts = _UNITS.findall(quiet)
    named = {int(number) for context in contexts for number in _REFERENCE.findall(context)}
    return sorted(named & spans.keys())


def _unit(entity: bytes) -> str | None:
    """The unit of length that the entity is, or None for angles and the like."""
    if b"LENGTH_UNIT" not in entity:
        return None
    if (conversion := _CONVERSION.search(entity)) is not None:
        name = plain_text(conversion[1]).strip()
        return CONVERTED.get(name.upper(), shown(name.lower()))
    metre = _SI_METRE.search(entity)
    return None if metre is None else SI.get((metre[1] or b"").decode("latin-1"))
