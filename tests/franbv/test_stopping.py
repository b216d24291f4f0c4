"""Stop rules on hand-made utility histories."""

import pytest

from franbv.parameters import Parameters
from franbv.stopping import StopReason, stop_reason

FLAT = [100.0, 100.5, 100.2, 99.9, 100.1, 100.4]


@pytest.mark.parametrize(
    ("utilities", "expected"),
    [
        ([], None),
        (FLAT[:5], None),  # four changes below 1 %: one too few
        (FLAT, StopReason.STAGNATION),  # five
        ([100.0, 200.0, *FLAT[1:5]], None),  # the third change is 99.5: only three small ones since
        ([1000.0, 9.0, 18.0, 9.0, 18.0, 9.0, 18.0], StopReason.STAGNATION),  # 9 is below 1 % of the largest so far
        ([9.0, 18.0, 9.0, 18.0, 9.0, 18.0, 1000.0, 1001.0, 1002.0], None),  # a later peak excuses no earlier change
        ([100.0, 0.4, -0.4, 0.4, -0.4, 0.4, -0.4], StopReason.STAGNATION),  # around zero, where a plain ratio is 200 %
        ([0.0] * 7, None),  # nothing seen yet: 0 is not below 1 % of 0
        ([100.0 * 2**k for k in range(14)], None),
        ([100.0 * 2**k for k in range(15)], StopReason.MAX_ITERATIONS),
    ],
)
def test_which_rule_stops(utilities, expected):
    """Stagnation is five changes in a row below 1 % of the largest absolute utility so far; N_max is 15."""
    assert stop_reason(utilities, Parameters()) == expected
