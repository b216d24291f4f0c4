"""What a reconstruction reached, in words: the paragraph at the end of the command and at the head of the report."""

from collections.abc import Mapping
from typing import Any

from franbv.known_planners import PLANNERS
from studies.base.numbers_as_text import counted, millimetre_words, number, percent

STOP_WORDS = {
    "max_iterations": "the allowed number of next best views was taken",
    "stagnation": "the utility of the best view had stopped changing",
    "little_to_gain": "the best views promised too little of the surface",
    "no_reachable_view": "the arm could reach none of the candidate views",
    "recording_ended": "the recorded bursts were used up",
}
"""Why a run ended, by the name of the rule."""


def run_paragraph(run: Mapping[str, Any], timings: Mapping[str, Any]) -> str:
    """One readable paragraph; `run` is run.json, `timings` timings.json."""
    s = run["summary"]
    name = run["config"]["planner"]
    planner = PLANNERS[name].words if name in PLANNERS else name
    effort = f"{counted(s['acquisitions'], 'acquisition')} in {counted(s['nbv_iterations'], 'NBV iteration')}"
    if s["coverage_map_5mm"] is None:
        return _without_surface(run, timings, planner, effort)
    sentences = [
        f"{planner} took {effort}, after which the map holds {percent(s['coverage_map_5mm'])} of the visible surface "
        f"to within 5 mm ({percent(s['coverage_5mm'])} if all points ever seen count, refuted ones too).",
        f"The cloud lies {millimetre_words(s['accuracy_mm'])} off the true surface on average, "
        f"{millimetre_words(s['accuracy_median_mm'])} in the median; "
        f"its F-score is {number(s['f_score'], '.2f')} at 5 mm.",
        _recovery_sentence(s, name),
        f"It ended because {STOP_WORDS.get(s['stop'], s['stop'])}, after {timings['wall_s']:.0f} s.",
    ]
    return " ".join(sentence for sentence in sentences if sentence)


def is_open_loop(run: Mapping[str, Any]) -> bool:
    """Whether the run is a replay at poses that its planner did not choose."""
    return run.get("replay", {}).get("mode") == "open_loop"


def _without_surface(run: Mapping[str, Any], timings: Mapping[str, Any], planner: str, effort: str) -> str:
    """What can be said where nobody has told the true surface."""
    s = run["summary"]
    open_loop = is_open_loop(run)
    began = counted(s["recovery_activations"], "recovery", "recoveries")
    sentences = [
        f"{planner} {'was shown' if open_loop else 'took'} {effort}; how much of the surface that covers is unknown.",
        f"Reflective regions {'would have' if open_loop else 'have'} started {began}.",
        f"It ended because {STOP_WORDS.get(s['stop'], s['stop'])}, after {timings['wall_s']:.0f} s.",
    ]
    return " ".join(sentences)


def replay_words(found: Mapping[str, Any]) -> str:
    """How a replay's decisions compare with the recorded ones; `found` is what `franbv replay --json` prints."""
    loop = {"closed_loop": "The planner was given the bursts of the poses it asked for", "open_loop": "The poses are "
            "those of the recording, whatever the planner would have chosen"}[found["mode"]]  # fmt: skip
    difference = found["first_difference"]
    if difference is not None:
        return (
            f"{loop}; it decides otherwise than in the recording from acquisition {difference['acquisition'] + 1} on: "
            f"{difference['what']} was {_brief(difference['recorded'])} and is {_brief(difference['replayed'])}."
        )
    if found["decisions_equal"] is None:
        return f"{loop}; the recording holds no decisions to compare with."
    return f"{loop}; all {found['decisions']} decisions are those of the recording."


def _brief(value: Any) -> str:
    """A value of a decision, a pose by its position."""
    if isinstance(value, list):
        return "at (" + ", ".join(f"{row[3]:.4f}" for row in value[:3]) + ") m"
    return "nothing" if value is None else str(value)


def _recovery_sentence(summary: Mapping[str, Any], name: str) -> str:
    planner = PLANNERS[name].build() if name in PLANNERS else None
    if planner is not None and planner.recovery is None:
        if planner.detect is None:
            return "This planner looks for no reflective regions."
        return "It starts no recoveries: views of reflective regions are chosen as all others are."
    if not summary["recovery_activations"]:
        return "No reflective region started a recovery."
    change = 100 * summary["recovery_contribution"]
    return (
        f"Reflective regions started {counted(summary['recovery_activations'], 'recovery', 'recoveries')}, "
        f"whose views {'added' if change >= 0 else 'cost'} {abs(change):.1f} points of the map's coverage."
    )
