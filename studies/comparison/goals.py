"""The goals of a comparison: how near the paper's figures ours were to come, each with its interval and a verdict."""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from studies.comparison.paper import ACTIVATIONS, FINAL_COVERAGE, PAPER_METHODS, PAPER_PARTS, paper_lead, paper_order
from studies.comparison.statistics import Comparison
from studies.statistics.intervals import LEVEL, least_p
from studies.statistics.medians import MedianEstimate, first_less_second, least_step_down

LEAD_SLACK, LEVEL_SLACK, ACTIVATION_SLACK = 0.08, 0.10, 2.0
"""How far from the paper's medians ours may lie: FRA's lead over PB [-], the coverage of one method [-],
activations [-] (choice, set before any run)."""
MET, NOT_MET, TOO_FEW_RUNS = "met", "not met", "too few runs"

Estimates = list[MedianEstimate | None]
"""None where there are no runs."""


@dataclass(frozen=True)
class Goal:
    """What the runs were to show."""

    name: str
    """In the JSON."""
    words: str
    """For people."""
    methods: tuple[str, ...]
    """Planners that it is about."""
    wanted: str
    """The paper's figure and what is near enough."""
    scale: float
    """Of the figures, to be read by people: 100 = points of coverage."""
    form: str
    """How they are written."""
    estimates: Callable[[Comparison], Estimates]
    """What the runs say: one figure, or several that are judged together."""
    holds: Callable[[Sequence[float]], bool]
    """Whether they are as wanted."""


@dataclass(frozen=True)
class JudgedGoal:
    """A goal beside what the runs say."""

    goal: Goal
    found: Estimates
    verdict: str
    """Met or not met by the figures themselves, whose intervals tell how surely. Too few runs: their range holds the
    median with less than 95 %."""


def judge(comparison: Comparison, planners: Collection[str] = PAPER_METHODS) -> list[JudgedGoal]:
    """Every goal about the planners that the study has, also those that have no runs."""
    goals = [goal for goal in GOALS if set(goal.methods) <= set(planners)]
    return [JudgedGoal(goal, found := goal.estimates(comparison), _verdict(goal, found)) for goal in goals]


def goals_json(judged: Sequence[JudgedGoal]) -> dict[str, dict[str, Any]]:
    """By the goals' names: our figure with its interval, runs and verdict; lists where several are judged together."""
    return {j.goal.name: {"wanted": j.goal.wanted, **_figures(j.found), "verdict": j.verdict} for j in judged}


def rising(activations: Sequence[float]) -> bool:
    """A <= B < C <= D."""
    a, b, c, d = activations
    return a <= b < c <= d


def _verdict(goal: Goal, found: Estimates) -> str:
    known = [estimate for estimate in found if estimate]
    if len(known) < len(found) or any(least_p(estimate.count) > LEVEL for estimate in known):
        return TOO_FEW_RUNS
    return MET if goal.holds([estimate.value for estimate in known]) else NOT_MET


def _figures(found: Estimates) -> dict[str, Any]:
    rows = list(_row(found))
    figures = {key: [row[key] for row in rows] for key in rows[0]}
    return figures if len(rows) > 1 else rows[0]


def _row(found: Estimates) -> Iterator[dict[str, Any]]:
    for e in found:
        yield {
            "ours": e.value if e else None,
            "ci95": [e.low, e.high] if e else None,
            "runs": e.count if e else 0,
        }


def _order(part: str) -> Goal:
    order = paper_order(part)
    return Goal(
        f"order_{part.lower()}",
        f"{part}: methods in the paper's order, smallest step down",
        order,
        f"{' > '.join(arm.upper() for arm in order)}, each step above 0",
        100.0,
        "+z.1f",
        lambda comparison: [comparison.of_medians(part, order, least_step_down)],
        lambda found: found[0] > 0,
    )


def _lead(part: str) -> Goal:
    paper = paper_lead(part, "pb")
    return Goal(
        f"fra_less_pb_{part.lower()}",
        f"{part}: FRA less PB",
        ("fra", "pb"),
        _near(paper, LEAD_SLACK, "+.1f"),
        100.0,
        "+z.1f",
        lambda comparison: [comparison.of_medians(part, ("fra", "pb"), first_less_second)],
        lambda found: abs(found[0] - paper) <= LEAD_SLACK,
    )


def _level(part: str, arm: str) -> Goal:
    paper = FINAL_COVERAGE[part][arm].median
    return Goal(
        f"{arm}_{part.lower()}",
        f"{part}: {arm.upper()} covers",
        (arm,),
        _near(paper, LEVEL_SLACK, ".1f"),
        100.0,
        ".1f",
        lambda comparison: [comparison.median(part, arm)],
        lambda found: abs(found[0] - paper) <= LEVEL_SLACK,
    )


def _near(paper: float, slack: float, form: str) -> str:
    return f"{100 * paper:{form}}, within {100 * slack:.0f} points"


def _activations(part: str) -> Goal:
    paper = ACTIVATIONS[part].median
    return Goal(
        f"activations_{part.lower()}",
        f"{part}: recoveries a run",
        ("fra",),
        f"{paper:g}, within {ACTIVATION_SLACK:g}",
        1.0,
        "g",
        lambda comparison: [_median_activations(comparison, part)],
        lambda found: abs(found[0] - paper) <= ACTIVATION_SLACK,
    )


def _rise() -> Goal:
    return Goal(
        "activations_rise",
        "Recoveries rise from part to part",
        ("fra",),
        "A \u2264 B < C \u2264 D",
        1.0,
        "g",
        lambda comparison: [_median_activations(comparison, part) for part in PAPER_PARTS],
        rising,
    )


def _median_activations(comparison: Comparison, part: str) -> MedianEstimate | None:
    return comparison.median(part, "fra", "recovery_activations")


GOALS = (
    *map(_order, PAPER_PARTS),
    *map(_lead, PAPER_PARTS),
    *(_level("D", arm) for arm in ("pb", "re")),
    *map(_activations, PAPER_PARTS),
    _rise(),
)
"""All of them."""
