"""Precision and recall from pixel counts by hand, and what is said where there is no curve."""

import numpy as np
import pytest

from studies.thresholds.report.precision_recall import precision_recall, traced_parameter
from studies.thresholds.report.precision_recall_figure import detector_curves

SETTINGS = [{"n_frames": n_frames, "cluster_min_samples": minimum} for n_frames in (1, 5) for minimum in (20, 5, 8)]
PIXELS = np.array(
    [[0, 0, 100], [60, 80, 100], [20, 25, 100],
     [0, 5, 100], [50, 200, 100], [30, 60, 100]]
)  # fmt: skip
"""Right, in regions, holes: the first setting marks nothing, the fourth nothing right."""


def test_points_by_hand():
    """Recall is right over holes, precision right over marked; a curve rises in what it traces."""
    found = precision_recall(SETTINGS, PIXELS)
    assert found.traced == "cluster_min_samples"
    one, five = found.curves
    assert [(p.view_setting, p.recall, p.precision) for p in one] == [(1, 0.6, 0.75), (2, 0.2, 0.8)]
    assert [(p.view_setting, p.recall, p.precision) for p in five] == [(4, 0.5, 0.25), (5, 0.3, 0.5), (3, 0.0, 0.0)]
    assert (found.holes_px, found.settings) == (100, 6)


def test_what_is_traced():
    """The clustering's minimum wherever it has two values, else what has most; words keep their order."""
    assert traced_parameter(SETTINGS) == "cluster_min_samples"
    held = [{"cluster_min_samples": 5, "n_frames": n, "located_on": on} for n in (1, 2, 3) for on in ("b", "a")]
    assert traced_parameter(held) == "n_frames"
    words = [{"located_on": "b"}, {"located_on": "a"}]
    assert [p.view_setting for p in precision_recall(words, PIXELS[1:3]).curves[0]] == [0, 1]
    assert traced_parameter([{"n_frames": 3}]) is None
    assert traced_parameter([{}]) is None


def test_the_chart():
    """Every setting that marks anything is a dot with its numbers and its own mark; the others are counted."""
    shown = detector_curves(precision_recall(SETTINGS, PIXELS), {0: "certified", 2: "chosen", 5: "certified"})
    chart = str(shown.chart)
    assert chart.count("<circle") == 5
    assert chart.count("setting plain") == 3
    assert chart.count("setting certified") == 1
    assert chart.index("setting certified") < chart.index("setting chosen")  # the chosen one is drawn above it
    assert "n_frames 1, cluster_min_samples 8: finds 20.0 % of the reflective holes&#39; pixels, 80.0 % of its" in chart
    assert [words for _, words in shown.key] == ["n_frames 1", "n_frames 5"]
    assert len({colour for colour, _ in shown.key}) == 2
    assert shown.words == (
        "Settings that mark no pixel, 1 of them certified, have no precision and are not drawn: 1 of 6."
    )


@pytest.mark.parametrize(
    ("settings", "pixels", "words"),
    [
        (SETTINGS[:2], [[0, 9, 0], [0, 0, 0]], "No view shows a reflective hole"),
        (SETTINGS[:2], [[0, 0, 70], [0, 0, 70]], "none of the 70 pixels of reflective holes is found"),
        ([{}], [[30, 40, 60]], "as it is: finds 50.0 % of the reflective holes' pixels, 75.0 % of its regions' pixels"),
        ([{}], [[0, 0, 60]], "No setting marks a pixel"),
    ],
)
def test_words_instead_of_a_chart(settings, pixels, words):
    """Without holes there is no recall, without regions no precision, and one setting is no curve."""
    shown = detector_curves(precision_recall(settings, np.array(pixels)), {})
    assert shown.chart is None
    assert words in shown.words


def test_nothing_right():
    """Where all that is marked is wrong both are zero, and the axes still have a length."""
    shown = detector_curves(precision_recall(SETTINGS[:2], np.array([[0, 4, 9], [0, 7, 9]])), {})
    assert str(shown.chart).count("<circle") == 2
    assert "nan" not in str(shown.chart)
