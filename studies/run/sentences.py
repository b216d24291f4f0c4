"""What a reconstruction reached, in words: the paragraph at the end of the command and at the head of the report."""

from collections.abc import Mapping
from typing import Any

from franbv.planners import PLANNERS
from studies.base.numbers_as_text import counted, millimetre_words, number, percent

STOP_WORDS = {
    "max_iterations": "the allowed number of next best views was taken",
    "stagnation": "the utility of the best view had stopped changing",
    "no_reachable_view": "the arm could reach none of the candidate views",
}
"""Why a run ended, by the name of the rule."""


def run_paragraph(run: Mapping[str, Any], timings: Mapping[str, Any]) -> str:
    """One readable paragraph; `run` is run.json, `timings` timings.json."""
    s = run["summary"]
    name = run["config"]["planner"]
    planner = PLANNERS[name].words if name in PLANNERS else name
    effort = f"{counted(s['acquisitions'], 'acquisition')} in {counted(s['nbv_iterations'], 'NBV iteration')}"
    sentences = [
        f"{planner} took {effort}, after which the map holds {percent(s['coverage_map_5mm'])} of the visible surface "
        f"to within 5 mm ({percent(s['coverage_5mm'])} if all points ever seen count, refuted ones too).",
        f"The cloud lies {millimetre_words(s['accuracy_mm'])} off the true surface on average, "
        f"{millimetre_words(s['accuracy_median_mm'])} in the median; "
        f"its F-score is {number(s['f_score'], '.2f')} at 5 mm.",
        _recovery_sentence(s),
        f"It ended because {STOP_WORDS.get(s['stop'], s['stop'])}, after {timings['wall_s']:.0f} s.",
    ]
    return " ".join(sentence for sentence in sentences if sentence)


def _recovery_sentence(summary: Mapping[str, Any]) -> str:
    if not summary["recovery_activations"]:
        return "No reflective region started a recovery."
    change = 100 * summary["recovery_contribution"]
    return (
        f"Reflective regions started {counted(summary['recovery_activations'], 'recovery', 'recoveries')}, "
        f"whose views {'added' if change >= 0 else 'cost'} {abs(change):.1f} points of the map's coverage."
    )
