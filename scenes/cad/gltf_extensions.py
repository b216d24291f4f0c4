"""Which glTF extensions a file may need: those that leave shapes alone, and integer positions; the rest by name."""

from collections.abc import Iterable
from pathlib import Path

from materials.input_error import InputError
from scenes.cad.cad_file import format_name, shown

READ = frozenset({"KHR_mesh_quantization", "KHR_lights_punctual", "KHR_xmp", "KHR_xmp_json_ld"})
"""Integer positions (read), lamps and remarks (no shape)."""
APPEARANCE = ("KHR_materials_", "EXT_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "ADOBE_materials_")
"""Beginnings of the names of extensions that change colours alone."""
COMPRESSIONS = {
    "KHR_draco_mesh_compression": "Draco",
    "EXT_meshopt_compression": "meshopt",
    "KHR_meshopt_compression": "meshopt",
    "MESHOPT_compression": "meshopt",
}
COPIES = "EXT_mesh_gpu_instancing"
"""Draws the mesh of a node many times."""


def check_required(path: Path, required: Iterable[str]) -> None:
    """InputError for an extension without which the file cannot be read (glTF 2.0, 3.12), by its name."""
    for name in required:
        if name in COMPRESSIONS:
            raise _compressed(path, name)
        if name not in READ and not name.startswith(APPEARANCE):
            what = ", by which one mesh stands in several places," if name == COPIES else ""
            raise InputError(
                f"{path}: the file needs the {format_name(path)} extension {shown(name)}{what} and it is not read; "
                "export it without, or as STEP or STL"
            )


def check_stored(path: Path, extensions: Iterable[str]) -> None:
    """InputError if a buffer, a view of it or a primitive is compressed or copied."""
    for name in extensions:
        if name in COMPRESSIONS or name == COPIES:
            check_required(path, [name])


def _compressed(path: Path, name: str) -> InputError:
    return InputError(
        f"{path}: the file is compressed with {COMPRESSIONS[name]} ({name}), which is not read; "
        "export it without compression"
    )
