"""Steps of a recursion: one function for like places, the same numbers as written out."""

import casadi as ca
import numpy as np
import pytest

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.shared import inlined
from vehicledyn.symbolic.shared_steps import Steps, written_out


def turned(given):
    """A vector turned about the third axis, what it is beside that, and what is known of it."""
    vector, (c, s), scale = given[0], ca.vertsplit(given[1]), given[2]
    turn = ops.vector(c * vector[0] - s * vector[1], s * vector[0] + c * vector[1], vector[2])
    return [turn, -scale * ops.sin(turn), ca.vertcat(vector[0], -s, 0.0, 1.0)]


def chained(write, x, places):
    """A vector that each place turns on."""
    vector, found = x[:3], []
    for cosine, sine, scale in places:
        vector, other, known = write(
            "turned", (), [vector, ca.vertcat(cosine, sine), scale], turned
        )
        found += [vector, other, known]
    return ca.vertcat(*found)


@pytest.fixture
def x():
    return ca.SX.sym("x", 9)


def functions(expression, x):
    names = ca.Function("f", [x], [expression]).get_function()
    return {name for name in names if name.endswith("turned")}


def test_values_and_slopes_are_those_of_the_written_form(x):
    places = [(x[3], x[4], x[5]), (x[6], x[7], x[8]), (x[3], -x[4], 0.0), (1.0, 0.0, x[8])]
    steps = Steps()
    one, two = (chained(write, x, places) for write in (steps, written_out))
    point = np.random.default_rng(2).uniform(-1.0, 1.0, 9)
    for a, b in ((one, two), (ops.jacobian(one, x), ops.jacobian(two, x)), (inlined(one), two)):
        found, wanted = (np.array(ca.Function("f", [x], [e])(point).full()) for e in (a, b))
        assert found == pytest.approx(wanted, rel=1e-14, abs=1e-15)


def test_like_places_share_a_function_and_others_have_their_own(x):
    steps = Steps()
    alike = chained(steps, x, [(x[3], x[4], x[5]), (x[6], x[7], x[8]), (x[4], x[6], x[3])])
    assert len(functions(alike, x)) == 1
    assert steps.are_alike
    other = chained(steps, x, [(x[3], x[4], 0.0), (x[3], x[4], x[3]), (1.0, 0.0, x[3])])
    assert len(functions(ca.vertcat(alike, other), x)) == 4
    assert not steps.are_alike


def test_what_is_known_of_results_is_not_lost(x):
    found = chained(Steps(), x, [(x[3], x[4], 0.0)])
    assert all(found[k].is_zero() for k in (3, 4, 5, 8))
    assert found[9].is_one()
    assert ca.is_equal(found[6], x[0])
    assert ca.is_equal(found[7], -x[4], 1)
    assert not functions(found[6:], x)


def test_numbers_of_their_own_are_given_where_asked_for(x):
    """Places that differ in their numbers share a function; 0, 1 and -1 are still written in."""
    places = [(0.6, 0.8, x[5]), (0.8, -0.6, x[6]), (0.28, 0.96, x[7])]
    each, shared = Steps(), Steps(gives_numbers=True)
    ways = [chained(write, x, places) for write in (each, shared, written_out)]
    assert [len(functions(way, x)) for way in ways] == [3, 1, 0]
    assert shared.are_alike
    assert not each.are_alike
    point = np.random.default_rng(3).uniform(-1.0, 1.0, 9)
    one, two, three = (np.array(ca.Function("f", [x], [e])(point).full()) for e in ways)
    assert one == pytest.approx(three, rel=1e-14, abs=1e-15)
    assert two == pytest.approx(three, rel=1e-14, abs=1e-15)
    assert chained(Steps(gives_numbers=True), x, [(1.0, 0.0, 0.0)])[3:6].is_zero()
