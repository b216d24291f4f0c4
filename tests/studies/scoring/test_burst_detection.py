"""Scores of bursts against pixels that were counted by hand, and against the camera's own truth."""

import numpy as np
import pytest

from franbv.frames import look_at
from franbv.model import model_with
from franbv.parameters import Parameters
from franbv.planners import fra, pb
from franbv.reflective_regions import Detection
from franbv.robust.regions import RobustDetection
from franbv.sensing import DepthBurst
from franbv.voxel_map import empty_map
from materials.catalog import material
from render.d435i import SensorSettings, SimulatedD435i
from render.labels.outcome import INVALID_SHARE, LEAST_FALSE
from scenes.build import coupon_scene
from studies.scoring.burst_detection import ViewTruth, measured_view, score_burst, summed_scores
from tests.franbv.analytic_camera import SENSOR

SHAPE = (SENSOR.height, SENSOR.width)
POSE = look_at(np.array([0.0, -0.4, 0.3]), np.zeros(3))


def mask(*pixels: tuple[int, int]) -> np.ndarray:
    """True at these rows and columns."""
    found = np.zeros(SHAPE, bool)
    for pixel in pixels:
        found[pixel] = True
    return found


def truth() -> ViewTruth:
    """Two holes, one of them over-exposed; three false depths of the part, one of them far off, one beside the part."""
    false = mask((7, 7), (8, 8), (9, 9))
    return ViewTruth(
        reflective=mask((5, 5), (5, 6)),
        over_exposed=mask((4, 4)),
        false_by_reflection=false | mask((20, 20)),
        false_depth=false | mask((20, 20), (21, 21)),
        part=~mask((20, 20), (21, 21)),
        depth=np.full(SHAPE, 0.4),
        error=np.where(mask((7, 7)), 0.05, 0.01),
    )


def burst() -> DepthBurst:
    """Of nothing in particular."""
    return DepthBurst(np.full((1, *SHAPE), 0.4, np.float32), SENSOR, POSE)


def found(holes: np.ndarray, false: np.ndarray, depth: float) -> RobustDetection:
    """A detection with these, all at one Z-depth."""
    places = POSE.apply((SENSOR.pixel_directions() * depth).reshape(-1, 3)).reshape(*SHAPE, 3)
    named = holes | false
    return RobustDetection(
        masks={},
        confidence_map=holes,
        silhouette=named,
        candidates=named,
        retained=named,
        pixels=np.argwhere(named)[:, ::-1],
        points=places[named],
        labels=np.full(int(named.sum()), -1),
        boxes=(),
        holes=holes,
        false_depth=false,
        places=np.where(named[..., None], places, np.nan),
        uncertainty=np.where(named, 0.01, np.nan),
    )


def test_shares_are_those_counted_by_hand():
    """Of three holes named one is true and one over-exposed; of four false depths two are reflection's, one of them on
    the part, and a third is wrong for another reason."""
    named = found(mask((5, 5), (4, 4), (1, 1)), mask((7, 7), (20, 20), (21, 21), (2, 2)), 0.42)
    scores = score_burst(named, burst(), truth())
    assert scores.holes_precision == pytest.approx(1 / 3)
    assert scores.highlight_precision == pytest.approx(2 / 3)
    assert scores.holes_recall == pytest.approx(1 / 2)
    assert scores.false_precision == pytest.approx(2 / 4)
    assert scores.any_false_precision == pytest.approx(3 / 4)
    assert scores.false_recall == pytest.approx(1 / 3)
    assert scores.far_recall == pytest.approx(1.0)


def test_point_errors_are_along_the_ray_and_on_the_part():
    """20 mm of Z are 20 mm times the ray's length per Z; a point beside the part counts for nothing."""
    scores = score_burst(found(mask((5, 5)), mask((20, 20)), 0.42), burst(), truth())
    assert scores.point_errors == pytest.approx([0.02 * np.linalg.norm(SENSOR.pixel_directions()[5, 5])])


def test_views_are_summed_before_shares_are_taken():
    """A view with one of one and a view with none of three make one of four."""
    one = score_burst(found(mask((5, 5)), mask(), 0.4), burst(), truth())
    other = score_burst(found(mask((1, 1), (1, 2), (1, 3)), mask(), 0.4), burst(), truth())
    both = summed_scores([one, other])
    assert both.holes_precision == pytest.approx(1 / 4)
    assert (both.views, both.holes_true, len(both.point_errors)) == (2, 4, 4)
    assert np.isnan(summed_scores([]).point_error)


def test_a_detector_of_holes_names_no_false_depth():
    """The paper's detection counts by what it retained."""
    robust = found(mask((5, 5)), mask((7, 7)), 0.4)
    plain = Detection(**{name: getattr(robust, name) for name in Detection.__dataclass_fields__})
    scores = score_burst(plain, burst(), truth())
    assert (scores.holes_named, scores.false_named) == (2, 0)
    assert np.isnan(scores.false_precision)


def test_truth_of_a_measured_view_agrees_with_what_was_measured():
    """Before a polished plate: no pixel is hole and false depth at once, holes have no depth and false depth has one,
    that is off; fra's detector can be scored on it."""
    scene = coupon_scene("plate", material("stainless_austenitic:polished"))
    camera, parameters = SimulatedD435i(scene, SensorSettings()), Parameters(n_frames=3)
    shot, told = measured_view(camera, look_at(np.array([0.25, 0.1, 0.3]), np.array([0.0, 0.0, 0.05])), 3)
    depth = shot.median_depth(INVALID_SHARE)
    assert told.part.any()
    assert np.all(depth[told.reflective | told.over_exposed] == 0)
    assert np.all(depth[told.false_depth] > 0)
    assert np.all(told.error[told.false_depth] > LEAST_FALSE)
    assert not np.any(told.false_by_reflection & ~told.false_depth)
    assert np.all(told.error[depth == 0] == 0)
    planner = fra()
    assert planner.recovery is not None
    model = model_with(empty_map(parameters), shot, planner, parameters, np.random.SeedSequence(0))
    scores = score_burst(planner.recovery.detect(shot, model, parameters), shot, told)
    assert scores.holes_true == told.reflective.sum()
    assert pb().detect is None
