"""Surfaces at 850 nm: optical constants, finishes, non-metals, a user's own; and the exception for bad input."""
