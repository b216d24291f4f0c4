"""The few SVG pieces that the figures are made of: scales with round ticks, axes, lines, marks, labels."""

from dataclasses import dataclass

import numpy as np
from markupsafe import Markup, escape


@dataclass(frozen=True)
class Scale:
    """A linear map from data to pixels along one axis."""

    low: float
    """Smallest value on the axis."""
    high: float
    """Largest value."""
    start: float
    """Pixel of `low`."""
    end: float
    """Pixel of `high`."""

    def __call__(self, value: float) -> float:
        """Pixel of a value."""
        span = self.high - self.low
        return self.start + (value - self.low) / (span if span else 1.0) * (self.end - self.start)

    def ticks(self, about: int = 6) -> list[float]:
        """Round values on the axis, `about` that many."""
        return round_ticks(self.low, self.high, about)


@dataclass(frozen=True)
class Plot:
    """Where a plot stands inside a drawing [px]; edges or margins, as the figure that uses it says."""

    width: int
    """Of the whole drawing."""
    height: int
    left: int
    right: int
    top: int
    bottom: int


PAGE_WIDTH = 1160
"""Of drawings that are as wide as a page's cards [px]."""


def round_ticks(low: float, high: float, about: int) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten between two values, at most `about` + 1 of them."""
    if high <= low:
        return [low]
    raw = (high - low) / about
    power = 10.0 ** np.floor(np.log10(raw))
    step = next(power * m for m in (1, 2, 5, 10) if power * m >= raw * (1 - 1e-9))
    first = np.ceil(low / step - 1e-9)
    count = int(np.floor(high / step + 1e-9) - first) + 1
    return [round(float((first + k) * step), 12) for k in range(count)]


def element(name: str, content: object = "", **attributes: object) -> Markup:
    """One element; `klass` is its class and underscores in attribute names become hyphens."""
    names = {key: "class" if key == "klass" else key.replace("_", "-") for key in attributes}
    parts = "".join(f' {names[key]}="{escape(_number(value))}"' for key, value in attributes.items())
    return Markup(f"<{name}{parts}>{escape(content)}</{name}>")


def join(*pieces: Markup) -> Markup:
    """Pieces one after the other."""
    return Markup("").join(piece for piece in pieces if piece)


def line(x1: float, y1: float, x2: float, y2: float, klass: str) -> Markup:
    """A straight line."""
    return element("line", x1=x1, y1=y1, x2=x2, y2=y2, klass=klass)


def path(points: list[tuple[float, float]], klass: str) -> Markup:
    """A line through points."""
    steps = " ".join(f"{'M' if k == 0 else 'L'}{_number(x)} {_number(y)}" for k, (x, y) in enumerate(points))
    return element("path", d=steps, klass=klass) if points else Markup("")


def text(x: float, y: float, words: object, klass: str = "", **attributes: object) -> Markup:
    """A label."""
    return element("text", words, x=x, y=y, klass=klass, **attributes)


def marked(shape: Markup, tooltip: str) -> Markup:
    """A mark that says `tooltip` under the pointer."""
    return element("g", join(element("title", tooltip), shape))


def bottom_axis(scale: Scale, y: float, label: str, ticks: list[float]) -> Markup:
    """Ticks and name of a horizontal axis below the plot."""
    marks = [
        join(line(scale(t), y, scale(t), y + 5, "tick"), text(scale(t), y + 19, _tick(t), "tick-label mid"))
        for t in ticks
    ]
    return join(*marks, text((scale.start + scale.end) / 2, y + 40, label, "axis-label mid"))


def left_axis(scale: Scale, x: float, right: float, ticks: list[float]) -> Markup:
    """Grid lines and ticks of a vertical axis; its name stands above the figure, so that nobody tilts the head."""
    rows = [
        join(line(x, scale(t), right, scale(t), "grid"), text(x - 8, scale(t) + 4, _tick(t), "tick-label end"))
        for t in ticks
    ]
    return join(*rows)


def figure(width: int, height: int, title: str, *pieces: Markup) -> Markup:
    """The whole drawing, scaling with the page; `title` is read by screen readers."""
    return element("svg", join(*pieces), viewBox=f"0 0 {width} {height}", role="img", aria_label=title, klass="figure")


def _tick(value: float) -> str:
    return f"{value:g}".replace("-", "\u2212")


def _number(value: object) -> object:
    return f"{value:.2f}".rstrip("0").rstrip(".") if isinstance(value, float | np.floating) else value
