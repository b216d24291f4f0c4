"""Check that a measured BSDF file is what it claims: the tensor file of the RGL material database.

Format: J. Dupuy, W. Jakob, An adaptive parameterization for efficient material acquisition and rendering, SIGGRAPH Asia
2018, supplement: 12 bytes `tensor_file\\0`, two version bytes, a uint32 count of arrays, then per array a name, a rank,
a type, an offset and a shape.
"""

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from materials.input_error import InputError

MAGIC = b"tensor_file\0"
VERSION = b"\x01\x00"
FIELDS = ("theta_i", "phi_i", "ndf", "sigma", "vndf", "luminance", "spectra", "wavelengths", "jacobian")
"""What a spectral measurement must hold; the RGB files of the same database lack 850 nm."""
_TYPES = {1: np.uint8, 5: np.uint32, 10: np.float32, 11: np.float64}
"""Element types by their code in the file (Mitsuba's `Struct::Type`)."""


@dataclass(frozen=True)
class TensorField:
    """One array of the file as the file's head announces it: element type `dtype`, and `shape`, slowest index first."""

    dtype: type
    shape: tuple[int, ...]
    offset: int
    """Of its first byte in the file."""


def check_measured_file(path: Path, wavelength_nm: float = 850.0) -> None:
    """Raise InputError unless `path` is a spectral RGL file that covers the wavelength."""
    fields = tensor_fields(path)
    missing = [name for name in FIELDS if name not in fields]
    if missing:
        raise InputError(f"{path}: has no {', '.join(missing)}; take the spectral file of the RGL database, _spec.bsdf")
    wavelengths = read_tensor(path, fields["wavelengths"])
    low, high = float(wavelengths.min()), float(wavelengths.max())
    if not low <= wavelength_nm <= high:
        raise InputError(f"{path}: covers {low:g} to {high:g} nm, not {wavelength_nm:g} nm; take a file that does")


def tensor_fields(path: Path) -> dict[str, TensorField]:
    """The arrays of a tensor file by name; raises InputError when it is none, or cut short."""
    try:
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise InputError(f"{path}: is not an RGL tensor file; take a .bsdf from the RGL material database")
            if file.read(2) != VERSION:
                raise InputError(f"{path}: is a tensor file of an unknown version; only 1.0 can be read")
            (count,) = struct.unpack("<I", file.read(4))
            fields = dict(_read_field(file) for _ in range(count))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the name") from error
    except (struct.error, KeyError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: its list of arrays is damaged; download it again") from error
    size = path.stat().st_size
    for name, field in fields.items():
        if field.offset + np.dtype(field.dtype).itemsize * int(np.prod(field.shape)) > size:
            raise InputError(f"{path}: ends before its array {name}; download it again")
    return fields


def read_tensor(path: Path, field: TensorField) -> np.ndarray:
    """One array of a tensor file, in its own type and shape."""
    count = int(np.prod(field.shape))
    return np.fromfile(path, field.dtype, count, offset=field.offset).reshape(field.shape)


def _read_field(file: BinaryIO) -> tuple[str, TensorField]:
    """Read one entry of the list of arrays."""
    (length,) = struct.unpack("<H", file.read(2))
    name = file.read(length).decode()
    rank, code, offset = struct.unpack("<HBQ", file.read(11))
    shape = struct.unpack(f"<{rank}Q", file.read(8 * rank))
    return name, TensorField(_TYPES[code], shape, offset)
