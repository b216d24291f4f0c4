"""Which material each body of a part gets: one for all, one per body name, or what the real thing is made of."""

import contextlib
import shlex
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from materials.catalog import material
from materials.input_error import InputError
from materials.material import Material
from materials.suggestion import suggest
from materials.user_materials import UserMaterials
from scenes.scene import Body

_NO_USER_MATERIALS = UserMaterials()
LISTED = 20
"""Bodies that a message lists (choice: two lines of a terminal)."""


@dataclass(frozen=True)
class PartMaterials:
    """Materials for the bodies of a part."""

    for_all: Material | None = None
    """For every body that `by_body` does not name; None keeps what the body has."""
    by_body: Mapping[str, Material] = field(default_factory=dict)
    """By the body's name, or by its number in the list of bodies, from 1 on: `#2`."""

    def of(self, source: str, body_names: Sequence[str]) -> list[Material | None]:
        """The material of each body, None where nothing was said; InputError for one that `source` does not have."""
        chosen = [self.for_all] * len(body_names)
        for key, named in self.by_body.items():
            index = _place(key, body_names)
            if index is None:
                mend = suggest(key, body_names)
                listed = _numbered(body_names) if mend.startswith("did you mean") else _BY_NUMBER
                raise InputError(f"{source}: there is no body {key} to give a material to; {mend}{listed}")
            chosen[index] = named
        return chosen

    def for_bodies(self, source: str, body_names: Sequence[str]) -> list[Material]:
        """The material of each body; InputError where one has none, which names all bodies and how to address them."""
        chosen = self.of(source, body_names)
        found = [named for named in chosen if named is not None]
        if len(found) == len(chosen):
            return found
        number = chosen.index(None)
        name = body_names[number]
        word = shlex.quote(f"{name}=metal:finish") if _speakable(name) else f"'#{number + 1}=metal:finish'"
        raise InputError(f"{source}: body {name} has no material; pass --material {word}{_numbered(body_names)}")


def part_materials(specs: Iterable[str], user: UserMaterials = _NO_USER_MATERIALS) -> PartMaterials:
    """Read command line words: `metal:finish` for all bodies, `body=metal:finish` for one; later words win.

    The body is its name, which may hold any letter, or its number in the list of bodies: `#2=metal:finish`.
    """
    for_all: Material | None = None
    by_body: dict[str, Material] = {}
    for spec in specs:
        body, named = _body_and_material(spec, user)
        if body is None:
            for_all = named
        else:
            by_body[body] = named
    return PartMaterials(for_all, by_body)


def _body_and_material(spec: str, user: UserMaterials) -> tuple[str | None, Material]:
    """The body (None = all) and the material of a word: cut at the first equals sign that has a material behind it.

    A name may have equals signs (`M6=A2=iron:ground`), and so may a material (`brass:ground@alpha=0.1`).
    """
    cuts = [i for i, letter in enumerate(spec) if letter == "="]
    for body, word in [(None, spec), *((spec[:cut], spec[cut + 1 :]) for cut in cuts)]:
        with contextlib.suppress(InputError):
            if body != "":
                return body, material(word, user)
    body, equals, word = spec.partition("=")
    if not equals or _is_material(body.partition("@")[0], user):
        return None, material(spec, user)
    if not body or not word:
        raise InputError(f"{spec}: cannot tell body from material; write body=metal:finish")
    return body, material(word if "@" in word else word.rpartition("=")[2], user)


def _is_material(word: str, user: UserMaterials) -> bool:
    try:
        material(word, user)
    except InputError:
        return False
    return True


def _place(key: str, body_names: Sequence[str]) -> int | None:
    """Which body is meant: by its very name, by it in another spelling of Unicode or in quotes, or by its number."""
    unquoted = key[1:-1] if len(key) > 2 and key[0] == key[-1] == '"' else key
    for spelling in (key, unquoted):
        for i, name in enumerate(body_names):
            if unicodedata.normalize("NFC", spelling) == unicodedata.normalize("NFC", name):
                return i
    number = int(key[1:]) if key[:1] == "#" and key[1:].isdecimal() and len(key) < 10 else 0
    return number - 1 if 1 <= number <= len(body_names) else None


def _speakable(name: str) -> bool:
    """Whether a person can type the name back from a message."""
    return name.isprintable() and name == name.strip()


_BY_NUMBER = "; or name it by its number in this list, as in --material '#1=metal:finish'"


def _numbered(body_names: Sequence[str]) -> str:
    """The list of bodies by number, by which they can be named too."""
    if len(body_names) < 2:
        return ""
    listed = ", ".join(f"#{number} {name}" for number, name in enumerate(body_names[:LISTED], start=1))
    more = f" and {len(body_names) - LISTED} more" if len(body_names) > LISTED else ""
    return f"; bodies by number: {listed}{more}, as in --material '#1=metal:finish'"


def with_part_materials(source: str, bodies: tuple[Body, ...], materials: PartMaterials | None) -> tuple[Body, ...]:
    """The bodies with their materials replaced where `materials` says so; `source` is named in the error."""
    if materials is None:
        return bodies
    chosen = materials.of(source, [body.name for body in bodies])
    return tuple(replace(body, material=own or body.material) for body, own in zip(bodies, chosen, strict=True))
