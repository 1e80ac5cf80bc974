"""A road vehicle fitted with the equipment of the driving tests, derived and compiled once.

Tests differ in parameters only (see :mod:`vehicledyn.road.manoeuvres.driving_test`), so one kernel
serves steady states and all open-loop tests.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.build_model import build_tested
from vehicledyn.analyses.preparation.prepare import nominal_point, prepare
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.engine import Ledger
from vehicledyn.kernel.kernel import Backend
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.speed_control import SpeedControl
from vehicledyn.road.manoeuvres.time_table import KNOTS
from vehicledyn.road.vehicle import RoadVehicle

Vector = NDArray[np.float64]

CONTROL = SpeedControl(proportional_gain=3000.0, integral_gain=600.0)
"""Speed controller of the tests; a steady state does not depend on it."""


@dataclass(frozen=True)
class CarPoint:
    """A state with its algebraic unknowns, and the parameters that it belongs to."""

    state: Vector
    unknowns: Vector
    parameters: Vector


class TestedCar:
    """A vehicle with its kernel, whose parameters tests and steady states set.

    Parameters
    ----------
    target
        A scenario or model of a road vehicle; what a scenario's manoeuvre does is left out.
    test
        A test whose parts the car is fitted with.
    backend, progress
        As for a run.

    Raises
    ------
    InputError
        If the model is no road vehicle.
    """

    __test__ = False

    def __init__(
        self, target: Target, *, backend: Backend, progress: Progress, test: DrivingTest
    ) -> None:
        if not target.written.is_vehicle:
            raise InputError(
                f"{target.origin}: '{target.model_name}' is no road vehicle: it has no section "
                "'vehicle' that says what steers and what is driven"
            )
        self.target = target
        self.prepared: Prepared = prepare(
            target,
            backend=backend,
            progress=progress,
            change=lambda _: build_tested(target, test),
        )
        self.vehicle: RoadVehicle = self.prepared.subject.vehicle  # type: ignore[attr-defined]
        self.kernel, self.equations = self.prepared.kernel, self.prepared.equations
        self._places = {p.name: k for k, p in enumerate(self.equations.parameters)}
        self._states = {s.name: k for k, s in enumerate(self.equations.states)}
        self.channel = {c.name: k for k, c in enumerate(self.equations.channels)}

    @property
    def title(self) -> str:
        """Name of the model."""
        return self.target.model_name

    def place(self, parameter: str) -> int:
        """Return the index of a parameter."""
        return self._places[parameter]

    def table_places(self, name: str) -> list[int]:
        """Return the indices of the parameters that hold the values of a table of time."""
        return [self._places[f"{name}.value_{k}"] for k in range(KNOTS)]

    def state(self, name: str) -> int:
        """Return the index of a state."""
        return self._states[name]

    def set(self, values: dict[str, float]) -> None:
        """Set parameters by name."""
        numbers = self.kernel.parameters
        for name, value in values.items():
            numbers[self._places[name]] = value
        self.kernel.set_parameters(numbers)

    @cached_property
    def standing(self) -> CarPoint:
        """The nominal position, at rest."""
        self.set({"speed": 0.0})
        point = nominal_point(self.prepared, 0.0)
        return CarPoint(point.state, point.unknowns, self.kernel.parameters)

    def rates(self, state: Vector, unknowns: Vector, time: float = 0.0) -> tuple[Vector, Vector]:
        """Return the rates and the unknowns that close the loops, from a guess of these."""
        solved = np.ascontiguousarray(unknowns, dtype=float).copy()
        state = np.ascontiguousarray(state, dtype=float)
        return self.kernel.evaluate(time, state, solved, Ledger()), solved

    def outputs(self, point: CarPoint) -> dict[str, float]:
        """Return the channels at a point by name."""
        self.kernel.set_parameters(point.parameters)
        values: Any = self.kernel.outputs(0.0, point.state, point.unknowns)
        return {name: float(values[k]) for name, k in self.channel.items()}
