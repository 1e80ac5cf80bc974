"""Random numbers and permutations that are found piece by piece."""

import numpy as np
import pytest

from vehicledyn.studies.indexed_random import latin_hypercube, permutation, uniform


@pytest.mark.parametrize("count", [1, 2, 3, 10, 64, 1000, 4097])
def test_permutation_takes_every_number_once(count):
    found = permutation(3, 1, np.arange(count), count)
    assert sorted(found) == list(range(count))


def test_pieces_are_those_of_the_whole():
    whole = latin_hypercube(7, 2, np.arange(1000), 1000)
    pieces = [latin_hypercube(7, 2, np.arange(k, k + 8), 1000) for k in range(0, 1000, 8)]
    assert np.array_equal(whole, np.concatenate(pieces))
    last = latin_hypercube(7, 2, np.array([10**12 - 1]), 10**12)
    assert 0.0 <= last[0] < 1.0


def test_a_latin_hypercube_has_one_value_in_each_part():
    found = latin_hypercube(0, 0, np.arange(500), 500)
    assert sorted(np.floor(found * 500).astype(int)) == list(range(500))


def test_seeds_and_streams_are_independent():
    index = np.arange(4000)
    columns = [uniform(1, 0, index), uniform(1, 1, index), uniform(2, 0, index)]
    columns += [latin_hypercube(1, k, index, 4000) for k in range(3)]
    correlation = np.corrcoef(columns) - np.eye(6)
    assert np.abs(correlation).max() < 5.0 / np.sqrt(4000)


def test_uniform_numbers_are_uniform():
    found = uniform(11, 4, np.arange(100_000))
    assert found.min() >= 0.0
    assert found.max() < 1.0
    counts = np.histogram(found, bins=50, range=(0.0, 1.0))[0]
    assert ((counts - 2000.0) ** 2 / 2000.0).sum() < 90.0  # chi-squared of 49, about 1 in 3000
