"""The map: which remedy wins on which metal and finish, a block of cells for each coupon."""

from collections.abc import Mapping, Sequence

from markupsafe import Markup

from materials.catalog import metal_names
from materials.finishes import FINISHES
from studies.advise.advice import RemedyScore
from studies.advise.factors import REMEDY_FACTORS
from studies.advise.sentences import with_interval
from studies.drawing import svg
from studies.drawing.heat_map_figure import shade
from studies.mitigations.answers import CaseAnswer
from studies.sensitivity.trust import spoken

WINNER_COLOURS = (
    (44, 108, 176), (217, 123, 22), (31, 140, 120), (200, 69, 59), (138, 90, 168), (164, 144, 92), (90, 100, 114),
    (199, 120, 170), (60, 170, 200), (120, 140, 40), (100, 80, 60), (240, 180, 60), (60, 60, 160), (150, 40, 90),
    (90, 190, 90), (150, 160, 175), (230, 130, 110),
)  # fmt: skip
"""Of the factors that win anywhere, in the table's order, one for each that can."""
FULL_GAIN = 0.5
"""Gain from which on a cell has its factor's full colour (choice: what halves the missing surface of a bad case)."""
PALEST, STRONGEST = 0.18, 0.62
"""Mixtures of the colour with white for no gain and for the full one (choice: dark text stays readable on it)."""
NO_FINISH = "as it is"
"""Column of what is no metal."""
ROW_PX = 34
"""Height of a cell [px]: two lines."""
LETTERS = 6.6
"""Width of a letter of a cell's first line, generously [px]."""
_LABELS, _TOP = 150, 54
SHORT_NAMES = {
    "preset": "{level}", "RSM removal threshold": "RSM {level}", "exposure": "{level}", "HDR pair": "HDR pair",
    "frames": "{level}", "filters": "{level}", "decimation": "decimate {level}", "roll": "turn by {level}",
    "second look": "second look", "stand-off": "stand {level}", "polarisers": "films {level}",
    "placing of lamps": "lamps {level}", "band-pass filter": "band-pass", "tilt of the part": "tilt {level}",
}  # fmt: skip
"""What cells call a remedy, where factor and level together are too long."""
SHORTER = (("_", " "), (" times", "x"), (" DN", ""), ("on the imagers", "at lens"), ("recommended chain", "chain"))
"""What is shortened of a level's name there."""


def map_figure(title: str, answers: Sequence[CaseAnswer], colours: Mapping[str, tuple[int, int, int]]) -> Markup:
    """Of one coupon. colours: by factor."""
    rows, columns = map_places(answers)
    step = (svg.PAGE_WIDTH - _LABELS) / len(columns)
    heads = [
        svg.text(_LABELS + (k + 0.5) * step, _TOP - 12, spoken(name), "tick-label mid")
        for k, name in enumerate(columns)
    ]
    names = [
        svg.text(_LABELS - 10, _TOP + ROW_PX * (k + 0.5) + 4, spoken(name), "tick-label end")
        for k, name in enumerate(rows)
    ]
    cells = [
        _cell(
            answer,
            _LABELS + step * columns.index(answer.case.finish or NO_FINISH),
            _TOP + ROW_PX * rows.index(answer.case.metal),
            step,
            colours,
        )
        for answer in answers
    ]
    height = _TOP + ROW_PX * len(rows) + 6
    return svg.figure(svg.PAGE_WIDTH, height, title, svg.text(0, 18, title, "axis-label"), *heads, *names, *cells)


def map_places(answers: Sequence[CaseAnswer]) -> tuple[list[str], list[str]]:
    """Rows: metals in the catalogue's order, then what is no metal. Columns: finishes from mirrors to rough ones."""
    metals = {answer.case.metal for answer in answers}
    finishes = {answer.case.finish or NO_FINISH for answer in answers}
    known = [name for name in metal_names() if name in metals]
    rows = [*known, *sorted(metals - set(known))]
    return rows, [name for name in (*FINISHES, NO_FINISH) if name in finishes]


def winner_colours(answers: Sequence[CaseAnswer]) -> dict[str, tuple[int, int, int]]:
    """Colours of the factors that win anywhere."""
    winning = {answer.winner.name for answer in answers if answer.winner}
    names = [factor.name for factor in REMEDY_FACTORS if factor.name in winning]
    return {name: WINNER_COLOURS[k % len(WINNER_COLOURS)] for k, name in enumerate(names)}


def gain_tint(gain: float, colour: tuple[int, int, int]) -> str:
    """Of a cell."""
    return shade(PALEST + (STRONGEST - PALEST) * min(max(gain, 0.0) / FULL_GAIN, 1.0), colour)


def _cell(answer: CaseAnswer, x: float, y: float, width: float, colours: Mapping[str, tuple[int, int, int]]) -> Markup:
    winner, base, spray = answer.winner, answer.advice.base, answer.advice.ceiling
    fill = gain_tint(winner.gain, colours[winner.name]) if winner else CELL_FILLS[answer.advice.kind]
    first = short_name(winner, int((width - 8) / LETTERS)) if winner else answer.advice.kind
    shares = f"{100 * base.right_share:.0f}"
    shares += f" \u2192 {100 * winner.right_share:.0f}" if winner else ""
    ceiling = f", spray {100 * spray.right_share:.0f}" if spray else ""
    box = svg.element("rect", x=x, y=y, width=width - 2, height=ROW_PX - 2, fill=fill, klass="heat")
    middle = x + width / 2 - 1
    lines = (
        svg.text(middle, y + 14, first, "cell-name" if winner else "cell-name none"),
        svg.text(middle, y + 27, f"{shares}{ceiling}", "cell-shares"),
    )
    return svg.marked(svg.join(box, *lines), cell_words(answer))


CELL_FILLS = {"only spray": "url(#hatched)", "nothing needed": "#eef3ee", "nothing helps": "#f4f1ec"}
"""Where no remedy wins, by the kind of the answer."""


def short_name(score: RemedyScore, letters: int) -> str:
    """What a cell calls a remedy, cut to its width."""
    level = score.level
    for long, short in SHORTER:
        level = level.replace(long, short)
    name = SHORT_NAMES.get(score.name, "{factor} {level}").format(factor=score.name, level=level)
    return name if len(name) <= letters else f"{name[: letters - 1].rstrip(' ,')}\u2026"


def cell_words(answer: CaseAnswer) -> str:
    """All that is known of a case, in a line."""
    title, base, name, right, gain, cost, spray = case_line(answer)
    found = f"{name}: {right}, {gain} points, costs {cost}" if answer.winner else name
    return f"{title}: {base} right as set; {found}" + (f"; spray {spray}" if spray else "")


def case_line(answer: CaseAnswer) -> list[str]:
    """Title, right share as set, winner, its right share, its gain in points, what it costs, spray."""
    winner, spray = answer.winner, answer.advice.ceiling
    words = [answer.case.title, with_interval(answer.advice.base)]
    if winner:
        gain = f"{100 * winner.gain:+.1f} ({100 * winner.gain_lo:+.1f} to {100 * winner.gain_hi:+.1f})"
        words += [f"{winner.name}: {winner.level}", with_interval(winner), gain, winner.cost]
    else:
        words += [answer.advice.kind, "", "", ""]
    return [*words, with_interval(spray) if spray else ""]
