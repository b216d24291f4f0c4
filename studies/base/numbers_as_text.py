"""Counts, shares and lengths in words, for sentences and tables."""


def counted(n: int, singular: str, plural: str | None = None) -> str:
    """`1 view`, `3 views`."""
    return f"{n} {singular if n == 1 else plural or singular + 's'}"


def percent(share: float | None) -> str:
    """`83.4 %`; a share that is not defined is `n/a`."""
    return "n/a" if share is None else f"{100 * share:.1f} %"


def millimetre_words(value: float | None) -> str:
    """`1.8 mm`."""
    return "an undefined distance" if value is None else f"{value:.1f} mm"


def number(value: float | None, form: str) -> str:
    """A formatted number, `n/a` when it is not defined."""
    return "n/a" if value is None else format(value, form)
