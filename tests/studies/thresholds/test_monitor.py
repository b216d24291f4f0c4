"""Reference, alarms and their power on numbers that were made up, so that what must come out is known."""

import json
from pathlib import Path

import numpy as np
import pytest

from materials.input_error import InputError
from studies.thresholds.monitor import first_alarm, monitored, runs_to_notice
from studies.thresholds.power import power
from studies.thresholds.reference import (
    MONITOR,
    MonitorReference,
    SignalReference,
    monitor_object,
    monitor_reference,
    read_monitor,
)
from studies.thresholds.signals import Observed

FALSE_ALARMS, TOLERANCE = 0.05, 0.05


def spreading(values: np.ndarray | list[float]) -> list[Observed]:
    """Runs of which only the first burst's spread is known."""
    return [Observed(None, None, None, float(value)) for value in values]


def gaining(gains: list[float | None]) -> list[Observed]:
    """Runs of which only recoveries are known; None: none was called."""
    return [Observed(0 if gain is None else 1, gain, None, None) for gain in gains]


@pytest.fixture(scope="module")
def reference() -> MonitorReference:
    """Of 600 runs whose spread is evenly distributed between 0 and 1."""
    return monitor_reference(spreading(np.random.default_rng(1).random(600)), seed=2)


def test_no_run_is_used_twice():
    """The limit is the quantile of one half and the answers are those of the other: half and half, every run in one of
    them, told by their numbers."""
    values = np.arange(101.0)
    found = monitor_reference(spreading(values), seed=3).signals["burst_spread"]
    assert (found.n_learned, found.n) == (51, 50)
    rng = np.random.default_rng(3)
    learned, rest = np.array_split(rng.permutation(101), 2)
    assert found.limit == np.quantile(values[learned], 0.9)
    assert found.answers == tuple(values[rest] > found.limit)
    others = monitor_reference(spreading(values), seed=4).signals["burst_spread"]
    assert others != found
    assert found.n_yes == pytest.approx(5, abs=4 * np.sqrt(50 * 0.1 * 0.9))


def test_recoveries_that_gain_nothing():
    """The limit is learned of those runs that had a recovery; a run without one answers no, one that lasts nothing.
    Where a fifth of the recoveries gains nothing at all, it is those that say yes."""
    gains: list[float | None] = [0.0, 0.3, 0.4, 0.5, 0.6, None, None]
    found = monitor_reference(gaining(gains * 100), seed=0).signals["recovery_without_gain"]
    assert found.limit == 0
    assert found.n == 350
    assert found.n_yes / found.n == pytest.approx(1 / 7, abs=0.06)
    stream = [*gaining([None, 0.2, 0.0]), Observed(None, None, 0.0, 0.0)]
    (signal,) = monitored(_one("recovery_without_gain", found), stream, FALSE_ALARMS, TOLERANCE)
    assert (signal.answers, signal.of_runs) == ((False, False, True), (0, 1, 2))
    alike = monitor_reference(gaining([0.15] * 40), seed=0).signals["recovery_without_gain"]
    assert (alike.limit, alike.n_yes) == (pytest.approx(0.15), 0)  # all gain the same: nobody is below that


def _one(name, signal: SignalReference) -> MonitorReference:
    return MonitorReference(signals={name: signal})


def test_signals_of_which_the_domain_says_nothing_are_left_out():
    """No recovery in it; views of which a tenth and more miss the whole object, so that no share is larger."""
    runs = [Observed(0, None, 1.0, spread) for spread in range(40)]
    assert set(monitor_reference(runs, seed=0).signals) == {"burst_spread"}
    with pytest.raises(ValueError, match="40 runs say nothing that could be watched"):
        monitor_reference([Observed(None, None, None, None)] * 40, seed=0)


def test_the_false_alarms_are_shared_out():
    """With three signals each has a third: the limit is the upper bound of Hoeffding with half of that, in closed form,
    and the tolerance."""
    rng = np.random.default_rng(0)
    runs = [Observed(1, *rng.random(3)) for _ in range(400)]
    signals = monitored(monitor_reference(runs, seed=0), [], 0.06, 0.04)
    assert len(signals) == 3
    for signal in signals:
        share = signal.reference.n_yes / signal.reference.n
        assert signal.watched.limit == pytest.approx(share + np.sqrt(np.log(1 / 0.01) / (2 * 200)) + 0.04)
        assert (signal.share, signal.lower_bound, signal.alarm_at) == (None, 0.0, None)


def test_an_alarm_names_its_run(reference: MonitorReference):
    """Runs that say nothing are passed over but counted; the alarm comes as many runs after the change as was foretold,
    and stands whatever follows."""
    inside, silent, outside = spreading([0.5] * 10), [Observed(None, None, None, None)] * 7, spreading([2.0] * 60)
    before = monitored(reference, [*inside, *silent], FALSE_ALARMS, TOLERANCE)
    assert first_alarm(before) is None
    (signal,) = before
    assert signal.more is not None
    (after,) = monitored(reference, [*inside, *silent, *outside, *spreading([0.5] * 60)], FALSE_ALARMS, TOLERANCE)
    assert first_alarm((after,)) is after
    assert after.alarm_at == 17 + signal.more - 1
    assert after.share == pytest.approx(60 / 130)
    (one_less,) = monitored(reference, [*inside, *silent, *outside][: after.alarm_at], FALSE_ALARMS, TOLERANCE)
    assert (one_less.alarm_at, one_less.more) == (None, 1)


def test_a_reference_that_is_too_small_can_raise_none():
    """Of three answers the upper bound is above 1."""
    few = _one("burst_spread", SignalReference(limit=1, n_learned=3, answers=(False, False, True)))
    (signal,) = monitored(few, spreading([2.0] * 50), FALSE_ALARMS, TOLERANCE)
    assert not signal.can_alarm
    assert (signal.alarm_at, signal.more) == (None, None)


def test_a_long_past_inside_delays():
    """The share is that of all runs: a complete change after a hundred runs inside is noticed later, and after many
    thousands not within the runs that are looked ahead."""
    answers = SignalReference(limit=1, n_learned=300, answers=tuple(k % 10 == 0 for k in range(300)))
    at_once = runs_to_notice(answers, (), FALSE_ALARMS, TOLERANCE)
    later = runs_to_notice(answers, (False,) * 100, FALSE_ALARMS, TOLERANCE)
    assert at_once is not None
    assert later is not None
    assert at_once < 20 < later
    (signal,) = monitored(_one("burst_spread", answers), spreading([2.0] * at_once), FALSE_ALARMS, TOLERANCE)
    assert signal.alarm_at == at_once - 1


def test_power_by_counting(reference: MonitorReference):
    """False alarms within the bound and two standard errors over 200 streams; a strong change is nearly always found,
    and one in which every run says yes after exactly the runs that were foretold."""
    rng = np.random.default_rng(7)
    inside, strong = spreading(rng.random(500)), spreading(rng.random(500) + 0.8)  # nine in ten say yes
    found = power(reference, inside, strong, 30, 0.2, 0.0, seed=1)
    assert found.n_streams == 200
    assert found.false_alarms <= 0.2 + 2 * np.sqrt(0.2 * 0.8 / 200)
    assert found.alarms > 0.95
    assert found.median_delay is not None
    answers = reference.signals["burst_spread"]
    at_once = runs_to_notice(answers, (), 0.2, 0.0)
    assert found.median_delay > (at_once or 0)
    whole = power(reference, inside, spreading([2.0]), 20, 0.2, 0.0, seed=1, n_streams=10)
    assert (whole.alarms, whole.median_delay) == (1.0, at_once)
    none = power(reference, inside, inside, 20, 0.05, 0.05, seed=1, change_at=10, n_streams=10)
    assert (none.alarms, none.median_delay) == (0.0, None)
    with pytest.raises(ValueError, match="let it come before the stream's end"):
        power(reference, inside, strong, 20, 0.2, 0.0, seed=1, change_at=20)


def test_a_certificate_is_read_as_it_was_written(tmp_path: Path, reference: MonitorReference):
    """Whatever else stands in it."""
    path = tmp_path / "certificate.json"
    path.write_text(json.dumps({"thresholds": [1, 2], MONITOR: monitor_object(reference)}))
    assert read_monitor(path) == reference


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"version": 2}, "`monitor` has version 2, and this program reads 1"),
        ({"signals": {}}, "`signals`"),
        ({"signals": {"gloss": {"limit": 1, "n_learned": 1, "answers": [True]}}}, "gloss"),
        ({"signals": {"burst_spread": {"limit": 1, "n_learned": 1, "answers": []}}}, "answers"),
        ({"signals": {"burst_spread": {"limit": 1e400, "n_learned": 1, "answers": [True]}}}, "limit"),
        ({"quantile": 0.2}, "quantile"),
        ({"colour": "red"}, "unknown key `colour`"),
    ],
)
def test_a_monitor_that_is_none(tmp_path: Path, reference: MonitorReference, change: dict, words: str):
    """One line that names file and place."""
    path = tmp_path / "certificate.json"
    path.write_text(json.dumps({MONITOR: monitor_object(reference) | change}))
    with pytest.raises(InputError) as error:
        read_monitor(path)
    assert words in str(error.value)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "no such file"),
        ("not JSON", "cannot be read"),
        ("[1, 2]", "holds no `monitor`"),
        ("{}", "holds no `monitor`"),
        ('{"monitor": 3}', "holds no keys with values"),
    ],
)
def test_a_file_that_is_no_certificate(tmp_path: Path, text: str | None, words: str):
    """One line with the mend."""
    path = tmp_path / "certificate.json"
    if text is not None:
        path.write_text(text)
    with pytest.raises(InputError) as error:
        read_monitor(path)
    assert words in str(error.value)
    assert str(error.value).startswith(f"{path}: ")
    assert "give the file of a threshold certificate" in str(error.value)
