"""The one exception for input that a person can mend."""


class InputError(ValueError):
    """Bad input. One line: the thing, the place, the mend. The command line prints it and exits with 2."""
