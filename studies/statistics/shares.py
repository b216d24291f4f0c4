"""Shares over many cases, as pooled counts."""

from collections.abc import Iterable


def pooled(parts: Iterable[float | None], wholes: Iterable[float | None]) -> float | None:
    """Sum of the parts over sum of the wholes; None where there is nothing to have a share of."""
    whole = sum(n or 0 for n in wholes)
    return sum(n or 0 for n in parts) / whole if whole else None
