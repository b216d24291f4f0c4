"""In which order remedies are tried within the time that the user gives: one at a time, then together.

First the camera as it is set and all that is re-scored from its light, pose by pose; then spray, without which nobody
knows what is possible, whatever the time; remedies that need new light, in the table's order; then a sequential search
over what helped: pairs, then what the best pair gains by a third. Where time ends a step, what was measured at all
poses counts and nothing else, so that all stay paired.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from studies.advise.factors import LightNeed, Remedy, go_together, remedies_for, set_up_with
from studies.advise.paired_shares import SurfaceShares
from studies.advise.score_store import ScoreStore
from studies.advise.setup import Setup

STORED_UNTIL, NEW_UNTIL, SEARCH_UNTIL = 0.4, 0.75, 0.88
"""Shares of the time at which the steps end (choice: what the steps before leave over goes to the next one; the rest is
for pictures and page)."""
LEAST_POSES = 2
"""Measured whatever the time: fewer have no interval."""
COMBINED = 6
"""Remedies that the search puts together, the best ones (choice: 15 pairs)."""
MOST_TOGETHER = 3
"""Remedies in a combination."""
FIRST_RENDER_S = 8.0
"""What a rendering is taken to cost before any was made [s] (choice: two cores, 640x360)."""
BIG_PROFILE = {"1280x720": 4.0, "848x480": 1.8}
"""What a rendering of these profiles costs more than one of 640x360 [-]: their pixels."""


@dataclass(frozen=True, eq=False)
class Tried:
    """A setup that was measured at all poses."""

    remedies: tuple[Remedy, ...]
    """None for the camera as it is set."""
    setup: Setup
    shares: SurfaceShares

    @property
    def is_ceiling(self) -> bool:
        """Whether the part itself is changed."""
        return any(remedy.factor.is_ceiling for remedy in self.remedies)


@dataclass(eq=False)
class Search:
    """Tries remedies until time is up."""

    base: Setup
    scores: ScoreStore
    ends: float
    """When all of the time is gone, on `time.monotonic` [s]."""
    total_s: float
    """All of the time [s]."""
    has_lamps: bool = True
    on_step: Callable[[str], None] = lambda step: None
    """Called with what is measured next, for people who watch."""
    n_poses: int = 0
    """Poses that count."""
    untried: list[Remedy] = field(default_factory=list)
    """For want of time."""
    impossible: list[Remedy] = field(default_factory=list)
    """Since no camera can stand there from one of the poses."""
    _found: dict[str, Tried] = field(default_factory=dict)

    def run(self) -> list[Tried]:
        """All that was measured, the camera as it is set first, then in the order of trying."""
        asked = [r for r in remedies_for(self.base) if self.has_lamps or r.factor.name not in NEED_LAMPS]
        self.impossible = [remedy for remedy in asked if not self._can_stand((remedy,))]
        remedies = [remedy for remedy in asked if remedy not in self.impossible]
        stored = [remedy for remedy in remedies if remedy.factor.need is not LightNeed.NEW]
        self._pose_by_pose([(), *((remedy,) for remedy in stored)])
        for remedy in remedies:
            until = np.inf if remedy.factor.is_ceiling else NEW_UNTIL
            if remedy.factor.need is LightNeed.NEW and not self._try((remedy,), until):
                self.untried.append(remedy)
        for combination in filter(self._can_stand, self._combinations()):
            self._try(combination, SEARCH_UNTIL)  # what is known counts, also when time is up
        return list(self._found.values())

    @property
    def singles(self) -> list[Tried]:
        """What was tried one at a time."""
        return [tried for tried in self._found.values() if len(tried.remedies) == 1]

    def _can_stand(self, remedies: tuple[Remedy, ...]) -> bool:
        setup, can_stand = set_up_with(self.base, remedies), self.scores.lights.can_stand
        second = setup.second_look
        return can_stand(setup.first_look.light) and (second is None or can_stand(second.light))

    def _pose_by_pose(self, combinations: Sequence[tuple[Remedy, ...]]) -> None:
        """A pose's light is read once for all of them."""
        poses = len(self.scores.lights.poses)
        for index in range(poses):
            known = all(self.scores.path(set_up_with(self.base, c), index).exists() for c in combinations)
            if index >= LEAST_POSES and not known and not self._in_time(STORED_UNTIL):
                break
            for number, remedies in enumerate(combinations, start=1):
                self.on_step(f"pose {index + 1} of {poses}, setting {number} of {len(combinations)}")
                self.scores.counts(set_up_with(self.base, remedies), index)
            self.n_poses = index + 1
        for remedies in combinations:
            self._keep(remedies, set_up_with(self.base, remedies))

    def _try(self, remedies: tuple[Remedy, ...], until: float) -> bool:
        """Measure the remedies together, if they are known or time allows; whether that was so."""
        setup = set_up_with(self.base, remedies)
        if not self.scores.has(setup, self.n_poses) and not self._in_time(until, self._seconds(setup)):
            return False
        self.on_step(" and ".join(remedy.title for remedy in remedies))
        self._keep(remedies, setup)
        return True

    def _keep(self, remedies: tuple[Remedy, ...], setup: Setup) -> None:
        shares = SurfaceShares.of(self.scores.all_counts(setup, self.n_poses))
        self._found.setdefault(setup.model_dump_json(), Tried(remedies, setup, shares))

    def _seconds(self, setup: Setup) -> float:
        """What rendering for it will take, by what renderings took so far [s]."""
        lights, looks = self.scores.lights, [setup.first_look, setup.second_look]
        each = sum(lights.seconds) / len(lights.seconds) if lights.seconds else FIRST_RENDER_S
        return sum(
            each * BIG_PROFILE.get(look.sensor.profile, 1.0) * lights.missing(look.light, self.n_poses)
            for look in looks
            if look is not None
        )

    def _in_time(self, until: float, seconds: float = 0.0) -> bool:
        """Whether a step that takes so long ends before this share of the time."""
        return until == np.inf or time.monotonic() + seconds <= self.ends - (1 - until) * self.total_s

    def _combinations(self) -> Iterator[tuple[Remedy, ...]]:
        """Spray under other exposures and lamps, since a white part may drown where a dark one did not; pairs of the
        best level of each factor that helped, by what they gained; the best of these with one more, up to three; and
        that with other levels of its remedies that need no new light."""
        for ceiling in (tried.remedies[0] for tried in self.singles if tried.is_ceiling):
            others = (tried.remedies[0] for tried in self.singles if tried.remedies[0].factor.name in WITH_SPRAY)
            yield from ((ceiling, other) for other in others)
        best = [tried.remedies[0] for tried in best_of_factors(self.singles, self._base)]
        yield from (pair for pair in combinations(best[:COMBINED], 2) if go_together(pair))
        # What adds false depth by itself may not do so on top of what takes it away.
        others = [tried.remedies[0] for tried in best_of_factors(self.singles, self._base, honest=False)]
        for size in range(2, MOST_TOGETHER + 1):
            top = self._best()
            if len(top) == size - 1:
                yield from ((*top, other) for other in others if go_together((*top, other)))
        top = self._best()
        for place, remedy in enumerate(top):
            if len(top) > 1 and remedy.factor.need is not LightNeed.NEW:
                for level in remedy.factor.levels:
                    yield (*top[:place], Remedy(remedy.factor, level), *top[place + 1 :])

    @property
    def _base(self) -> Tried:
        return next(iter(self._found.values()))

    def _best(self) -> tuple[Remedy, ...]:
        return best_advised(list(self._found.values())).remedies


WITH_SPRAY = ("set-point", "HDR pair", "lamps")
"""Factors that are tried on the sprayed part as well."""
NEED_LAMPS = ("lamps", "placing of lamps")
"""Factors that are nothing where no lamp is."""


def best_of_factors(singles: Sequence[Tried], base: Tried, honest: bool = True) -> list[Tried]:
    """The best level of each factor, those that have more right depth than the base, the best first. honest: none that
    adds more false depth than right depth."""
    best: dict[str, Tried] = {}
    for tried in sorted(singles, key=by_right_share):
        factor = tried.remedies[0].factor
        better = tried.shares.right_share > base.shares.right_share
        if better and not factor.is_ceiling and not (honest and makes_it_up(tried.shares, base.shares)):
            best.setdefault(factor.name, tried)
    return list(best.values())


def best_advised(tried: Sequence[Tried], among: Sequence[Tried] | None = None) -> Tried:
    """Of those that leave the part as it is, the one with most right depth; none that makes depth up. tried: all that
    was, the camera as it is set first; among: those to choose from, None = all."""
    advised = [one for one in (tried if among is None else among) if not one.is_ceiling]
    return min((one for one in advised if not makes_up_depth(one, tried)), key=by_right_share)


def makes_up_depth(one: Tried, tried: Sequence[Tried]) -> bool:
    """Whether more false depth than right depth comes of it: beside the camera as it is set, or of what it adds to a
    part of its remedies that was tried without the rest."""
    names = _titles(one)
    return any(makes_it_up(one.shares, other.shares) for other in tried if _titles(other) < names)


def _titles(tried: Tried) -> frozenset[str]:
    return frozenset(remedy.title for remedy in tried.remedies)


def makes_it_up(shares: SurfaceShares, base: SurfaceShares) -> bool:
    """Whether more false depth than right depth comes of it, as of hole filling on a mirror. Choice: who uses depth can
    tell a hole, and cannot tell false depth."""
    more_right, more_false = shares.right_share - base.right_share, shares.false_share - base.false_share
    return more_false > max(more_right, 0.0)


def by_right_share(tried: Tried) -> tuple[float, float, int]:
    """Most right depth first; of equals less false depth, then fewer remedies."""
    return -tried.shares.right_share, tried.shares.false_share, len(tried.remedies)
