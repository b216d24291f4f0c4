"""Safe angles in plain words: a line for each material and roll."""

from collections.abc import Iterator
from math import floor

from franbv.surfaces.safe_angles import AngleBin, RollAngles, SafeAngles
from scenes.build import COUPONS
from studies.base.numbers_as_text import percent
from studies.sensitivity.trust import spoken


def table_lines(table: SafeAngles) -> Iterator[str]:
    """All of the table, a line each."""
    for entry in table.materials:
        for line in entry.rolls:
            yield f"{entry.material}, roll {line.roll_deg:g} deg: {verdict(line, table)}"


def verdict(line: RollAngles, table: SafeAngles) -> str:
    """Where it is safe and how sure that is, or that it is safe nowhere and what comes nearest; what is not known."""
    return f"{safe_words(line, table)}{unknown_words(line, table)}"


def safe_words(line: RollAngles, table: SafeAngles) -> str:
    """The ranges, or the best bin."""
    if line.ranges:
        widest, *others = line.ranges
        also = "".join(f", and from {span.from_deg:g} to {span.to_deg:g} deg" for span in others)
        return (
            f"safe from {widest.from_deg:g} to {widest.to_deg:g} deg ({percent(widest.share)} of the surface right, in "
            f"each bin {percent(widest.lower_bound)} at least){also}."
        )
    best = best_bin(line)
    if best is None:
        seen = max(line.bins, key=lambda found: found.effective_views)
        rightest = max(line.bins, key=lambda found: found.share or 0.0)
        return (
            f"not known at any angle: the best seen bin, {bin_words(seen)}, has {views_words(seen)} views of "
            f"{table.least_views} that are needed; give more --poses. As measured {bin_words(rightest)} is best, with "
            f"{percent(rightest.share)} of the surface right."
        )
    return (
        f"safe nowhere; the best bin, {bin_words(best)}, has {percent(best.share)} of the surface right, "
        f"{percent(best.lower_bound)} at least."
    )


def best_bin(line: RollAngles) -> AngleBin | None:
    """The known bin with the highest lower bound, the larger share of equals; None where none is known."""
    known = [found for found in line.bins if found.lower_bound is not None]
    return max(known, key=lambda found: (found.lower_bound, found.share), default=None)


def unknown_words(line: RollAngles, table: SafeAngles) -> str:
    """The bins that too few views see and how many that are, views of one size, with a space before them; empty where
    all or none are known."""
    unknown = [found for found in line.bins if not found.is_known]
    if not unknown or len(unknown) == len(line.bins):
        return ""
    named = ", ".join(f"{bin_words(found)} ({views_words(found)})" for found in unknown)
    return f" Not known, for fewer than {table.least_views} views: {named}."


def views_words(found: AngleBin) -> str:
    """Effective views, rounded down, so that too few look like too few."""
    return f"{floor(10 * found.effective_views) / 10:.1f}"


def bin_words(found: AngleBin) -> str:
    """`30 to 40 deg`."""
    return f"{found.from_deg:g} to {found.to_deg:g} deg"


def subject_words(table: SafeAngles) -> str:
    """`part A1`, `a lying cylinder`, `bracket.stl`."""
    mesh, part = table.measured_for["mesh"], table.measured_for["part"]
    return mesh or (f"a {spoken(part)}" if part in COUPONS else f"part {part}")
