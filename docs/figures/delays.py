"""How many runs the monitor needs, by drawn numbers: the table of docs/robot.md. `python -m docs.figures.delays`."""

import numpy as np

from studies.thresholds.power import power
from studies.thresholds.reference import monitor_reference
from studies.thresholds.signals import Observed

CERTIFIED = (200, 1000)
"""Runs of the declared domain, half of which give answers."""
CHANGED = (1.0, 0.5, 0.3)
"""Share of the runs that say yes once the domain is left; inside it is a tenth."""
PAST = (0, 50)
"""Runs inside before that."""
AFTER, N_STREAMS, SEED = 100, 100, 0
FALSE_ALARMS, TOLERANCE, N_SIGNALS = 0.05, 0.05, 3
"""Defaults of the command; one of three signals changes."""


def main() -> None:
    """Print the table."""
    print("| runs in the certificate | runs that change | runs inside before | alarms | runs until the alarm |")
    print("|---|---|---|---|---|")
    for certified in CERTIFIED:
        for changed in CHANGED:
            for past in PAST:
                print(row(certified, changed, past))


def row(certified: int, changed: float, past: int) -> str:
    """One line: how many streams raise an alarm within AFTER runs of the change, and after how many in the median."""
    rng = np.random.default_rng(SEED)
    inside = spreading(rng.random(2000))
    reference = monitor_reference(spreading(rng.random(certified)), SEED)
    limit = reference.signals["burst_spread"].limit
    yes = rng.random(2000) < changed
    outside = spreading(np.where(yes, limit + 1, limit))
    each = FALSE_ALARMS / N_SIGNALS
    found = power(reference, inside, outside, past + AFTER, each, TOLERANCE, SEED, past, N_STREAMS)
    delay = f"more than {AFTER}" if found.median_delay is None else f"{found.median_delay:.0f}"
    return f"| {certified} | {100 * changed:.0f} % | {past} | {100 * found.alarms:.0f} % | {delay} |"


def spreading(values: np.ndarray) -> list[Observed]:
    """Runs that say one number."""
    return [Observed(None, None, None, float(value)) for value in values]


if __name__ == "__main__":
    main()
