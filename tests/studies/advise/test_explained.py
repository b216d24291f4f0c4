"""Causes by surface and by face, on maps that are known."""

import numpy as np
import pytest

from render.labels.causes import LEGEND, Cause
from studies.advise.explained import AFTERWARDS, ExplainedView, face_rows, losses, with_outcome
from studies.advise.pictures import AFTERWARDS_COLOUR, losses_picture, outcome_picture
from studies.advise.scoring import NO_DEPTH, RIGHT_DEPTH, WRONG_DEPTH, MeasuredPart
from studies.advise.stored_light import FACINGS, SeenPart

AREA = np.array([[4.0, 2.0, 0.0], [1.0, 1.0, 2.0]], np.float32)
"""Ten square metres of part in five pixels, and one pixel of background."""
OUTCOME = np.array([[RIGHT_DEPTH, NO_DEPTH, NO_DEPTH], [WRONG_DEPTH, NO_DEPTH, RIGHT_DEPTH]], np.uint8)
LABELS = np.array(
    [
        [Cause.REFLECTION_DARK, Cause.REFLECTION_DARK, Cause.OCCLUSION],
        [Cause.FALSE_DEPTH_REFLECTION, Cause.MEASURED, Cause.MEASURED],
    ],
    np.uint8,
)
BODY = np.array([[0, 0, 1], [0, 0, 2]], np.uint8)
FACING = np.array([[0, 0, 0], [1, 1, 0]], np.uint8)


def explained() -> ExplainedView:
    """With the outcome after a filter that mended one dark hole and lost one pixel."""
    none = np.zeros(AREA.shape, np.float32)
    part = MeasuredPart(SeenPart(none, AREA, BODY, FACING), OUTCOME, none, none, OUTCOME)
    return ExplainedView(np.full(AREA.shape, 100, np.uint8), OUTCOME, with_outcome(LABELS, part), AREA, BODY, FACING)


def test_only_surface_without_right_depth_has_a_cause():
    """What a filter mended is measured; what it lost is named so; the background has none."""
    wanted = [[Cause.MEASURED, Cause.REFLECTION_DARK, Cause.MEASURED]]
    wanted += [[Cause.FALSE_DEPTH_REFLECTION, Cause.UNMEASURED, Cause.MEASURED]]
    assert explained().cause.tolist() == wanted


def test_losses_are_shares_of_the_surface_the_largest_first():
    """2, 1 and 1 of 10 m^2."""
    found = losses([explained()])
    assert found == pytest.approx({"reflection_dark": 0.2, "false_depth_reflection": 0.1, AFTERWARDS: 0.1})
    assert next(iter(found)) == "reflection_dark"


def test_faces_are_told_by_body_and_side():
    """Body 0 above: 4 of 6 m^2 right; its +x side: none of 2; body 2: all of 2."""
    rows = {row.name: row for row in face_rows([explained()], [explained()], ["block", "table", "screw"])}
    assert rows[f"block, {FACINGS[0]}"].right_before == pytest.approx(4 / 6)
    assert rows[f"block, {FACINGS[0]}"].lost_to == "reflection_dark"
    assert rows[f"block, {FACINGS[1]}"].right_after == 0.0
    assert rows[f"screw, {FACINGS[0]}"].lost_to == ""
    assert sum(row.surface for row in rows.values()) == pytest.approx(1.0)


def test_pictures_colour_the_part_and_dim_what_is_around_it():
    """The legend's colours."""
    causes, outcome = losses_picture(explained()), outcome_picture(explained())
    assert tuple(causes[0, 1]) == LEGEND[Cause.REFLECTION_DARK].colour
    assert tuple(causes[1, 1]) == AFTERWARDS_COLOUR
    assert tuple(causes[0, 2]) == tuple(outcome[0, 2]) == (35, 35, 35)
    assert tuple(outcome[1, 0]) != tuple(outcome[0, 0])
