"""Coefficients of embedded pairs satisfy the order conditions, one for each rooted tree."""

from itertools import combinations_with_replacement
from math import prod

import numpy as np
import pytest

import vehicledyn.integrate
from vehicledyn.base.registry import find, kinds

assert vehicledyn.integrate
PAIRS = {
    kind: find("solver", kind).pair
    for kind in kinds("solver")
    if hasattr(find("solver", kind), "pair")
}

ROUNDED = 3e-14
"""What sixteen digits of coefficients up to some twelve leave over."""


def trees(order):
    """Return the rooted trees with so many vertices, each the tuple of its branches."""
    if order == 1:
        return [()]
    smaller = [tree for k in range(1, order) for tree in trees(k)]
    return [
        branches
        for count in range(1, order)
        for branches in combinations_with_replacement(smaller, count)
        if sum(map(size, branches)) == order - 1
    ]


def size(tree):
    return 1 + sum(map(size, tree))


def density(tree):
    return size(tree) * prod(map(density, tree))


def stage_weights(tree, stages):
    return prod(
        (stages @ stage_weights(branch, stages) for branch in tree), start=np.ones(len(stages))
    )


def matrix(pair):
    """Return the coefficients of all stages, the rates at the end of the step as the last."""
    count = len(pair.weights) + 1
    rows = [*pair.stages, pair.weights]
    return np.array([[*row, *[0.0] * (count - len(row))] for row in rows])


def conditions(stages, weights, order):
    """Return how far weights are from the conditions up to an order."""
    return [
        weights @ stage_weights(tree, stages) - 1.0 / density(tree)
        for k in range(1, order + 1)
        for tree in trees(k)
    ]


def test_there_are_as_many_conditions_as_trees():
    assert [len(trees(k)) for k in range(1, 7)] == [1, 1, 2, 4, 9, 20]


@pytest.mark.parametrize("kind", sorted(PAIRS))
def test_orders_of_result_and_error(kind):
    pair, stages = PAIRS[kind], matrix(PAIRS[kind])
    result, error = np.array([*pair.weights, 0.0]), np.array(pair.error)
    assert stages.sum(axis=1) == pytest.approx([*pair.nodes, 1.0], abs=3e-15)
    assert np.abs(conditions(stages, result, pair.order)).max() < ROUNDED
    assert np.abs(conditions(stages, result - error, pair.embedded_order)).max() < ROUNDED
    for weights, order in ((result, pair.order), (result - error, pair.embedded_order)):
        assert np.abs(conditions(stages, weights, order + 1)).max() > 1e-6


@pytest.mark.parametrize("kind", sorted(PAIRS))
def test_dense_output_joins_the_steps_and_has_its_order(kind):
    pair, stages = PAIRS[kind], matrix(PAIRS[kind])
    dense = np.array(pair.dense)
    powers = np.arange(1, dense.shape[1] + 1)
    assert dense.sum(axis=1) == pytest.approx([*pair.weights, 0.0], abs=2e-14)
    assert dense @ powers == pytest.approx([*[0.0] * len(pair.weights), 1.0], abs=1e-13)
    for part in (0.3, 0.7):
        weights = dense @ part**powers
        for k in range(1, pair.embedded_order + 1):
            for tree in trees(k):
                found = weights @ stage_weights(tree, stages)
                assert found == pytest.approx(part**k / density(tree), abs=2e-14)
