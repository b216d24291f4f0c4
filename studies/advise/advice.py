"""The answer: every remedy's shares, ranking, the best combination, and what to do in a sentence."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from studies.advise.factors import LightNeed
from studies.advise.paired_shares import SurfaceShares
from studies.advise.search import Tried, best_advised, by_right_share, makes_up_depth

WORTH_IT = 0.02
"""Gain of right depth below which a remedy is not advised, told apart or not (choice: two points; other noise moves a
view's share as much, docs/sensor.md)."""
NEEDED = 0.1
"""Gain of right depth from which on a remedy is needed though shine is not what is in the way (choice: ten points;
less is what another pose brings on any part)."""
TIME_NAMES = {LightNeed.STORED: "stored", LightNeed.SCALED: "scaled", LightNeed.NEW: "new"}
"""How `advice.json` says what light a remedy needs."""


@dataclass(frozen=True)
class RemedyScore:
    """One setup in the ranking."""

    name: str
    """Of its factors."""
    level: str
    words: str
    """What to do."""
    right_share: float
    lo: float
    """95 % interval of the right share, over poses and seeds."""
    hi: float
    false_share: float
    hole_share: float
    error_mm: float | None
    """Median over the surface with depth, mean over views [mm]."""
    gain: float
    """Right share beyond the camera as it is set."""
    gain_lo: float
    gain_hi: float
    verdict: str
    """`helps`; `trades`: adds right depth, and more false depth, or does so to a part of its remedies; `hurts`; or
    `level` with the camera as it is set."""
    rank: int
    """Those of one rank are not told apart from the first of them."""
    cost: str
    light: str
    """`stored`, `scaled` or `new`."""
    is_ceiling: bool
    """Changes the part itself."""


@dataclass(frozen=True)
class Advice:
    """All that is answered."""

    remedies: tuple[RemedyScore, ...]
    """One at a time, the best first."""
    combinations: tuple[RemedyScore, ...]
    """Two or three together, the best first."""
    base: RemedyScore
    """The camera as it is set."""
    best: RemedyScore
    """Of all that leave the part as it is; the base where nothing is worth it."""
    ceiling: RemedyScore | None
    """The best of the sprayed part; None where it was not tried."""
    kind: str
    """`nothing needed`, `remedy`, `only spray` or `nothing helps`."""
    shine_matters: bool
    """Whether spray adds right depth: to the camera as it is set, or to a setting that was tried with and without."""
    beside: RemedyScore | None
    """What would help though nothing is needed, on matte parts as well; None where nothing would."""
    settings: int
    """Setups that were compared."""
    poses: int
    seeds: int


def advice_from(tried: Sequence[Tried], poses: int, seeds: int) -> tuple[Advice, Tried]:
    """The answer, and the setup that is advised. tried: the camera as it is set first."""
    base = tried[0]
    singles = ranked([one for one in tried if len(one.remedies) == 1], tried)
    several = ranked([one for one in tried if len(one.remedies) > 1], tried)
    # What has most right depth in the mean may not be told apart where something smaller is.
    found = best_advised(tried, [base, *(one for one in tried[1:] if _is_worth_it(one.shares, base.shares))])
    ceiling = min((one for one in tried if one.is_ceiling), key=by_right_share, default=None)
    matters = shine_matters(tried)
    kind = verdict_kind(base.shares, found.shares, ceiling.shares if ceiling else None, matters)
    advised = found if kind == "remedy" else base
    answer = Advice(
        tuple(singles),
        tuple(several),
        remedy_score(base, tried, 0),
        remedy_score(advised, tried, 0),
        remedy_score(ceiling, tried, 0) if ceiling else None,
        kind,
        matters,
        remedy_score(found, tried, 0) if kind == "nothing needed" and found is not base else None,
        len(tried),
        poses,
        seeds,
    )
    return answer, advised


def shine_matters(tried: Sequence[Tried]) -> bool:
    """Whether spray is worth it beside any setting that was tried with and without it. A white part may drown in light
    in which a dark one does not, so that spray by itself tells too little."""
    without = {frozenset(remedy.title for remedy in one.remedies): one for one in tried}
    for sprayed in (one for one in tried if one.is_ceiling):
        others = frozenset(remedy.title for remedy in sprayed.remedies if not remedy.factor.is_ceiling)
        if _is_worth_it(sprayed.shares, without.get(others, tried[0]).shares):
            return True
    return False


def verdict_kind(base: SurfaceShares, best: SurfaceShares, ceiling: SurfaceShares | None, shine: bool) -> str:
    """What to say: see `Advice.kind`.

    Nothing is needed where shine does not matter and no remedy adds as much as NEEDED.
    """
    helps = _is_worth_it(best, base)
    if ceiling is not None and not shine and best.right_share - base.right_share < NEEDED:
        return "nothing needed"
    if helps:
        return "remedy"
    return "only spray" if ceiling is not None and _is_worth_it(ceiling, base) else "nothing helps"


def _is_worth_it(shares: SurfaceShares, base: SurfaceShares) -> bool:
    gain, low, _ = shares.gain_over(base)
    return low > 0 and gain >= WORTH_IT


def ranked(some: Sequence[Tried], tried: Sequence[Tried]) -> list[RemedyScore]:
    """Some of what was tried, the best first. A rank begins with the first that is told apart from the one that the
    rank before began with."""
    order = sorted(some, key=by_right_share)
    scores: list[RemedyScore] = []
    leader, rank = None, 0
    for place, one in enumerate(order, start=1):
        if leader is None or leader.shares.gain_over(one.shares)[1] > 0:
            leader, rank = one, place
        scores.append(remedy_score(one, tried, rank))
    return scores


def remedy_score(one: Tried, tried: Sequence[Tried], rank: int) -> RemedyScore:
    """One setup held against all that was tried, the camera as it is set first."""
    shares, remedies, base = one.shares, one.remedies, tried[0]
    gain, gain_lo, gain_hi = shares.gain_over(base.shares) if remedies else (0.0, 0.0, 0.0)
    lo, hi = shares.interval
    needs = [remedy.factor.need for remedy in remedies]
    costs = [remedy.factor.cost for remedy in remedies if remedy.factor.cost != "nothing"]
    return RemedyScore(
        name=" + ".join(remedy.factor.name for remedy in remedies) or "as set",
        level=" + ".join(remedy.level.name for remedy in remedies) or "as set",
        words=joined_words([remedy.level.words for remedy in remedies]) or "leave the camera as it is set",
        right_share=shares.right_share,
        lo=lo,
        hi=hi,
        false_share=shares.false_share,
        hole_share=shares.hole_share,
        error_mm=shares.error_mm,
        gain=gain,
        gain_lo=gain_lo,
        gain_hi=gain_hi,
        verdict=_verdict(gain_lo, gain_hi, makes_up_depth(one, tried)),
        rank=rank,
        cost=", ".join(dict.fromkeys(costs)) or "nothing",
        light=TIME_NAMES[max(needs, key=list(LightNeed).index)] if needs else "stored",
        is_ceiling=one.is_ceiling,
    )


def _verdict(gain_lo: float, gain_hi: float, made_up: bool) -> str:
    if gain_lo > 0:
        return "trades" if made_up else "helps"
    return "hurts" if gain_hi < 0 else "level"


def joined_words(words: Sequence[str]) -> str:
    """`a`, `a and b`, `a, b and c`."""
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1]))) if words else ""


def advice_json(advice: Advice) -> dict[str, Any]:
    """For `--json` and `advice.json`."""
    return {
        "settings": advice.settings,
        "poses": advice.poses,
        "seeds": advice.seeds,
        "kind": advice.kind,
        "shine_matters": advice.shine_matters,
        "beside": asdict(advice.beside) if advice.beside else None,
        "remedies": [asdict(one) for one in advice.remedies],
        "combinations": [asdict(one) for one in advice.combinations],
        "best": {"levels": advice.best.level, **asdict(advice.best)},
        "base": asdict(advice.base),
        "ceiling": asdict(advice.ceiling) if advice.ceiling else None,
    }


def read_advice(stored: dict[str, Any]) -> Advice:
    """The answer as `advice_json` wrote it."""
    best = {key: value for key, value in stored["best"].items() if key != "levels"}
    return Advice(
        tuple(RemedyScore(**one) for one in stored["remedies"]),
        tuple(RemedyScore(**one) for one in stored["combinations"]),
        RemedyScore(**stored["base"]),
        RemedyScore(**best),
        RemedyScore(**stored["ceiling"]) if stored["ceiling"] else None,
        stored["kind"],
        stored["shine_matters"],
        RemedyScore(**stored["beside"]) if stored["beside"] else None,
        stored["settings"],
        stored["poses"],
        stored["seeds"],
    )
