"""Materials by name: `metal:finish`, `metal:finish@alpha=...`, or a non-metal; and the matte twin of any of them.

stainless_austenitic:polished          nominal roughness of the finish
brass:brushed@alpha=0.05,0.2           along the lay, across it
iron:blasted@alpha=0.35                the same in all directions
black_plastic                          a non-metal takes no finish
"""

from materials.finishes import FINISHES, OXIDE_REFLECTANCE, oxide_reflectance, oxide_under_lamps
from materials.input_error import InputError
from materials.lights import Band
from materials.material import ConductorNumbers, Material, Matte, RoughConductor
from materials.non_metals import NON_METALS
from materials.optical_constants import METALS, optical_constants
from materials.suggestion import suggest
from materials.user_entries import UserMetal
from materials.user_materials import NO_USER_MATERIALS, UserMaterials

TWIN_REFLECTANCE = 0.5
"""Albedo of the matte twin under every light. Choice: one number, so that one twin rendering serves every material of a
study; half-way, so that auto-exposure neither starves nor saturates the twin beside the same lamps."""


def material(spec: str, user: UserMaterials = NO_USER_MATERIALS) -> Material:
    """The material that `spec` names; raises InputError when there is none, or none that holds at 850 nm."""
    body, at, override = spec.strip().partition("@")
    name, colon, finish_name = body.partition(":")
    if name in METALS or isinstance(user.materials.get(name), UserMetal):
        if not finish_name:
            raise InputError(f"{spec}: a metal needs a finish; write {name}:polished, or one of {', '.join(FINISHES)}")
        return _metal(name, finish_name, f"@{override}" if at else "", user)
    if name not in NON_METALS and name not in user.materials:
        raise InputError(f"{spec}: unknown material; {suggest(name, material_names(user))}")
    if colon or at:
        raise InputError(f"{spec}: {name} is no metal and takes neither finish nor roughness; write {name}")
    return NON_METALS[name].material if name in NON_METALS else user.material(name)


def _metal(name: str, finish_name: str, override: str, user: UserMaterials) -> RoughConductor:
    """A metal with a finish, its roughness replaced by `override` (`@alpha=...`, or empty)."""
    spec = f"{name}:{finish_name}{override}"
    if finish_name not in FINISHES:
        raise InputError(f"{spec}: unknown finish {finish_name}; {suggest(finish_name, FINISHES)}")
    surface = FINISHES[finish_name]
    alpha_u, alpha_v = _alphas(spec, override) if override else (surface.alpha_u, surface.alpha_v)
    entry = user.materials.get(name)
    own = entry if isinstance(entry, UserMetal) else None
    n, k = user.constants(name) if own else (optical_constants(name).n, optical_constants(name).k)
    oxide = 0.0
    if surface.oxide_share > 0.0:
        oxide = user.oxide_reflectance(name) if own else oxide_reflectance(name)
    lamps = user.lamp_constants(name) if own else _lamp_constants(name, surface.oxide_share > 0.0)
    return RoughConductor(spec, n, k, alpha_u, alpha_v, surface.oxide_share, oxide, lamps)


def _lamp_constants(name: str, oxidised: bool) -> tuple[tuple[Band, ConductorNumbers], ...]:
    """A built-in metal under the lamps' light."""
    row = METALS[name]
    oxide = oxide_under_lamps(name) if oxidised else {}
    pairs = ((Band.WHITE_LED, row.white_led), (Band.HALOGEN, row.halogen))
    return tuple((band, ConductorNumbers(n, k, oxide.get(band, 0.0))) for band, (n, k) in pairs)


def _alphas(spec: str, override: str) -> tuple[float, float]:
    """Roughness along and across the lay from `@alpha=A` or `@alpha=A,B`."""
    key, _, text = override.removeprefix("@").partition("=")
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if key != "alpha" or len(values) not in (1, 2):
        raise InputError(
            f"{spec}: cannot read the roughness; write @alpha=0.07, or @alpha=0.05,0.2 along and across the lay"
        )
    return values[0], values[-1]


def matte_twin(material: Material) -> Matte:
    """What the surface would be if it were diffuse: the intervention that tells whether reflection caused a hole.

    A matte surface is its own twin. Every other one becomes the same grey, whatever it is made of, and under every
    light: the twin changes how a surface reflects, and a colour of its own would change how bright its lamps look too.
    """
    return material if isinstance(material, Matte) else Matte("matte_twin", TWIN_REFLECTANCE)


def metal_names(user: UserMaterials = NO_USER_MATERIALS) -> tuple[str, ...]:
    """Metals, the built-in ones first."""
    return (*METALS, *(name for name, entry in user.materials.items() if isinstance(entry, UserMetal)))


def finish_names(metal: str | None = None, user: UserMaterials = NO_USER_MATERIALS) -> tuple[str, ...]:
    """Finishes, of one metal or all: a metal without a known oxide cannot be `oxidised`."""
    own = user.materials.get(metal or "")
    if isinstance(own, UserMetal):
        bare = own.oxide_reflectance is None
    else:
        bare = metal in METALS and metal not in OXIDE_REFLECTANCE
    return tuple(name for name, row in FINISHES.items() if not (bare and row.oxide_share > 0.0))


def material_names(user: UserMaterials = NO_USER_MATERIALS) -> tuple[str, ...]:
    """Every name that can stand before the colon: metals, then non-metals."""
    others = (name for name, entry in user.materials.items() if not isinstance(entry, UserMetal))
    return (*metal_names(user), *NON_METALS, *others)
