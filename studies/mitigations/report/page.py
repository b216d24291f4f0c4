"""The page of a study of mitigations, into one HTML file that needs nothing beside it."""

from collections.abc import Iterator

from studies.base.numbers_as_text import counted
from studies.drawing.templates import environment, page_style
from studies.mitigations.common_advice import (
    NEARLY_RIGHT,
    NEARLY_WRONG,
    NOT_TOLD_APART,
    TOO_FEW_CASES,
    UNTRIED,
    JudgedAdvice,
)
from studies.mitigations.findings import MitigationsFindings
from studies.mitigations.polarised import PolarisedMaterial
from studies.mitigations.preset import MitigationsPreset
from studies.mitigations.report.map_figure import case_line, map_figure, winner_colours
from studies.mitigations.report.verdict_figure import verdict_figure
from studies.mitigations.sentences import depends_words, harm_words, poses_caveat
from studies.mitigations.tallies import TOLD_VERDICTS
from studies.run.report.page import flattened
from studies.sensitivity.trust import spoken
from studies.statistics.medians import MedianEstimate

VERDICT_CLASSES = {
    NEARLY_RIGHT: "helps",
    NEARLY_WRONG: "hurts",
    NOT_TOLD_APART: "level",
    TOO_FEW_CASES: "level",
    UNTRIED: "level",
}
"""Colours of verdicts on advice; others have that of what depends."""


def mitigations_html(preset: MitigationsPreset, found: MitigationsFindings) -> str:
    """The whole page."""
    colours = winner_colours(found.answers)
    coupons = dict.fromkeys(answer.case.coupon for answer in found.answers)
    ways = list(dict.fromkeys(way for row in found.polarised for way in row.gains))
    return (
        environment("studies.mitigations.report")
        .get_template("mitigations.html.j2")
        .render(
            title=preset.title,
            paragraph=found.paragraph,
            measured=len(found.answers),
            planned=found.planned,
            tiles=list(mitigation_tiles(found)),
            maps=[
                map_figure(spoken(name), [one for one in found.answers if one.case.coupon == name], colours)
                for name in coupons
            ],
            colours=[(name, "rgb({}, {}, {})".format(*colour)) for name, colour in colours.items()],
            advice=[advice_row(one) for one in found.advice],
            verdicts=verdict_figure(found.remedies) if found.remedies else "",
            ways=ways,
            polarised=[polarised_row(row, ways) for row in found.polarised],
            caveat=poses_caveat(preset.poses),
            cases=[case_line(answer) for answer in found.answers],
            counted=counted,
            config=[pair for pair in flattened(preset.model_dump(mode="json")) if pair[1] != "None"],
            style=page_style(("studies.mitigations.report", "mitigations.css")),
        )
    )


def mitigation_tiles(found: MitigationsFindings) -> Iterator[tuple[str, str, str]]:
    """Headline figures: value, name, what it is measured against."""
    needing = [answer for answer in found.answers if answer.needs_help]
    won = [answer for answer in needing if answer.winner]
    judged = [one for one in found.advice if one.verdict != UNTRIED]
    yield f"{len(found.answers):,}", "cases", f"of {found.planned:,}; {len(found.remedies)} remedies on each"
    yield f"{len(won):,}", "a remedy wins", f"of {len(needing):,} that need help"
    for verdict in (NEARLY_RIGHT, NEARLY_WRONG):
        number = sum(one.verdict == verdict for one in judged)
        yield f"{number}", verdict, f"of {counted(len(judged), 'piece')} of common advice that were tried"


def advice_row(one: JudgedAdvice) -> dict[str, str]:
    """One piece of common advice in words."""
    tried = one.verdict != UNTRIED
    told = one.counts
    return {
        "words": one.words,
        "remedies": ", ".join(one.remedies),
        "verdict": one.verdict,
        "klass": VERDICT_CLASSES.get(one.verdict, "trades"),
        "share": f"{100 * one.share:.0f} % ({100 * one.low:.0f}-{100 * one.high:.0f})" if tried else "",
        "counts": " / ".join(f"{told[verdict]}" for verdict in TOLD_VERDICTS) if tried else "",
        "gain": gain_points(one.gain) if one.gain else "",
        "beside": "; ".join(filter(None, (depends_words(one), *harm_words(one)))),
    }


def polarised_row(row: PolarisedMaterial, ways: list[str]) -> list[str]:
    """One material."""
    gains = [gain_points(row.gains[way]) if way in row.gains else "" for way in ways]
    reflectances = (f"{row.reflectance_s:.3f}", f"{row.reflectance_p:.3f}")
    number = max((one.count for one in row.gains.values()), default=0)
    return [spoken(row.name), *reflectances, f"{100 * row.degree:.1f} %", f"{number}" if number else "", *gains]


def gain_points(gain: MedianEstimate) -> str:
    """In points, with the interval where there is one."""
    if gain.count == 1:
        return f"{100 * gain.value:+.1f}"
    return f"{100 * gain.value:+.1f} ({100 * gain.low:+.1f} to {100 * gain.high:+.1f})"
