"""The page of an advice, into one HTML file that needs nothing beside it."""

from render.labels.causes import LEGEND
from studies.advise.explained import AFTERWARDS, OUTCOME_COLOURS
from studies.advise.pictures import AFTERWARDS_COLOUR
from studies.advise.report.ranking_figure import ranking_figure
from studies.advise.sentences import with_interval
from studies.advise.stored_advice import StoredAdvice
from studies.drawing.templates import environment, page_style
from studies.run.report.page import flattened

OUTCOME_WORDS = {0: "no depth", 1: "right depth", 2: "false depth"}
"""Of `studies.advise.scoring`'s numbers."""


def advice_html(stored: StoredAdvice) -> str:
    """The whole page."""
    advice = stored.advice
    colours = {entry.name: entry.colour for entry in LEGEND.values()} | {AFTERWARDS: AFTERWARDS_COLOUR}
    meanings = {entry.name: entry.meaning for entry in LEGEND.values()} | {AFTERWARDS: "the plain frame has it"}
    named = list(dict.fromkeys([*stored.lost_before, *stored.lost_after]))
    return (
        environment("studies.advise.report")
        .get_template("advice.html.j2")
        .render(
            stored=stored,
            advice=advice,
            figure=ranking_figure(advice),
            with_interval=with_interval,
            outcomes=[(OUTCOME_WORDS[key], _css(colour)) for key, colour in OUTCOME_COLOURS.items()],
            causes=[
                (name.replace("_", " "), _css(colours[name]), meanings[name],
                 stored.lost_before.get(name, 0.0), stored.lost_after.get(name, 0.0))
                for name in named
            ],
            facts=[pair for pair in flattened(stored.settings) if pair[1] != "None"],
            style=page_style(("studies.advise.report", "advice.css")),
        )
    )  # fmt: skip


def _css(colour: tuple[int, int, int]) -> str:
    return "#{:02x}{:02x}{:02x}".format(*colour)
