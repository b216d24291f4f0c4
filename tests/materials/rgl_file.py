"""Write small files in the RGL tensor format, independently of the reader under test.

Format as the authors' own `tensor.py` writes it (https://github.com/jdupuy/dj_brdf): header, list of arrays, arrays.
"""

import struct
from pathlib import Path

import numpy as np

CODES = {"uint8": 1, "float32": 10}


def write_tensor_file(path: Path, arrays: dict[str, np.ndarray]) -> Path:
    """All arrays, each on an 8-byte boundary."""
    head = b"tensor_file\0" + bytes([1, 0]) + struct.pack("<I", len(arrays))
    list_size = sum(2 + len(name) + 2 + 1 + 8 + 8 * array.ndim for name, array in arrays.items())
    position, listed, body = -(-(len(head) + list_size) // 8) * 8, b"", b""
    start = position
    for name, array in arrays.items():
        listed += struct.pack("<H", len(name)) + name.encode()
        listed += struct.pack("<HBQ", array.ndim, CODES[array.dtype.name], position)
        listed += struct.pack(f"<{array.ndim}Q", *array.shape)
        block = array.tobytes() + bytes(-array.nbytes % 8)
        body, position = body + block, position + len(block)
    path.write_bytes((head + listed).ljust(start, b"\0") + body)
    return path


def spectral_measurement(wavelengths: np.ndarray) -> dict[str, np.ndarray]:
    """The arrays of an isotropic spectral measurement, filled with ones; spectra rise with the wavelength's index."""
    n_theta, size, n = 4, 8, len(wavelengths)
    ones = np.ones((1, n_theta, size, size), np.float32)
    return {
        "theta_i": np.linspace(0, np.pi / 2, n_theta, dtype=np.float32),
        "phi_i": np.zeros(1, np.float32),
        "ndf": np.ones((size, size), np.float32),
        "sigma": np.ones((size, size), np.float32),
        "vndf": ones,
        "luminance": ones,
        "spectra": ones[:, :, None] * np.arange(n, dtype=np.float32)[:, None, None],
        "wavelengths": wavelengths.astype(np.float32),
        "description": np.frombuffer(b"test", np.uint8),
        "jacobian": np.ones(1, np.uint8),
    }
