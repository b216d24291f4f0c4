"""Materials that a user brings: metals by n and k, plastics, matte surfaces, measured BSDF files. One YAML file:

    materials:
      my_steel:
        kind: metal
        n: 2.91
        k: 4.42
        valid_nm: [400, 1000]
        source: ellipsometry of our sheet, 2024
      my_cover: {kind: plastic, n: 1.5, alpha: 0.1, reflectance: 0.3, source: integrating sphere}
      my_floor: {kind: matte, reflectance: 0.4, source: grey card}
      my_chrome: {kind: measured, file: chrome.bsdf, source: rgl.epfl.ch}

Reflectances hold at 850 nm. File names count from the folder of the YAML file.
"""

import re
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from materials.coat import base_albedo
from materials.input_error import InputError
from materials.material import Material, Matte, Measured, RoughConductor, RoughPlastic
from materials.measured_file import check_measured_file
from materials.non_metals import NON_METALS
from materials.optical_constants import METALS, WAVELENGTH_NM
from materials.suggestion import suggest


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    source: str = Field(min_length=1)
    """Where the numbers come from."""


class UserMetal(_Entry):
    """A metal n + ik of the user's, `kind: metal`; combine it with any finish.

    Ranges are those of `RoughConductor`; constants that do not hold at 850 nm raise InputError when the metal is used.
    """

    kind: Literal["metal"]
    n: float
    """Real part of the refractive index [-]."""
    k: float
    """Extinction coefficient [-]."""
    valid_nm: tuple[float, float]
    """Wavelengths at which n, k hold [nm]; must contain 850."""
    oxide_reflectance: float | None = None
    """Albedo at 850 nm of its oxide, for the finish `oxidised` [0, 1]."""


class UserPlastic(_Entry):
    """A clear coat over a diffuse base, `kind: plastic`: a `RoughPlastic` by what is seen from outside.

    A reflectance that no base under such a coat can give raises InputError.
    """

    kind: Literal["plastic"]
    n: float
    """Refractive index of the coat at 850 nm [-]."""
    alpha: float
    """GGX roughness of the coat [-]."""
    reflectance: float
    """As seen from outside near the normal, without the coat's mirror reflection [0, 1]."""


class UserMatte(_Entry):
    """A Lambertian surface, `kind: matte`."""

    kind: Literal["matte"]
    reflectance: float
    """Albedo at 850 nm [0, 1]."""


class UserMeasured(_Entry):
    """A measured BSDF in the RGL format, `kind: measured`; the file must cover 850 nm, else InputError."""

    kind: Literal["measured"]
    file: Path


_KINDS: dict[str, type[_Entry]] = {
    "metal": UserMetal,
    "plastic": UserPlastic,
    "matte": UserMatte,
    "measured": UserMeasured,
}
UserEntry = Annotated[UserMetal | UserPlastic | UserMatte | UserMeasured, Field(discriminator="kind")]


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

    def material(self, name: str) -> Material:
        """A material that takes no finish."""
        match self.materials[name]:
            case UserPlastic(n=n, alpha=alpha, reflectance=reflectance):
                bare = RoughPlastic(name, n, alpha, 0.0)  # checks n, on which the base depends
                return replace(bare, reflectance=base_albedo(n, reflectance))
            case UserMatte(reflectance=reflectance):
                return Matte(name, reflectance)
            case UserMeasured(file=file):
                return Measured(name, file)
        raise InputError(f"{name}: a metal needs a finish; write {name}:polished")


NO_USER_MATERIALS = UserMaterials()
"""What there is when the user brings nothing."""


def load_user_materials(path: Path) -> UserMaterials:
    """Read and check a material file; raises InputError that names the file, the key and the mend."""
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the name") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: is not YAML ({_one_line(error)}); mend it there") from error
    try:
        user = UserMaterials.model_validate(content)
    except ValidationError as error:
        raise InputError(f"{path}: {_first_fault(error)}") from error
    checked = {name: checked_entry(path, name, entry) for name, entry in user.materials.items()}
    return UserMaterials(materials=checked)


def checked_entry(path: Path, name: str, entry: UserEntry) -> UserEntry:
    """The entry with its file name resolved; raises InputError for bad names, numbers and files.

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
    try:
        _build(name, entry)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return entry


def _build(name: str, entry: UserMetal | UserPlastic | UserMatte) -> None:
    """Make the material once, so that its own checks run; a metal with some valid roughness."""
    if isinstance(entry, UserMetal):
        RoughConductor(name, entry.n, entry.k, 0.1, 0.1, 0.0, entry.oxide_reflectance or 0.0)
    else:
        UserMaterials(materials={name: entry}).material(name)


def _first_fault(error: ValidationError) -> str:
    """`key: what is wrong; mend` for the first fault that pydantic found."""
    fault = error.errors()[0]
    parts = [str(part) for part in fault["loc"]]
    # Inside a tagged union pydantic puts the tag into the place: materials.my_steel.metal.alfa.
    place = [part for part in parts if part not in _KINDS]
    entry = next((_KINDS[part] for part in parts if part in _KINDS), UserMaterials)
    mends = {
        "extra_forbidden": f"unknown key; {suggest(parts[-1] if parts else '', entry.model_fields)}",
        "missing": "missing; add it",
        "union_tag_not_found": f"has no kind; add kind: {', '.join(_KINDS)}",
        "union_tag_invalid": f"unknown kind; use {', '.join(_KINDS)}",
        "dict_type": "is no table of names; write materials: {NAME: {kind: ...}}",
        "model_type": "is no table of names; write materials: {NAME: {kind: ...}}",
    }
    wrong = mends.get(fault["type"], f"{fault['msg'].lower()}; correct the value")
    return f"{'.'.join(place) or 'the file'}: {wrong}"


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
