"""The interior-point method on programs with known optima."""

import os
import signal
import threading

import numpy as np
import pytest

from vehicledyn.analyse.interior_point import NonlinearProgram, Pattern, minimise

DENSE = Pattern(np.array([0, 0]), np.array([0, 1, 2]))


def nearest_on_a_circle():
    """The point of the unit circle that is next to (2, 1): (2, 1) / √5."""
    return NonlinearProgram(
        (np.array([-9.0, -9.0]), np.array([9.0, 9.0])),
        (np.ones(1), np.ones(1)),
        lambda x: ((x[0] - 2.0) ** 2 + (x[1] - 1.0) ** 2, np.array([x @ x])),
        lambda x: (2.0 * (x - np.array([2.0, 1.0])), 2.0 * x),
        DENSE,
    )


def along_a_valley(**more):
    """Rosenbrock's function, least at (1, 1)."""
    return NonlinearProgram(
        (np.array([-9.0, -9.0]), np.array([9.0, 9.0])),
        (np.zeros(0), np.zeros(0)),
        lambda x: (100.0 * (x[1] - x[0] ** 2) ** 2 + (1.0 - x[0]) ** 2, np.zeros(0)),
        lambda x: (
            np.array([400 * x[0] * (x[0] ** 2 - x[1]) + 2 * x[0] - 2, 200 * (x[1] - x[0] ** 2)]),
            np.zeros(0),
        ),
        Pattern(np.zeros(0, dtype=int), np.zeros(3, dtype=int)),
        **more,
    )


def test_the_point_of_a_circle_that_is_next_to_another():
    """An equation, with estimated second derivatives."""
    found = minimise(nearest_on_a_circle(), np.array([0.1, 0.9]), {"tol": 1e-10})
    assert found.is_optimal
    assert found.variables == pytest.approx(np.array([2.0, 1.0]) / np.sqrt(5.0), abs=1e-9)


def test_exact_second_derivatives_take_fewer_iterations():
    """Both ways to the bottom of a bent valley."""
    exact = along_a_valley(
        hessian=lambda x, f, _: f * np.array([1200 * x[0] ** 2 - 400 * x[1] + 2, -400 * x[0], 200]),
        bends=Pattern(np.array([0, 0, 1]), np.array([0, 1, 3])),
    )
    start = np.array([-1.2, 1.0])
    found = [minimise(p, start, {"tol": 1e-10}) for p in (exact, along_a_valley())]
    for item in found:
        assert item.variables == pytest.approx(np.ones(2), abs=1e-8)
    assert found[0].iterations < found[1].iterations


def test_what_functions_raise_is_raised_again():
    """An error of an evaluation or of a watcher ends the search."""
    program = nearest_on_a_circle()

    def fail(*_):
        raise KeyError("beyond")

    with pytest.raises(KeyError, match="beyond"):
        minimise(program, np.zeros(2), {}, fail)
    broken = NonlinearProgram(program.bounds, program.limits, fail, program.slopes, DENSE)
    with pytest.raises(KeyError, match="beyond"):
        minimise(broken, np.zeros(2), {})


def dense(n=600, m=300, seed=5):
    """A quadratic program whose linear equations take most of the time."""
    a = np.random.default_rng(seed).normal(size=(m, n))
    diagonal = Pattern(np.arange(n), np.arange(n + 1))
    return NonlinearProgram(
        (np.zeros(n), np.ones(n)),
        (a.sum(axis=1) * 0.3, a.sum(axis=1) * 0.3),
        lambda x: (float(x @ x), a @ x),
        lambda x: (2.0 * x, a.T.ravel()),
        Pattern(np.tile(np.arange(m), n), np.arange(n + 1) * m),
        lambda x, f, _: 2.0 * f * np.ones(n),
        diagonal,
    )


def test_ctrl_c_within_linear_equations_ends_the_search():
    """CasADi swallows it there, and IPOPT calls the search failed."""
    timer = threading.Timer(0.02, os.kill, (os.getpid(), signal.SIGINT))

    def watch(number, *_):
        if number == 1:
            timer.start()

    with pytest.raises(KeyboardInterrupt):
        minimise(dense(), np.full(600, 0.5), {}, watch)
    timer.join()
