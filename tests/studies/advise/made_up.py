"""Setups and counts that were never measured."""

from render.d435i import SensorSettings
from studies.advise.factors import REMEDY_FACTORS, Level, Remedy
from studies.advise.paired_shares import SurfaceShares
from studies.advise.scoring import SurfaceCount
from studies.advise.search import Tried
from studies.advise.setup import Setup


def base() -> Setup:
    """A camera as it comes, its depth as it is sent."""
    return Setup(sensor=SensorSettings(decimation=1, crop=None).resolved())


def remedy(factor: str, level: str) -> Remedy:
    """A row of the table."""
    (found,) = [one for one in REMEDY_FACTORS if one.name == factor]
    (level_found,) = [one for one in found.levels if one.name == level]
    return Remedy(found, level_found)


def shares(right: list[float], false: float = 0.0, seeds: int = 1) -> SurfaceShares:
    """Poses that see a square metre each, with these shares of right depth."""
    return SurfaceShares.of([tuple(SurfaceCount(1.0, share, false, 1.0) for _ in range(seeds)) for share in right])


def tried(*remedies: Remedy, right: list[float], false: float = 0.0) -> Tried:
    """Measured with these shares."""
    setup = base()
    for one in remedies:
        setup = one.level.change(setup)
    return Tried(tuple(remedies), setup, shares(right, false))


def no_change(name: str) -> Level:
    """A level that does nothing."""
    return Level(name, name, lambda setup: setup)
