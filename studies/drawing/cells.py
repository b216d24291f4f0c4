"""How the tables of a report write numbers: the mean, its interval small below it, real minus signs."""

from markupsafe import Markup

from studies.statistics.intervals import Difference, Interval, Quartiles
from studies.statistics.medians import MedianEstimate

POINTS = 100.0
"""Shares as percentages."""
NO_NUMBER = "\u2013"
"""Where there can be no number."""


def signs(text: str) -> str:
    """With minus signs instead of hyphens."""
    return text.replace("-", "\u2212")


def with_range(middle: float, low: float, high: float, form: str) -> Markup:
    """`98.8` and below it `98.5 to 99.4`."""
    ends = f"{low:{form}} to {high:{form}}"
    return Markup("{}<small>{}</small>").format(signs(format(middle, form)), signs(ends))


def mean(interval: Interval | None, scale: float, form: str) -> str:
    """The mean alone."""
    return "n/a" if interval is None else signs(format(scale * interval.mean, form))


def mean_and_range(interval: Interval | None, scale: float, form: str) -> str:
    """The mean with its interval, which a single run does not have."""
    if interval is None or interval.count == 1:
        return mean(interval, scale, form)
    return with_range(scale * interval.mean, scale * interval.low, scale * interval.high, form)


def median_and_range(estimate: MedianEstimate | None, scale: float, form: str) -> str:
    """The same of a median."""
    if estimate is None:
        return "n/a"
    if estimate.count == 1:
        return signs(format(scale * estimate.value, form))
    return with_range(scale * estimate.value, scale * estimate.low, scale * estimate.high, form)


def signed(difference: Difference | None, scale: float = POINTS, form: str = "+z.1f") -> str:
    """A difference with its sign, in points unless said otherwise."""
    return mean_and_range(difference.interval if difference else None, scale, form)


def seconds(times: Quartiles | None) -> str:
    """Median and quartiles."""
    return "n/a" if times is None else with_range(times.median, times.lower, times.upper, ".2f")


def probability(p: float | None) -> str:
    """Two digits, as many as a p is good for."""
    return NO_NUMBER if p is None else f"{p:.2g}"
