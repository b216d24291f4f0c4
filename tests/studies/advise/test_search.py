"""The order of trying, on a camera whose shares are known beforehand."""

import time
from dataclasses import dataclass, field
from pathlib import Path

from materials.catalog import material
from scenes.build import coupon_scene
from studies.advise.score_store import ScoreStore, ViewCounts
from studies.advise.scoring import SurfaceCount
from studies.advise.search import Search, Tried, best_advised
from studies.advise.setup import LightKey, Setup
from studies.advise.stored_light import LightStore
from studies.run.scene_settings import SubjectSettings
from tests.studies.advise.made_up import base

POSES = ("0,40,0.3", "90,40,0.3", "180,40,0.3")


class NoLight(LightStore):
    """Nothing is rendered; a rendering that is missing would take ten seconds."""

    def missing(self, key: LightKey, n_poses: int) -> int:
        """All, but for the base's."""
        return 0 if key == base().light else n_poses


@dataclass(eq=False)
class KnownShares(ScoreStore):
    """A camera on which laser 60 mW, high accuracy and a turn add up, and hole filling makes depth up."""

    measured: set[tuple[str, int]] = field(default_factory=set)

    def counts(self, setup: Setup, index: int) -> ViewCounts:
        """By what is set."""
        self.measured.add((setup.model_dump_json(), index))
        right, false = 0.5, 0.1
        right += 0.10 * (setup.sensor.imager.laser_power_mw == 60.0)
        right += 0.08 * (setup.sensor.preset == "high_accuracy")
        right += 0.12 * (setup.stand.roll_deg == 90.0)
        if setup.filters is not None and setup.filters.hole_filling is not None:
            right, false = right + 0.05, false + 0.3
        if setup.sprayed:
            right, false = 0.97, 0.0
        return (SurfaceCount(1.0, right - 0.01 * index, false, 2.0),)

    def has(self, setup: Setup, n_poses: int) -> bool:
        """What was measured before."""
        return all((setup.model_dump_json(), index) in self.measured for index in range(n_poses))

    def path(self, setup: Setup, index: int) -> Path:
        """Never there."""
        return Path("/nowhere")


def search(seconds: float, poses: tuple[str, ...] = POSES) -> Search:
    """With so much time."""
    lights = NoLight(
        Path("/nowhere"), SubjectSettings(part="plate"), coupon_scene("plate", material("iron:blasted")), poses, 0.0
    )
    lights.seconds.append(10.0)
    return Search(base(), KnownShares(lights, (0,)), time.monotonic() + seconds, seconds)


def names(tried: Tried) -> set[str]:
    """Of its factors."""
    return {remedy.factor.name for remedy in tried.remedies}


def test_with_time_enough_all_is_tried_and_the_three_that_add_up_are_found():
    """0.5 + 0.10 + 0.08 + 0.12, less 0.01 in the mean over poses."""
    one = search(3600.0)
    tried = one.run()
    assert one.untried == []
    assert one.n_poses == len(POSES)
    best = best_advised(tried)
    assert names(best) == {"laser", "preset", "roll"}
    assert abs(best.shares.right_share - 0.79) < 1e-9
    assert max(len(t.remedies) for t in tried) == 3
    assert any(names(t) == {"spray", "lamps"} for t in tried)


def test_where_no_camera_can_stand_a_remedy_is_left_out_and_named():
    """A pose two centimetres above the table looks up at a plate on a stage: nearer or farther along its line the
    camera comes elsewhere, farther below the table."""
    one = search(3600.0, ("0,-6,0.6", *POSES))
    tried = one.run()
    assert [remedy.title for remedy in one.impossible] == ["stand-off: 1.33 times"]
    assert all("1.33 times" not in {remedy.level.name for remedy in t.remedies} for t in tried)
    assert one.untried == []


def test_what_makes_depth_up_is_tried_on_top_of_what_helps_and_not_advised():
    """Hole filling adds 5 points of right depth and 30 of false depth."""
    tried = search(3600.0).run()
    assert any("filters" in names(t) and t.shares.right_share > 0.53 for t in tried)
    assert any("filters" in names(t) for t in tried if len(t.remedies) > 1)
    assert "filters" not in names(best_advised(tried))


def test_a_command_given_again_says_the_same_though_its_time_is_up():
    """What was measured counts, combinations as well."""
    first = search(3600.0)
    tried = [one.setup for one in first.run()]
    again = Search(base(), first.scores, time.monotonic() - 1.0, 3600.0)
    again.scores.lights.poses = POSES[:2]  # of which all are measured whatever the time
    assert [one.setup for one in again.run()] == tried


def test_without_time_the_first_poses_are_measured_and_new_light_is_named_as_untried():
    """Two poses whatever the time: the camera as it is set, all that needs no rendering, and what is possible at the
    best."""
    one = search(-1.0)
    tried = one.run()
    assert one.n_poses == 2
    assert all(t.shares.seen.shape == (2, 1) for t in tried)
    assert all(len(t.remedies) <= 1 for t in tried)
    untried = {remedy.title for remedy in one.untried}
    assert "roll: 90 deg" in untried
    assert "spray: matte" not in untried


def test_a_rendering_that_would_end_too_late_is_not_begun_but_a_cheaper_one_is():
    """Three poses of ten seconds: 75 % of 60 s hold one new light at a time; four times the pixels do not fit."""
    one = search(60.0)
    one.run()
    untried = {remedy.title for remedy in one.untried}
    assert "profile: 1280x720" in untried
    assert "roll: 90 deg" not in untried
