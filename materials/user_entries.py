"""What a user may write of a material: the entries of a material file, checked for their keys and types.

Physical checks are made where the materials are (`materials.user_materials`).
"""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_serializer

from materials.lights import LAMP_BANDS


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    source: str = Field(min_length=1)
    """Where the numbers come from."""

    @model_serializer(mode="wrap")
    def _without_what_is_not_given(self, handler: Any) -> dict[str, Any]:
        """Lamps that are not named leave no trace, so that names by content are those of before there were any."""
        optional = ("lamps", "oxide_lamps", "spectrum")
        return {key: value for key, value in handler(self).items() if not (value is None and key in optional)}


class LampNumbers(BaseModel):
    """A reflectance under the lamps' light, `white_led` and `halogen` [0, 1]; one that is left out is as at 850 nm."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    white_led: float | None = None
    halogen: float | None = None


class LampConstants(BaseModel):
    """n and k of a metal under the lamps' light, `white_led` and `halogen` [-]; left out: as at 850 nm."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    white_led: tuple[float, float] | None = None
    halogen: tuple[float, float] | None = None


LAMP_NAMES = tuple(band.value for band in LAMP_BANDS)


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
    lamps: LampConstants | None = None
    spectrum: Path | None = None
    oxide_lamps: LampNumbers | None = None


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
    """As seen from outside near the normal, without the coat's mirror reflection [0, 1]; `lamps` as well."""
    lamps: LampNumbers | None = None
    spectrum: Path | None = None


class UserMatte(_Entry):
    """A Lambertian surface, `kind: matte`."""

    kind: Literal["matte"]
    reflectance: float
    """Albedo at 850 nm [0, 1]."""
    lamps: LampNumbers | None = None
    spectrum: Path | None = None


class UserMeasured(_Entry):
    """A measured BSDF in the RGL format, `kind: measured`; the file must cover 850 nm, else InputError."""

    kind: Literal["measured"]
    file: Path


USER_KINDS: dict[str, type[_Entry]] = {
    "metal": UserMetal,
    "plastic": UserPlastic,
    "matte": UserMatte,
    "measured": UserMeasured,
}
UserEntry = Annotated[UserMetal | UserPlastic | UserMatte | UserMeasured, Field(discriminator="kind")]
