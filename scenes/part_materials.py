"""Which material each body of a part gets: one for all, one per body name, or what the real thing is made of."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from materials.catalog import material
from materials.input_error import InputError
from materials.material import Material
from materials.suggestion import suggest
from materials.user_materials import UserMaterials
from scenes.scene import Body

_NO_USER_MATERIALS = UserMaterials()


@dataclass(frozen=True)
class PartMaterials:
    """Materials for the bodies of a part."""

    for_all: Material | None = None
    """For every body that `by_body` does not name; None keeps what the body has."""
    by_body: Mapping[str, Material] = field(default_factory=dict)

    def of(self, body_name: str) -> Material | None:
        """The material of the body, or None when nothing was said about it."""
        return self.by_body.get(body_name, self.for_all)

    def check_names(self, source: str, body_names: Iterable[str]) -> None:
        """Raise InputError if a material was given for a body that `source` does not have."""
        names = list(body_names)
        for name in self.by_body:
            if name not in names:
                raise InputError(f"{source}: there is no body {name} to give a material to; {suggest(name, names)}")


def part_materials(specs: Iterable[str], user: UserMaterials = _NO_USER_MATERIALS) -> PartMaterials:
    """Read command line words: `metal:finish` for all bodies, `body=metal:finish` for one; later words win."""
    for_all: Material | None = None
    by_body: dict[str, Material] = {}
    for spec in specs:
        body, equals, named = spec.partition("=")
        if equals and "@" not in body:  # `brass:ground@alpha=0.1` has its own equals sign
            if not body or not named:
                raise InputError(f"{spec}: cannot tell body from material; write body=metal:finish")
            by_body[body] = material(named, user)
        else:
            for_all = material(spec, user)
    return PartMaterials(for_all, by_body)


def with_part_materials(source: str, bodies: tuple[Body, ...], materials: PartMaterials | None) -> tuple[Body, ...]:
    """The bodies with their materials replaced where `materials` says so; `source` is named in the error."""
    if materials is None:
        return bodies
    materials.check_names(source, [body.name for body in bodies])
    return tuple(replace(body, material=materials.of(body.name) or body.material) for body in bodies)
