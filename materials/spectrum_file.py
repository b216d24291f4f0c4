"""A spectrum that a user brings: a text table of wavelength and reflectance, or of wavelength, n and k.

    # wavelength [nm], n, k
    400, 1.68, 2.21
    450, 1.74, 2.46

Columns are parted by commas, semicolons, tabs or blanks. Lines that begin with # are left out, and so is one line of
titles.
"""

import re
from pathlib import Path

import numpy as np
from jaxtyping import Float

from materials.input_error import InputError

COVERED_NM = (400.0, 850.0)
"""What a file must cover at least [nm]: of white LEDs nothing counts outside, of halogen lamps a quarter, for which the
nearest value then stands."""
_KINDS = {2: "wavelength and reflectance", 3: "wavelength, n and k"}


def read_spectrum(path: Path, columns: int) -> Float[np.ndarray, "rows columns"]:
    """The table, wavelengths rising [nm]; raises InputError that names the file, the line and the mend.

    columns: 2 for wavelength and reflectance, 3 for wavelength, n and k.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the name") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is no text; give a table of {_KINDS[columns]}") from error
    rows: list[list[float]] = []
    titled = False
    for number, line in enumerate(lines, start=1):
        words = [word for word in re.split(r"[,;\s]+", line.strip()) if word]
        if not words or words[0].startswith("#"):
            continue
        row = _numbers(words)
        if row is None and not rows and not titled:
            titled = True
        elif row is None or len(row) != columns:
            raise InputError(f"{path}: line {number} does not hold {_KINDS[columns]}; mend it there")
        else:
            rows.append(row)
    table = np.array(rows).reshape(-1, columns)
    _check(path, table)
    return table


def _numbers(words: list[str]) -> list[float] | None:
    try:
        return [float(word) for word in words]
    except ValueError:
        return None


def _check(path: Path, table: Float[np.ndarray, "rows columns"]) -> None:
    wavelengths = table[:, 0]
    if len(table) < 2 or not np.all(np.isfinite(table)) or not np.all(np.diff(wavelengths) > 0):
        raise InputError(f"{path}: give at least two lines of finite numbers with rising wavelengths")
    if wavelengths[-1] < 10.0:
        raise InputError(f"{path}: its wavelengths end at {wavelengths[-1]:g}; give them in nm, not um")
    low, high = COVERED_NM
    if wavelengths[0] > low or wavelengths[-1] < high:
        raise InputError(
            f"{path}: covers {wavelengths[0]:g} to {wavelengths[-1]:g} nm; a spectrum must cover {low:g} to {high:g} nm"
        )
