"""Steps of the pair DOP853 against those of SciPy, which holds the same published method."""

import numpy as np
import pytest
from scipy.integrate import DOP853
from scipy.integrate._ivp import dop853_coefficients as published

from vehicledyn.integrate.explicit_pairs import dop853_table as table
from vehicledyn.integrate.explicit_pairs.dop853 import (
    Dop853,
    StepStart,
    StepTolerances,
    first_size,
    next_size,
    try_step,
)

ROUNDING = 1e-14


def rates(time, state):
    return np.array([state[1], -np.sin(state[0]) + 0.3 * np.cos(2.0 * time), state[0] * state[1]])


def start(time=0.2):
    state = np.array([0.4, -1.1, 0.0])
    return StepStart(time, state, rates(time, state))


def test_table_is_the_published_one():
    assert np.array_equal(table.WEIGHTS, published.A)
    assert np.array_equal(table.WEIGHTS[table.STAGES, : table.STAGES], published.B)
    for ours, theirs in (("NODES", "C"), ("FIFTH", "E5"), ("THIRD", "E3"), ("DENSE", "D")):
        assert np.array_equal(getattr(table, ours), getattr(published, theirs)), ours


# Below these tolerances rounding decides the size of steps, as it makes up the estimated error.
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_steps_are_those_of_scipy(tolerance):
    begin, stop = start(), 6.0
    other = DOP853(rates, begin.time, begin.state, stop, rtol=tolerance, atol=tolerance)
    tolerances = StepTolerances(tolerance, tolerance)
    size = first_size(rates, begin, stop - begin.time, tolerances)
    assert size == pytest.approx(other.h_abs, rel=ROUNDING)
    refused = False
    while begin.time < stop:
        trial = try_step(rates, begin, min(begin.time + size, stop), tolerances)
        size = next_size(trial, refused=refused)
        refused = not trial.error < 1.0
        if refused:
            continue
        begin = trial.end
        other.step()
        assert begin.time == pytest.approx(other.t, rel=1e-10)
        assert begin.state == pytest.approx(other.y, rel=1e-10)
        dense = other.dense_output()
        for part in (0.0, 0.31, 0.8, 1.0):
            time = trial.begin.time + part * trial.size
            assert trial.state(time) == pytest.approx(dense(time), rel=1e-9)
    assert other.status == "finished"


def test_order():
    """The error of one step falls as its ninth power, that of the dense output as its eighth."""
    begin, errors = start(), []
    for size in (0.4, 0.2):
        stop = begin.time + size
        trial = try_step(rates, begin, stop, StepTolerances(1e-9, 1e-9))
        exact = DOP853(rates, begin.time, begin.state, stop, rtol=1e-13, atol=1e-15)
        while exact.status == "running":
            exact.step()
        errors.append(np.abs(trial.end.state - exact.y).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(9.0, abs=0.7)


def test_rates_that_are_no_numbers_refuse_the_step():
    begin = start()
    trial = try_step(
        lambda time, state: np.full(3, np.nan), begin, begin.time + 0.1, StepTolerances(1e-9, 1e-9)
    )
    assert not trial.error < 1.0
    assert next_size(trial, refused=False) == pytest.approx(0.02)


def test_run_is_that_of_scipy():
    begin, stop, tolerances = start(), 6.0, StepTolerances(1e-6, 1e-8)
    ours = Dop853(rates, begin.time, begin.state, stop, tolerances=tolerances)
    theirs = DOP853(rates, begin.time, begin.state, stop, rtol=1e-6, atol=1e-8)
    while theirs.status == "running":
        assert ours.status == "running"
        ours.step()
        theirs.step()
        for name in ("t", "t_old", "step_size", "y"):
            assert getattr(ours, name) == pytest.approx(getattr(theirs, name), rel=1e-10), name
        middle = 0.5 * (theirs.t_old + theirs.t)
        assert ours.dense_output()(middle) == pytest.approx(theirs.dense_output()(middle), rel=1e-9)
    assert (ours.status, theirs.status) == ("finished", "finished")


def test_run_fails_where_there_are_no_rates():
    solver = Dop853(
        lambda time, state: np.full(1, 1.0 if time < 0.5 else np.nan),
        0.0,
        np.zeros(1),
        1.0,
        tolerances=StepTolerances(1e-6, 1e-6),
    )
    while solver.status == "running":
        solver.step()
    assert solver.status == "failed"
    assert solver.t == pytest.approx(0.5)


def test_scales_far_below_the_states_leave_a_step_to_take():
    """States 1e200 times as large as what is allowed give neither overflow nor division by 0."""
    tolerances = StepTolerances(1e-300, 1e-200)
    size = first_size(rates, start(), 5.0, tolerances)
    assert 0.0 < size <= 5.0
    trial = try_step(rates, start(), 0.2 + size, tolerances)
    assert trial.error > 1.0
    assert 0.0 < next_size(trial, refused=False) < size
