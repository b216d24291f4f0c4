"""Materials that a user brings: metals by n and k, plastics, matte surfaces, measured BSDF files. One YAML file:

    materials:
      my_steel:
        kind: metal
        n: 2.91
        k: 4.42
        valid_nm: [400, 1000]
        source: ellipsometry of our sheet, 2024
        lamps: {white_led: [2.21, 3.80], halogen: [2.62, 4.17]}
      my_cover: {kind: plastic, n: 1.5, alpha: 0.1, reflectance: 0.3, lamps: {white_led: 0.04}, source: sphere}
      my_paint: {kind: matte, reflectance: 0.4, spectrum: paint.csv, source: spectrophotometer}
      my_floor: {kind: matte, reflectance: 0.4, source: grey card}
      my_chrome: {kind: measured, file: chrome.bsdf, source: rgl.epfl.ch}

n, k and reflectances hold at 850 nm, those under `lamps` for the lamps' light as the imager weighs it. A `spectrum`, a
table of wavelength [nm] and reflectance, or n and k for a metal, gives the latter (`materials.spectrum_file`). Where
neither says anything, the lamps' light finds what the projector's does. File names count from the YAML file's folder.
"""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

from materials.coat import base_albedo
from materials.effective_constants import effective_constants
from materials.input_error import InputError
from materials.lights import LAMP_BANDS, SPECTRUM_NM, Band, electron_weights
from materials.material import INDEX_RANGE, ConductorNumbers, Material, Matte, Measured, RoughConductor, RoughPlastic
from materials.measured_file import check_measured_file
from materials.non_metals import NON_METALS
from materials.optical_constants import METALS, WAVELENGTH_NM
from materials.spectrum_file import read_spectrum
from materials.suggestion import suggest
from materials.user_entries import (
    LAMP_NAMES,
    USER_KINDS,
    LampConstants,
    LampNumbers,
    UserEntry,
    UserMatte,
    UserMeasured,
    UserMetal,
    UserPlastic,
)


class UserMaterials(BaseModel):
    """The materials of one file, by name.

    `load_user_materials` reads and checks them all, numbers, names and files; made otherwise, they are checked for
    their keys and types alone.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    materials: dict[str, UserEntry] = {}

    def constants(self, name: str) -> tuple[float, float]:
        """n, k of a metal at 850 nm; raises InputError when they do not hold there."""
        entry = self.materials[name]
        assert isinstance(entry, UserMetal)
        low, high = entry.valid_nm
        if not low <= WAVELENGTH_NM <= high:
            raise InputError(
                f"{name}: its n, k hold from {low:g} to {high:g} nm, the projector emits {WAVELENGTH_NM:g} nm; "
                "give constants measured there, and their valid_nm"
            )
        return entry.n, entry.k

    def oxide_reflectance(self, name: str) -> float:
        """Albedo of a metal's oxide; raises InputError when the file gives none."""
        entry = self.materials[name]
        if not isinstance(entry, UserMetal) or entry.oxide_reflectance is None:
            raise InputError(f"{name}:oxidised: the file gives no oxide_reflectance for {name}; add it, from 0 to 1")
        return entry.oxide_reflectance

    def lamp_constants(self, name: str) -> tuple[tuple[Band, ConductorNumbers], ...]:
        """n, k and the oxide's albedo of a metal under the lamps that the file names."""
        entry = self.materials[name]
        assert isinstance(entry, UserMetal)
        pairs, oxides = _given(entry.lamps), _given(entry.oxide_lamps)
        found = []
        for band in LAMP_BANDS:
            if band in pairs or band in oxides:
                n, k = pairs.get(band, (entry.n, entry.k))
                found.append((band, ConductorNumbers(n, k, oxides.get(band, entry.oxide_reflectance or 0.0))))
        return tuple(found)

    def material(self, name: str) -> Material:
        """A material that takes no finish."""
        match self.materials[name]:
            case UserPlastic(n=n, alpha=alpha, reflectance=reflectance, lamps=lamps):
                bare = RoughPlastic(name, n, alpha, 0.0)  # checks n, on which the base depends
                bases = tuple((band, base_albedo(n, seen)) for band, seen in _given(lamps).items())
                return replace(bare, reflectance=base_albedo(n, reflectance), lamps=bases)
            case UserMatte(reflectance=reflectance, lamps=lamps):
                return Matte(name, reflectance, tuple(_given(lamps).items()))
            case UserMeasured(file=file):
                return Measured(name, file)
        raise InputError(f"{name}: a metal needs a finish; write {name}:polished")


def _given(lamps: LampNumbers | LampConstants | None) -> dict[Band, Any]:
    """What is said of each kind of lamp, where anything is."""
    numbers = {band: getattr(lamps, band.value, None) for band in LAMP_BANDS}
    return {band: number for band, number in numbers.items() if number is not None}


_LAMP_KEYS = (["lamps"], ["oxide_lamps"])
"""Ends of the place of a fault in what is said of lamps."""

NO_USER_MATERIALS = UserMaterials()
"""What there is when the user brings nothing."""


def load_user_materials(path: Path) -> UserMaterials:
    """Read and check a material file; raises InputError that names the file, the key and the mend."""
    checked = {name: checked_entry(path, name, entry) for name, entry in _read(path).materials.items()}
    return UserMaterials(materials=checked)


def named_files(path: Path) -> dict[str, Path]:
    """The other files that a material file names, by material: measured BSDFs and spectra."""
    files = {
        name: getattr(entry, "file", getattr(entry, "spectrum", None)) for name, entry in _read(path).materials.items()
    }
    return {name: (path.parent / file).resolve() for name, file in files.items() if file is not None}


def _read(path: Path) -> UserMaterials:
    """A material file as it is written, checked for its keys and types."""
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the name") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: is not YAML ({_one_line(error)}); mend it there") from error
    try:
        return UserMaterials.model_validate(content)
    except ValidationError as error:
        raise InputError(f"{path}: {_first_fault(error)}") from error


def checked_entry(path: Path, name: str, entry: UserEntry) -> UserEntry:
    """The entry with its file name resolved and its spectrum read; raises InputError for bad names, numbers and files.

    path: of the YAML file that it stands in.
    """
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise InputError(f"{path}: {name}: bad material name; use lower-case letters, digits and _")
    if name in METALS or name in NON_METALS:
        raise InputError(f"{path}: {name}: a built-in material has this name; choose another")
    if isinstance(entry, UserMeasured):
        entry = entry.model_copy(update={"file": (path.parent / entry.file).resolve()})
        check_measured_file(entry.file)
        return entry
    if entry.spectrum is not None and entry.lamps is not None:
        raise InputError(f"{path}: {name}: has both lamps and spectrum; leave one out")
    try:
        entry = _with_spectrum(path, entry)
        _build(name, entry)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return entry


def _with_spectrum(path: Path, entry: UserMetal | UserPlastic | UserMatte) -> UserMetal | UserPlastic | UserMatte:
    """The entry with its means under the lamps in place of its spectrum, so that it needs the file no more."""
    if entry.spectrum is None:
        return entry
    file = (path.parent / entry.spectrum).resolve()
    table = read_spectrum(file, 3 if isinstance(entry, UserMetal) else 2)
    columns = [np.interp(SPECTRUM_NM, table[:, 0], column) for column in table.T[1:]]
    weights = {band.value: electron_weights(band) for band in LAMP_BANDS}
    if isinstance(entry, UserMetal):
        for low, high in ((column.min(), column.max()) for column in columns):
            if not INDEX_RANGE[0] <= low <= high <= INDEX_RANGE[1]:
                raise InputError(f"{file}: n, k go from {low:g} to {high:g}; give numbers from 0.01 to 20")
        lamps = LampConstants(**{lamp: effective_constants(columns[0], columns[1], w) for lamp, w in weights.items()})
    else:
        lamps = LampNumbers(**{lamp: float(np.sum(w * columns[0])) for lamp, w in weights.items()})
    return entry.model_copy(update={"lamps": lamps, "spectrum": None})


def _build(name: str, entry: UserMetal | UserPlastic | UserMatte) -> None:
    """Make the material once, so that its own checks run; a metal with some valid roughness."""
    user = UserMaterials(materials={name: entry})
    if isinstance(entry, UserMetal):
        oxide = entry.oxide_reflectance or 0.0
        RoughConductor(name, entry.n, entry.k, 0.1, 0.1, 0.0, oxide, user.lamp_constants(name))
    else:
        user.material(name)


def _first_fault(error: ValidationError) -> str:
    """`key: what is wrong; mend` for the first fault that pydantic found."""
    fault = error.errors()[0]
    parts = [str(part) for part in fault["loc"]]
    # Inside a tagged union pydantic puts the tag into the place: materials.my_steel.metal.alfa.
    place = [part for part in parts if part not in USER_KINDS]
    entry = next((USER_KINDS[part] for part in parts if part in USER_KINDS), UserMaterials)
    known = LAMP_NAMES if parts[-2:-1] in _LAMP_KEYS else tuple(entry.model_fields)
    mends = {
        "extra_forbidden": f"unknown key; {suggest(parts[-1] if parts else '', known)}",
        "missing": "missing; add it",
        "union_tag_not_found": f"has no kind; add kind: {', '.join(USER_KINDS)}",
        "union_tag_invalid": f"unknown kind; use {', '.join(USER_KINDS)}",
        "dict_type": "is no table of names; write materials: {NAME: {kind: ...}}",
        "model_type": (
            f"names no lamps; write {parts[-1]}: {{white_led: ...}}"
            if parts[-1:] in _LAMP_KEYS
            else "is no table of names; write materials: {NAME: {kind: ...}}"
        ),
        **(
            {"model_type": f"names no lamps; write {parts[-1]}: {{white_led: ...}}"} if parts[-1:] in _LAMP_KEYS else {}
        ),
    }
    wrong = mends.get(fault["type"], f"{fault['msg'].lower()}; correct the value")
    return f"{'.'.join(place) or 'the file'}: {wrong}"


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
