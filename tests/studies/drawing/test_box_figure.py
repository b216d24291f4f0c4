"""Box plots: what is drawn of a box, and what is written of it."""

import re

import pytest

from studies.drawing import svg
from studies.drawing.box_figure import BoxGroup, BoxPanel, BoxSeries, box_figure, box_mark, box_words
from studies.statistics.boxes import TukeyBox

AXIS = svg.Scale(0.0, 100.0, 200.0, 0.0)
"""Two pixels a unit, upward."""


def test_a_box_stands_at_its_numbers():
    """Quartiles 40 and 60: from 120 down to 80 px, height 40; whiskers end at 20 and 180 px."""
    mark = str(box_mark(TukeyBox(50, 40, 60, 10, 90), 10.0, 8.0, AXIS, "fra", "told"))
    assert '<rect x="6" y="80" width="8" height="40" class="box fra">' in mark
    assert re.findall(r'y2="([\d.]+)" class="whisker', mark) == ["180", "180", "20", "20"]
    assert 'y1="100" x2="14" y2="100" class="box-median"' in mark


@pytest.mark.parametrize(
    ("box", "rects", "whiskers"),
    [(TukeyBox(7, low=-3, high=27), 0, 2), (TukeyBox(7, 5, 9), 1, 0), (TukeyBox(7, 5, 9, high=12), 1, 1)],
)
def test_what_is_not_known_is_not_drawn(box: TukeyBox, rects: int, whiskers: int):
    """No box without quartiles, no whisker without its end; each whisker has a line and a cap."""
    mark = str(box_mark(box, 0.0, 8.0, AXIS, "", ""))
    assert mark.count("<rect") == rects
    assert mark.count('class="whisker') == 2 * whiskers
    assert mark.count("box-median") == 1


def test_words_tell_what_is_known():
    """A negative whisker has a real minus sign."""
    assert box_words(TukeyBox(7, low=-3, high=27), ".1f") == "median 7.0, whiskers \u22123.0 to 27.0"
    assert (
        box_words(TukeyBox(7, 5.5, 9, high=12, count=15), "g")
        == "median 7, quartiles 5.5 to 9, whiskers up to 12, of 15"
    )


def test_medians_stand_below_every_group():
    """One number a series and group, a dash where there is no box."""
    panel = BoxPanel("D", "percent", ".1f", 0, 100, [BoxGroup("FRA", "fra", [TukeyBox(76.85), None])])
    figure = str(box_figure("Coverage", [panel], [BoxSeries("paper", "paper"), BoxSeries("here", "")]))
    numbers = re.findall(r'class="box-number mid">([^<]+)<', figure)
    assert numbers == ["76.8", "\u2013"]
    assert figure.count("box-number end") == 2
