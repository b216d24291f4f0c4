"""Run lengths as COCO defines them: column by column, zeros first."""

import numpy as np
import pytest

from studies.dataset import rle


def test_a_mask_by_hand():
    """Columns of [[0, 1, 1], [0, 0, 1]] one under the other: 0 0 | 1 0 | 1 1 -> two zeros, 1, 1, two ones."""
    mask = np.array([[0, 1, 1], [0, 0, 1]], bool)
    assert rle.encoded(mask) == {"counts": [2, 1, 1, 2], "size": [2, 3]}


def test_a_mask_that_begins_with_a_one_begins_with_no_zeros():
    """As the format demands."""
    assert rle.encoded(np.ones((2, 2), bool)) == {"counts": [0, 4], "size": [2, 2]}
    assert rle.encoded(np.zeros((2, 2), bool)) == {"counts": [4], "size": [2, 2]}


@pytest.mark.parametrize("seed", range(20))
def test_decoding_gives_the_mask_back(seed: int):
    """Of masks of any size, sparse and dense."""
    rng = np.random.default_rng(seed)
    mask = rng.random(rng.integers(1, 9, 2)) < rng.random()
    assert np.array_equal(rle.decoded(rle.encoded(mask)), mask)


def test_counts_that_do_not_fill_the_image_are_refused():
    """They would make a mask of another size."""
    with pytest.raises(ValueError, match="add up to 5"):
        rle.decoded({"counts": [2, 3], "size": [2, 3]})
