"""Passages over singular configurations end, however far away the next of them is."""

from types import SimpleNamespace

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyses.simulation.partitions import singularity_crossing
from vehicledyn.analyses.simulation.partitions.singularity_crossing import Passage, Sample
from vehicledyn.base.errors import NumericalError

FREQUENCY = 200.0


class Oscillator:
    """A kernel without loops, whose one pivot falls to zero at a time."""

    equations = SimpleNamespace(channels=(), unknowns=())
    description = "none"

    def __init__(self, singular_at):
        self.singular_at = singular_at

    def evaluate(self, time, state, unknowns, ledger):
        return np.array([state[1], -(FREQUENCY**2) * state[0]])

    def outputs(self, time, state, unknowns):
        return np.zeros(0)

    def count_solve(self, time, state, unknowns, ledger):
        return unknowns

    def pivots(self, samples):
        return np.array([[self.singular_at - sample.time] for sample in samples])


def passage(singular_at):
    begin = Sample(0.0, np.array([1.0, 0.0]), np.zeros(0), np.zeros(0))
    kernel = Oscillator(singular_at)
    return Passage(kernel, kernel.pivots, begin)


def test_a_singular_place_behind_the_interval_is_not_approached():
    assert list(passage(1e6).approach([0], until=0.1)) == []


def test_one_within_the_interval_is_approached_to_ever_smaller_distances():
    times = [sample.time for sample in passage(0.08).approach([0], until=0.1)]
    assert times == pytest.approx([0.08 * (1.0 - 0.5**k) for k in range(1, 6)], rel=1e-6)


def test_a_passage_of_too_many_steps_ends(monkeypatch):
    monkeypatch.setattr(singularity_crossing, "_MOST_STEPS", 50)
    with pytest.raises(NumericalError, match="more than 50 steps to t = 10 s"):
        passage(20.0).advance(10.0)


def test_a_passage_does_not_give_up_its_accuracy(monkeypatch):
    """A step that needs a coarser one is none: at a dead point it would lead anywhere."""
    tried = []

    def refused(passage, size):
        tried.append(passage._tolerance)
        return False

    monkeypatch.setattr(Passage, "_jump", refused)
    with pytest.raises(NumericalError, match="not passed"):
        passage(0.08).go(crossing=[0], until=0.1)
    assert len(tried) > 6
    assert max(tried) < 2e-9


@pytest.mark.long
def test_rates_without_loops_of_their_own_are_watched_too():
    """Rolling constraints have a determinant beside those of the loops."""
    solver = {"kind": "rk4", "step": "200 ms"}
    changes = {"solver": solver, "output.interval": "200 ms"}
    with pytest.warns(vd.UnfinishedWarning, match="the integration diverged"):
        run = vd.simulate("bicycle", set=changes, backend="interpreted")
    assert run.status == "failed"


class Trembling(Oscillator):
    """A kernel whose rates are noise, so that no step is short enough but a tiny one."""

    def evaluate(self, time, state, unknowns, ledger):
        return np.array([np.sin(1e14 * time + 1e9 * state[0]), 0.0])


def test_a_passage_that_stalls_ends_soon():
    kernel = Trembling(20.0)
    stalled = Passage(kernel, kernel.pivots, Sample(0.0, np.zeros(2), np.zeros(0), np.zeros(0)))
    with pytest.raises(NumericalError, match="the step size became too small"):
        stalled.advance(10.0)


@pytest.mark.long
def test_a_change_of_coordinates_that_leads_nowhere_is_taken_back():
    """The bicycle falls over so fast that its loop stays singular with other coordinates, too."""
    changes = {
        "initial": {"frame.roll_rate": "200 rad/s"},
        "solver": {"kind": "rk4", "step": "1 ms"},
        "output": {"interval": "5 ms"},
    }
    with pytest.warns(vd.UnfinishedWarning, match="'front_contact' becomes singular soon after"):
        run = vd.simulate("bicycle", set=changes, duration="20 ms", backend="interpreted")
    assert np.diff(run["frame.roll"].time).min() > 4.9e-3  # no sample twice
