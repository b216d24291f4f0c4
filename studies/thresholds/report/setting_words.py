"""Settings in words, and how the page's figures mark them."""

from collections.abc import Mapping, Sequence
from typing import Any

from studies.thresholds.choose import Choice

MARKS = ("plain", "certified", "chosen")
"""Classes of a setting's mark, in the order in which they are drawn: the last stands above the others."""


def setting_words(values: Mapping[str, Any]) -> str:
    """`n_frames 1, cluster_min_samples 5`."""
    return ", ".join(f"{name} {value}" for name, value in values.items()) or "as it is"


def told_apart(settings: Sequence[Mapping[str, Any]]) -> list[str]:
    """Each of them by what is not the same in all; one alone by all of its values."""
    first, alone = settings[0], len(settings) == 1
    names = [name for name in first if alone or any(values[name] != first[name] for values in settings)]
    return [setting_words({name: values[name] for name in names}) for values in settings]


def mark_of(choice: Choice, setting: int) -> str:
    """Class of the mark of a setting, by its number among those that are chosen among."""
    if setting == choice.chosen:
        return "chosen"
    return "certified" if setting in choice.certified else "plain"
