"""Charts of what each decision moves: dots with margins, sorted, the paper's direction marked."""

from collections.abc import Mapping

from markupsafe import Markup

from studies.drawing import svg
from studies.drawing.cells import signs
from studies.readings.decisions import DECISIONS
from studies.readings.effects import Effect

EFFECTS_PLOT = svg.Plot(width=svg.PAGE_WIDTH, height=24, left=430, right=170, top=40, bottom=52)
"""Height of a row, margins of the whole [px]."""


def effects_figure(effects: Mapping[str, Effect], title: str, axis: str, scale: float, form: str) -> Markup:
    """A row per decision, the largest first. scale: from the effects' unit to the axis'; form: of the numbers."""
    rows = sorted(effects.items(), key=lambda item: -abs(item[1].value))
    ends = [scale * (abs(effect.value) + (effect.margin or 0.0)) for _, effect in rows]
    ends += [scale * effect.lenth_margin for _, effect in rows]
    most = 1.05 * max(ends) or 1.0
    x = svg.Scale(-most, most, EFFECTS_PLOT.left, EFFECTS_PLOT.width - EFFECTS_PLOT.right)
    bottom = float(EFFECTS_PLOT.top + EFFECTS_PLOT.height * len(rows))
    lenth = scale * rows[0][1].lenth_margin
    words = {decision.name: decision.second for decision in DECISIONS}
    return svg.figure(
        EFFECTS_PLOT.width,
        int(bottom + EFFECTS_PLOT.bottom),
        title,
        svg.element(
            "rect",
            x=x(-lenth),
            y=EFFECTS_PLOT.top - 12,
            width=x(lenth) - x(-lenth),
            height=bottom - EFFECTS_PLOT.top + 12,
            klass="lenth",
        ),
        *(svg.line(x(t), EFFECTS_PLOT.top - 12, x(t), bottom, "grid") for t in x.ticks(8)),
        svg.line(x(0), EFFECTS_PLOT.top - 12, x(0), bottom, "zero"),
        *(
            _row(name, words[name], effect, EFFECTS_PLOT.top + EFFECTS_PLOT.height * (k + 0.5), x, scale, form)
            for k, (name, effect) in enumerate(rows)
        ),
        svg.bottom_axis(x, bottom, axis, x.ticks(8)),
    )


def _row(name: str, second: str, effect: Effect, y: float, x: svg.Scale, scale: float, form: str) -> Markup:
    sure = " sure" * effect.is_sure
    value, margin = scale * effect.value, scale * (effect.margin or 0.0)
    mark = svg.join(
        svg.line(x(value - margin), y, x(value + margin), y, f"effect-range{sure}"),
        svg.element("circle", cx=x(value), cy=y, r=4.5, klass=f"effect-dot{sure}"),
    )
    told = effect_words(effect, scale, form)
    label = svg.element(
        "text",
        svg.join(svg.element("tspan", name, klass="effect-name"), svg.element("tspan", f"  {second}")),
        x=EFFECTS_PLOT.left - 16,
        y=y + 4,
        klass="tick-label end",
    )
    return svg.join(
        label,
        svg.marked(mark, f"{name}, {second}: {told}"),
        svg.text(EFFECTS_PLOT.width, y + 4, told, "tick-label end"),
    )


def effect_words(effect: Effect, scale: float, form: str) -> str:
    """`+3.1 ± 1.2`; without a margin the effect alone."""
    margin = "" if effect.margin is None else f" \u00b1 {scale * effect.margin:{form.lstrip('+')}}"
    return signs(f"{scale * effect.value:{form}}") + margin
