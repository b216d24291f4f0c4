"""Fixtures of the planner's tests."""

import pytest

from tests.franbv.analytic_camera import AnalyticCamera, FreeArm


@pytest.fixture
def analytic_camera() -> type[AnalyticCamera]:
    """The camera's class, to be given a scene."""
    return AnalyticCamera


@pytest.fixture
def free_arm() -> type[FreeArm]:
    """The arm's class."""
    return FreeArm
