"""The JSON tree of a glTF 2.0 file, as far as surfaces need it; every field is checked as it is read.

Source: Khronos, glTF 2.0 Specification; section numbers beside the classes.
"""

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field

Index = Annotated[int, Field(ge=0)]
Numbers = list[float]


class _Entry(BaseModel):
    model_config = ConfigDict(extra="allow", allow_inf_nan=False)

    others: ClassVar[tuple[str, ...]] = ()
    """Properties of the format that say nothing of surfaces."""

    extensions: dict[str, Any] = {}
    extras: Any = None

    def unknown(self) -> Iterator[str]:
        """Names of properties that the format does not have, here and below."""
        yield from (name for name in self.model_extra or {} if name not in self.others)
        for name in type(self).model_fields:
            value = getattr(self, name)
            for entry in value if isinstance(value, list) else [value]:
                if isinstance(entry, _Entry):
                    yield from entry.unknown()


class Buffer(_Entry):
    """Bytes (3.6.1)."""

    others = ("name",)

    byteLength: Annotated[int, Field(ge=1)]  # noqa: N815 (names of the format)
    uri: str | None = None


class BufferView(_Entry):
    """A slice of a buffer (3.6.1)."""

    others = ("name", "target")

    buffer: Index
    byteLength: Annotated[int, Field(ge=1)]  # noqa: N815
    byteOffset: Index = 0  # noqa: N815
    byteStride: Annotated[int, Field(ge=4, le=252)] | None = None  # noqa: N815


class SparseIndices(_Entry):
    """Which elements are replaced (3.6.2.3)."""

    bufferView: Index  # noqa: N815
    byteOffset: Index = 0  # noqa: N815
    componentType: Literal[5121, 5123, 5125]  # noqa: N815


class SparseValues(_Entry):
    """What they are replaced with (3.6.2.3)."""

    bufferView: Index  # noqa: N815
    byteOffset: Index = 0  # noqa: N815


class Sparse(_Entry):
    """Elements that differ from the rest (3.6.2.3)."""

    count: Annotated[int, Field(ge=1)]
    indices: SparseIndices
    values: SparseValues


class Accessor(_Entry):
    """A table of numbers (3.6.2)."""

    others = ("name",)

    bufferView: Index | None = None  # noqa: N815
    byteOffset: Index = 0  # noqa: N815
    componentType: Literal[5120, 5121, 5122, 5123, 5125, 5126]  # noqa: N815
    normalized: bool = False
    count: Annotated[int, Field(ge=1)]
    type: Literal["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"]
    min: Numbers | None = None
    max: Numbers | None = None
    sparse: Sparse | None = None


class Primitive(_Entry):
    """Triangles, lines or points (3.7.2)."""

    others = ("material", "targets")

    attributes: dict[str, Index]
    indices: Index | None = None
    mode: Annotated[int, Field(ge=0, le=6)] = 4


class GltfMesh(_Entry):
    """Primitives (3.7)."""

    primitives: Annotated[list[Primitive], Field(min_length=1)]
    name: str = ""
    weights: Numbers = []


class Node(_Entry):
    """A place in the scene graph (3.5.3)."""

    others = ("camera",)

    name: str = ""
    mesh: Index | None = None
    skin: Index | None = None
    children: list[Index] = []
    matrix: Annotated[Numbers, Field(min_length=16, max_length=16)] | None = None
    translation: Annotated[Numbers, Field(min_length=3, max_length=3)] = [0.0, 0.0, 0.0]
    rotation: Annotated[Numbers, Field(min_length=4, max_length=4)] = [0.0, 0.0, 0.0, 1.0]
    scale: Annotated[Numbers, Field(min_length=3, max_length=3)] = [1.0, 1.0, 1.0]
    weights: Numbers = []


class SceneNodes(_Entry):
    """Root nodes (3.5.1)."""

    others = ("name",)

    nodes: list[Index] = []


class Asset(_Entry):
    """Of the file (3.2)."""

    others = ("copyright", "generator", "minVersion")

    version: str


class Tree(_Entry):
    """The whole file."""

    others = ("animations", "cameras", "images", "materials", "samplers", "skins", "textures")

    asset: Asset
    scene: Index | None = None
    scenes: list[SceneNodes] = []
    nodes: list[Node] = []
    meshes: list[GltfMesh] = []
    accessors: list[Accessor] = []
    bufferViews: list[BufferView] = []  # noqa: N815
    buffers: list[Buffer] = []
    extensionsUsed: list[str] = []  # noqa: N815
    extensionsRequired: list[str] = []  # noqa: N815
