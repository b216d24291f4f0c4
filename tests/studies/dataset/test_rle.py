"""Run lengths as COCO defines them: column by column, zeros first."""

import numpy as np
import pytest

from studies.dataset.make import rle


def test_a_mask_by_hand():
    """Columns of [[0, 1, 1], [0, 0, 1]] one under the other: 0 0 | 1 0 | 1 1 -> two zeros, 1, 1, two ones."""
    mask = np.array([[0, 1, 1], [0, 0, 1]], bool)
    assert rle.encoded(mask) == {"counts": [2, 1, 1, 2], "size": [2, 3]}


def test_a_mask_that_begins_with_a_one_begins_with_no_zeros():
    """As the format demands."""
    assert rle.encoded(np.ones((2, 2), bool)) == {"counts": [0, 4], "size": [2, 2]}
    assert rle.encoded(np.zeros((2, 2), bool)) == {"counts": [4], "size": [2, 2]}


@pytest.mark.parametrize("seed", range(20))
def test_painting_the_runs_gives_the_mask_back(seed: int):
    """One run after the other, as COCO's own decoder does it, of masks of any size, sparse and dense."""
    rng = np.random.default_rng(seed)
    mask = rng.random(rng.integers(1, 9, 2)) < rng.random()
    runs = rle.encoded(mask)
    flat: list[bool] = []
    for place, count in enumerate(runs["counts"]):
        flat += [place % 2 == 1] * count
    assert np.array_equal(np.reshape(flat, runs["size"], order="F"), mask)
