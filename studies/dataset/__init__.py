"""Datasets of labelled depth with reflective holes: `open(DIR)` reads one as numpy arrays, view by view."""

from studies.dataset.format.reader import Dataset

open = Dataset

__all__ = ["Dataset", "open"]
