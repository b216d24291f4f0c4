"""The numbers of a glTF file: its tree, its buffers and its accessors, none read past the end of what holds it."""

import base64
import binascii
import json
from pathlib import Path
from urllib.parse import unquote

import numpy as np
from jaxtyping import Num
from pydantic import ValidationError

from scenes.cad.cad_file import damaged, shown
from scenes.cad.gltf_extensions import check_stored
from scenes.cad.gltf_tree import Accessor, BufferView, Tree

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
"""Component types (3.6.2.2)."""
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
FULL_SCALE = {"i1": 127, "u1": 255, "i2": 32767, "u2": 65535}
"""Integer that stands for 1 where a type is normalized (3.11; also KHR_mesh_quantization)."""


class Buffers:
    """The tree of a file and the numbers that it points to."""

    def __init__(self, path: Path, data: bytes) -> None:
        self.path = path
        text, self._chunk = _chunks(path, data)
        self.tree = _tree(path, text)
        self._read: dict[int, bytes] = {}

    def entry(self, kind: str, index: int):
        """Entry of a list of the tree, such as `meshes`."""
        entries = getattr(self.tree, kind)
        if index >= len(entries):
            raise damaged(self.path, f"it names number {index} of its `{kind}`, but has {len(entries)}")
        return entries[index]

    def numbers(self, index: int) -> Num[np.ndarray, "n k"]:
        """The values of an accessor; normalized integers as the fractions that they stand for."""
        accessor: Accessor = self.entry("accessors", index)
        width = WIDTHS[accessor.type]
        kind = np.dtype(COMPONENTS[accessor.componentType])
        if accessor.bufferView is None and accessor.sparse is None:
            raise damaged(self.path, f"accessor {index} has no data")
        if accessor.bufferView is None:
            self._check_count(index, accessor)
            values = np.zeros((accessor.count, width), kind)
        else:
            values = self._table(f"accessor {index}", accessor, kind, width)
        if accessor.sparse is not None:
            values = self._replaced(index, accessor, values)
        if accessor.normalized and kind.str[1:] in FULL_SCALE:
            return np.maximum(values / FULL_SCALE[kind.str[1:]], -1.0)
        return values

    def _check_count(self, index: int, accessor: Accessor) -> None:
        """A table of zeros has no bytes that bound it: no more of them than the file could index."""
        held = sum(buffer.byteLength for buffer in self.tree.buffers)
        if accessor.count > held:
            raise damaged(self.path, f"accessor {index} announces {accessor.count} values, the file has {held} bytes")

    def _table(self, what: str, accessor: Accessor, kind: np.dtype, width: int) -> np.ndarray:
        view: BufferView = self.entry("bufferViews", accessor.bufferView or 0)
        return self._strided(what, view, accessor.byteOffset, accessor.count, kind, width)

    def _strided(self, what: str, view: BufferView, offset: int, count: int, kind: np.dtype, width: int) -> np.ndarray:
        data = self._view(view)
        size = kind.itemsize * width
        stride = view.byteStride or size
        if stride < size or offset + stride * (count - 1) + size > len(data):
            raise damaged(self.path, f"{what} needs {count} values, but its buffer view ends before")
        return np.ndarray((count, width), kind, data, offset, (stride, kind.itemsize))

    def _replaced(self, index: int, accessor: Accessor, values: np.ndarray) -> np.ndarray:
        sparse = accessor.sparse
        assert sparse is not None
        at = self._strided(
            f"accessor {index}",
            self.entry("bufferViews", sparse.indices.bufferView),
            sparse.indices.byteOffset,
            sparse.count,
            np.dtype(COMPONENTS[sparse.indices.componentType]),
            1,
        )[:, 0]
        view = self.entry("bufferViews", sparse.values.bufferView)
        new = self._strided(
            f"accessor {index}", view, sparse.values.byteOffset, sparse.count, values.dtype, values.shape[1]
        )
        if at.max() >= accessor.count:
            raise damaged(self.path, f"accessor {index} replaces value {at.max()} of {accessor.count}")
        values = values.copy()
        values[at] = new
        return values

    def _view(self, view: BufferView) -> bytes:
        check_stored(self.path, view.extensions)
        data = self._buffer(view.buffer)
        if view.byteOffset + view.byteLength > len(data):
            raise damaged(self.path, f"a buffer view ends at byte {view.byteOffset + view.byteLength} of {len(data)}")
        return data[view.byteOffset : view.byteOffset + view.byteLength]

    def _buffer(self, index: int) -> bytes:
        if index not in self._read:
            buffer = self.entry("buffers", index)
            check_stored(self.path, buffer.extensions)
            data = self._chunk if buffer.uri is None else self._from_uri(buffer.uri)
            if buffer.byteLength > len(data):
                raise damaged(
                    self.path, f"buffer {index} announces {buffer.byteLength} bytes, but {len(data)} are there"
                )
            self._read[index] = data[: buffer.byteLength]
        return self._read[index]

    def _from_uri(self, uri: str) -> bytes:
        if uri.startswith("data:"):
            try:
                return base64.b64decode(uri.partition(",")[2], validate=True)
            except binascii.Error:
                raise damaged(self.path, "a buffer inside it is no base64") from None
        name = unquote(uri)
        try:
            if "://" not in uri and not Path(name).is_absolute():
                return (self.path.parent / name).read_bytes()
        except (OSError, ValueError):  # not there, a folder, or no name of a file at all
            pass
        raise damaged(self.path, f"its buffer {shown(uri)} is not beside it")


def _chunks(path: Path, data: bytes) -> tuple[bytes, bytes]:
    """The JSON text and the binary chunk (4.4); a text file has no such chunk."""
    if data[:4] != b"glTF":
        if path.suffix.lower() == ".glb":
            raise damaged(path, "it does not begin with `glTF`")
        return data, b""
    version, length = (int.from_bytes(data[at : at + 4], "little") for at in (4, 8))
    if version != 2:
        raise damaged(path, f"it is of glTF version {version}, and 2 is read")
    if length != len(data):
        what = "the file is cut off: it" if length > len(data) else "it"
        raise damaged(path, f"{what} announces {length} bytes and has {len(data)}")
    chunks: list[tuple[bytes, bytes]] = []
    at = 12
    while at < length:
        end = at + 8 + int.from_bytes(data[at : at + 4], "little")
        if end > length or at + 8 > length:
            raise damaged(path, f"the chunk at byte {at} ends behind the file")
        chunks.append((data[at + 4 : at + 8], data[at + 8 : end]))
        at = end
    if not chunks or chunks[0][0] != b"JSON":
        raise damaged(path, "its first chunk is not JSON")
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == b"BIN\0" else b""
    return chunks[0][1], binary


def _tree(path: Path, text: bytes) -> Tree:
    try:
        tree = Tree.model_validate(json.loads(text.decode("utf-8-sig")))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "its JSON"
        raise damaged(path, f"{shown(place)}: {shown(first['msg'])}") from error
    except RecursionError as error:
        raise damaged(path, "its JSON is nested too deep") from error
    except UnicodeDecodeError as error:
        raise damaged(path, f"its JSON is no UTF-8 at byte {error.start}") from error
    except json.JSONDecodeError as error:
        raise damaged(path, f"its JSON breaks off in line {error.lineno}, column {error.colno}") from error
    except ValueError as error:
        raise damaged(path, f"its JSON has a number that is none ({shown(str(error))})") from error
    if tree.asset.version.partition(".")[0] != "2":
        raise damaged(path, f"it is of glTF version {shown(tree.asset.version)}, and 2 is read")
    return tree
