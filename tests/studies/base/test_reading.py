"""Damaged files are the user's, all else is ours."""

from pathlib import Path

import pytest

from materials.input_error import InputError
from studies.base.reading import reading


def test_what_reading_raises_is_said_with_place_and_mend():
    """The cause is kept for whoever asks where it came from."""
    words = r"^a\.json: cannot be read \(KeyError: 'x'\); copy it again$"
    with pytest.raises(InputError, match=words) as caught, reading(Path("a.json"), "copy it again"):
        raise KeyError("x")
    assert isinstance(caught.value.__cause__, KeyError)


@pytest.mark.parametrize("fault", [NameError("x"), AssertionError(), ImportError("x"), RuntimeError("x")])
def test_faults_of_ours_stay_what_they_are(fault: Exception):
    """No file makes a name undefined."""
    with pytest.raises(type(fault)), reading(Path("a.json"), "copy it again"):
        raise fault


def test_an_input_error_keeps_its_own_words():
    """Whoever knew more has said it."""
    with pytest.raises(InputError, match=r"^of another version$"), reading(Path("a.json"), "copy it again"):
        raise InputError("of another version")
