"""The remedies that people try, as factors with levels: the one table of what is tried and of what that needs.

`STORED`: measured again from radiance that is stored, bit for bit what a new rendering would give, since laser,
exposure, matcher and all that follows do not change the light. `SCALED`: the lamps' layer is multiplied, as light is
linear; a new rendering would spend its samples otherwise, and differs by its sampling error. `NEW`: rendered.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum

from render.depth.filters.chain import DepthFilters
from render.depth.filters.hole_filling import HoleFillingSettings
from render.depth.filters.spatial import SpatialSettings
from render.depth.filters.temporal import TemporalSettings
from render.imager.band_pass import BandPass
from render.imager.polarisers import Polarisers
from render.imager.settings import LEAST_GAIN
from render.matcher.d400_preset import D400_PRESETS, RSM_WINDOW
from studies.advise.preset_text import with_neighbours, with_preset
from studies.advise.setup import Setup, Stand


class LightNeed(Enum):
    """What a remedy needs (head of the module)."""

    STORED = "re-scored from stored light"
    SCALED = "re-scored, lamps scaled"
    NEW = "rendered anew"


@dataclass(frozen=True)
class Level:
    """One way to try a remedy."""

    name: str
    words: str
    """What to do, as a part of a sentence."""
    change: Callable[[Setup], Setup]


@dataclass(frozen=True)
class RemedyFactor:
    """A remedy."""

    name: str
    need: LightNeed
    cost: str
    """In a word: nothing, resolution, time, motion, handling, money."""
    levels: tuple[Level, ...]
    excludes: tuple[str, ...] = ()
    """Factors that set the same thing, or act on what this one takes away; they do not go together."""
    is_ceiling: bool = False
    """Changes the part itself: shown as what is possible at the best, not advised as a setting."""


@dataclass(frozen=True)
class Remedy:
    """A level of a factor."""

    factor: RemedyFactor
    level: Level

    @property
    def title(self) -> str:
        """For people."""
        return f"{self.factor.name}: {self.level.name}"


def _laser(milliwatts: float) -> Level:
    words = f"set the laser to {milliwatts:g} mW" if milliwatts else "turn the laser off"
    return Level(f"{milliwatts:g} mW", words, lambda setup: setup.with_imager(laser_power_mw=milliwatts))


def _set_point(grey: float) -> Level:
    words = f"set auto-exposure's set-point to {grey:g} of 255"
    return Level(f"{grey:g} DN", words, lambda setup: setup.with_imager(set_point=grey).with_sensor(auto_exposure=True))


def _exposed(exposure_us: float, gain: float = LEAST_GAIN) -> Level:
    name = f"{exposure_us:g} us at gain {gain:g}"
    return Level(
        name,
        f"fix the exposure at {name}",
        lambda setup: setup.with_imager(exposure_us=exposure_us, gain=gain).with_sensor(auto_exposure=False),
    )


def _hdr(long_us: float, short_us: float) -> Level:
    name = f"{long_us:g} and {short_us:g} us"
    return Level(
        name, f"merge an HDR pair of {name}", lambda setup: setup.model_copy(update={"hdr_us": (long_us, short_us)})
    )


def _preset(name: str) -> Level:
    return Level(name, f"choose the preset {name.replace('_', ' ')}", lambda setup: with_preset(setup, name))


def _rsm(least: int) -> Level:
    share = least / RSM_WINDOW
    name, words = (
        (f"{share:.2f}", f"set the RSM removal threshold to {share:.2f}") if least else ("off", "turn RSM off")
    )
    return Level(name, words, lambda setup: with_neighbours(setup, least))


def _filtered(name: str, filters: DepthFilters) -> Level:
    return Level(name, f"run the {name}", lambda setup: setup.model_copy(update={"filters": filters}))


def _set(name: str, words: str, **update: object) -> Level:
    return Level(name, words, lambda setup: setup.model_copy(update=update))


def _stand(name: str, words: str, **update: float) -> Level:
    return Level(name, words, lambda setup: setup.model_copy(update={"stand": setup.stand.model_copy(update=update)}))


def _films(name: str, words: str, films: Polarisers) -> Level:
    return Level(
        name,
        words,
        lambda setup: setup.with_sensor(imager=setup.sensor.imager.model_copy(update={"polarisers": films})),
    )


def _profile(name: str) -> Level:
    return Level(name, f"stream {name}", lambda setup: setup.with_sensor(profile=name))


def _decimated(factor: int) -> Level:
    name, words = (f"by {factor}", f"decimate by {factor}") if factor > 1 else ("off", "do not decimate")
    return Level(name, words, lambda setup: setup.with_sensor(decimation=factor))


_OFF = DepthFilters(threshold=None, spatial=None, temporal=None, hole_filling=None)
_SPATIAL, _TEMPORAL = SpatialSettings(), TemporalSettings()
_SETS_EXPOSURE = ("set-point", "exposure", "HDR pair")


def _without(name: str) -> tuple[str, ...]:
    return tuple(other for other in _SETS_EXPOSURE if other != name)


# Levels are choices: librealsense's defaults and ends of range, and steps of about two between them. New light stands
# in the order in which time is spent on it: what tells most for its price comes first.
REMEDY_FACTORS: tuple[RemedyFactor, ...] = (
    RemedyFactor("preset", LightNeed.STORED, "nothing", tuple(_preset(name) for name in D400_PRESETS)),
    RemedyFactor(
        "RSM removal threshold", LightNeed.STORED, "nothing", tuple(_rsm(least) for least in (0, 31, 94, 136))
    ),
    RemedyFactor(
        "laser", LightNeed.STORED, "nothing",
        tuple(_laser(p) for p in (0.0, 30.0, 60.0, 90.0, 150.0, 240.0, 360.0)),
    ),
    RemedyFactor(
        "set-point", LightNeed.STORED, "nothing", tuple(_set_point(g) for g in (32.0, 64.0, 96.0, 128.0, 160.0)),
        _without("set-point"),
    ),
    RemedyFactor(
        "exposure", LightNeed.STORED, "nothing",
        (*(_exposed(t) for t in (500.0, 1000.0, 2000.0, 4000.0, 8500.0, 17000.0, 33000.0)), _exposed(2000.0, 64.0)),
        _without("exposure"),
    ),
    # The first pair is that of librealsense's example rs-hdr.
    RemedyFactor(
        "HDR pair", LightNeed.STORED, "time",
        (_hdr(8500.0, 150.0), _hdr(8500.0, 1000.0), _hdr(4000.0, 500.0), _hdr(17000.0, 2000.0), _hdr(33000.0, 4000.0)),
        _without("HDR pair"),
    ),
    RemedyFactor(
        "frames", LightNeed.STORED, "time",
        tuple(_set(f"median of {n}", f"take the median of {n} frames", frames=n) for n in (3, 9)),
    ),
    RemedyFactor(
        "filters", LightNeed.STORED, "nothing",
        (
            _filtered("spatial filter", _OFF.model_copy(update={"spatial": _SPATIAL})),
            _filtered(
                "spatial filter with holes of 16 px filled",
                _OFF.model_copy(update={"spatial": SpatialSettings(holes_fill=4)}),
            ),
            _filtered("temporal filter", _OFF.model_copy(update={"temporal": _TEMPORAL})),
            _filtered(
                "temporal filter that keeps all depth",
                _OFF.model_copy(update={"temporal": TemporalSettings(persistence=8)}),
            ),
            *(
                _filtered(
                    f"hole filling, {words}", _OFF.model_copy(update={"hole_filling": HoleFillingSettings(mode=k)})
                )
                for k, words in enumerate(("from the left", "largest disparity", "smallest disparity"))
            ),
            _filtered("recommended chain without hole filling", DepthFilters(hole_filling=None)),
            _filtered("recommended chain", DepthFilters()),
        ),
    ),
    RemedyFactor("decimation", LightNeed.STORED, "resolution", tuple(_decimated(k) for k in (1, 2, 3, 4, 8))),
    RemedyFactor(
        "lamps", LightNeed.SCALED, "handling",
        (_set("off", "turn the lamps off", lamp_level=0.0), _set("dim", "dim the lamps to a quarter", lamp_level=0.25)),
        ("placing of lamps", "band-pass filter"),  # which take away or move what is off
    ),
    RemedyFactor(
        "spray", LightNeed.NEW, "handling and cleaning",
        (_set("matte", "spray the part matte", sprayed=True),), is_ceiling=True,
    ),
    RemedyFactor("roll", LightNeed.NEW, "motion", (_stand("90 deg", "turn the camera by 90 deg", roll_deg=90.0),)),
    RemedyFactor(
        "second look", LightNeed.NEW, "motion and time",
        (
            _set("turned by 90 deg", "add a second look, turned by 90 deg", second=Stand(roll_deg=90.0)),
            _set("from 30 deg aside", "add a second look from 30 deg aside", second=Stand(azimuth_deg=30.0)),
        ),
    ),
    RemedyFactor(
        "stand-off", LightNeed.NEW, "motion",
        (
            _stand("0.75 times", "go nearer, to 0.75 times the distance", distance=0.75),
            _stand("1.33 times", "stand back, to 1.33 times the distance", distance=4 / 3),
        ),
    ),
    RemedyFactor(
        "polarisers", LightNeed.NEW, "money",
        (
            _films(
                "crossed", "put crossed polarisers on projector and imagers",
                Polarisers(imagers_deg=90.0, projector_deg=0.0),
            ),
            _films("on the imagers", "put polarisers on the imagers", Polarisers(imagers_deg=0.0)),
        ),
    ),
    RemedyFactor(
        "placing of lamps", LightNeed.NEW, "handling",
        (
            _set("moved", "swing the nearest lamps round the part by 90 deg", lamps="moved"),
            _set("diffuse", "put a diffuser of four times their area before the nearest lamps", lamps="diffuse"),
        ),
    ),
    RemedyFactor(
        "band-pass filter", LightNeed.NEW, "money",
        (
            Level(
                "850 nm", "put band-pass filters of 850 nm on the imagers",
                lambda setup: setup.with_sensor(
                    imager=setup.sensor.imager.model_copy(update={"band_pass": BandPass()})
                ),
            ),
        ),
    ),
    RemedyFactor(
        "tilt of the part", LightNeed.NEW, "handling",
        tuple(_set(f"{a:g} deg", f"tilt the part by {a:g} deg", tilt_deg=a) for a in (15.0, 30.0)),
    ),
    RemedyFactor("profile", LightNeed.NEW, "nothing", tuple(_profile(p) for p in ("480x270", "848x480", "1280x720"))),
)  # fmt: skip


def remedies_for(base: Setup, factors: Sequence[RemedyFactor] = REMEDY_FACTORS) -> tuple[Remedy, ...]:
    """The levels that change anything about a camera as it is set, in the table's order.

    Left out: lamps of scenes without any are the caller's to leave out; a profile that the model does not have.
    """
    return tuple(Remedy(factor, level) for factor in factors for level in factor.levels if level.change(base) != base)


def set_up_with(base: Setup, remedies: Sequence[Remedy]) -> Setup:
    """The base with all of them, in the table's order, since a threshold is changed on top of a preset."""
    order = [factor.name for factor in REMEDY_FACTORS]
    for remedy in sorted(remedies, key=lambda one: order.index(one.factor.name)):
        base = remedy.level.change(base)
    return base


def go_together(remedies: Sequence[Remedy]) -> bool:
    """Whether each sets something of its own."""
    names = [remedy.factor.name for remedy in remedies]
    excluded = {name for remedy in remedies for name in remedy.factor.excludes}
    return len(set(names)) == len(names) and not excluded & set(names)
