"""Drives and steady turns of a car that was killed are not found again, but those of others are."""

from types import SimpleNamespace

import numpy as np
import pytest

from vehicledyn.analyses.handling import test_run
from vehicledyn.analyses.handling.steady_turn import SteadyTurn, TurnDemand
from vehicledyn.analyses.handling.test_run import DriveRecord
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.base.errors import NumericalError
from vehicledyn.results.hdf5.kept_work import KeptWork

KINDS = CarPoint, DriveRecord


def memory(kept):
    return kept.memory("a car", kinds=KINDS)


def test_a_drive_that_is_known_is_not_driven_again(tmp_path, monkeypatch):
    """It is known by equations, parameters, start and duration."""
    drives, signals = [], SimpleNamespace(of=lambda times, *_: SimpleNamespace(time=times))
    monkeypatch.setattr(test_run, "Signals", signals)

    def driven(*_):
        drives.append(1)
        return DriveRecord(np.array([0.0, 0.1]), np.ones((2, 1)), "")

    def drive(known, number=1.0, state=0.1, digest="x", duration=0.1):
        kernel = SimpleNamespace(parameters=np.array([number]), set_parameters=lambda _: None)
        car = SimpleNamespace(
            kernel=kernel, digest=digest, channel={"speed": 0}, set=lambda _: None, memory=known,
            vehicle=SimpleNamespace(chassis="c"),
        )  # fmt: skip
        start = SimpleNamespace(
            state=np.array([state]), unknowns=np.zeros(0), parameters=kernel.parameters
        )
        test = SimpleNamespace(settings_for=lambda _: {})
        assert test_run.drive(car, test, start, duration).end == 0.1

    monkeypatch.setattr(test_run, "_driven", driven)
    for resume in (False, True):
        with KeptWork(tmp_path / "y.h5", resume=resume) as kept:
            drive(memory(kept))
    assert len(drives) == 1
    with KeptWork(tmp_path / "y.h5", resume=True) as kept:
        known = memory(kept)
        for other in ({"number": 2.0}, {"state": 0.2}, {"digest": "y"}, {"duration": 0.2}, {}):
            drive(known, **other)
    assert len(drives) == 5


def test_a_turn_that_is_known_is_not_searched_again(tmp_path, monkeypatch):
    """By its demand and the guess; one that was not found is known not to be there."""
    searches = []

    def find(_, turn, guess):
        searches.append(turn.value)
        if turn.value > 1.0:
            raise NumericalError("no steady turn")
        return CarPoint(guess.state + turn.value, guess.unknowns, guess.parameters)

    def turns(known, *, shift=0.0):
        solver = object.__new__(SteadyTurn)
        solver.car = SimpleNamespace(memory=known)
        guess = CarPoint(np.array([shift]), np.zeros(0), np.array([2.0]))
        found = solver.find(TurnDemand(20.0, "curvature", 0.5), guess)
        assert found.state.tolist() == [shift + 0.5] and found.parameters.tolist() == [2.0]
        with pytest.raises(NumericalError, match="no steady turn"):
            solver.find(TurnDemand(20.0, "curvature", 1.5), guess)

    monkeypatch.setattr(SteadyTurn, "_find", find)
    for resume in (False, True):
        with KeptWork(tmp_path / "t.h5", resume=resume) as kept:
            turns(memory(kept))
    assert searches == [0.5, 1.5]
    with KeptWork(tmp_path / "t.h5", resume=True) as kept:
        turns(memory(kept), shift=1.0)
    assert len(searches) == 4
