"""A road vehicle fitted with the equipment of the driving tests, derived and compiled once.

Tests differ in parameters only (see :mod:`vehicledyn.road.manoeuvres.driving_test`), so one kernel
serves steady states and all open-loop tests.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.build_model import build_tested
from vehicledyn.analyses.preparation.prepare import equilibrium_point, prepare
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.analyses.preparation.road_runnable import RoadSubject
from vehicledyn.base.errors import InputError
from vehicledyn.base.step_memory import Memory
from vehicledyn.codegen.toolchain.fingerprint import fingerprint
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.engine import Ledger
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.kinds.braking.split_braking import slippery_side
from vehicledyn.road.manoeuvres.speed_control import SpeedControl
from vehicledyn.road.manoeuvres.time_table import KNOTS
from vehicledyn.road.vehicle import RoadVehicle
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.symbolic.ops import Scalar

Vector = NDArray[np.float64]

CONTROL = SpeedControl(proportional_gain=3000.0, integral_gain=600.0)
"""Speed controller before the car's own is known; a steady state does not depend on it."""


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
            change=lambda _: _tested(target, test),
        )
        self.vehicle: RoadVehicle = self.prepared.subject.vehicle  # type: ignore[attr-defined]
        self.kernel, self.equations = self.prepared.kernel, self.prepared.equations
        self.has_slippery_side = _feel_friction(self.prepared.subject)  # type: ignore[arg-type]
        self.control = CONTROL
        self.memory = Memory()
        self._places = {p.name: k for k, p in enumerate(self.equations.parameters)}
        self._states = {s.name: k for k, s in enumerate(self.equations.states)}
        self.channel = {c.name: k for k, c in enumerate(self.equations.channels)}

    @property
    def title(self) -> str:
        """Title of the model."""
        return self.target.title

    @cached_property
    def steering_ratio(self) -> float:
        """Steering-wheel angle over that of the front wheels; 1 where there is no wheel."""
        return self.worth(self.vehicle.steering_ratio)

    @property
    def has_steering_wheel(self) -> bool:
        """Whether steering angles are those of a steering wheel."""
        return self.steering_ratio > 1.0

    @cached_property
    def digest(self) -> str:
        """Digest of the equations and the tables that they look up."""
        tables = [table.digest for table in self.equations.tables]
        return hashlib.sha256("".join([fingerprint(self.equations), *tables]).encode()).hexdigest()

    def worth(self, expression: Scalar) -> float:
        """Return what an expression of the model's parameters is worth."""
        return self.vehicle.worth(expression)

    def like(self, other: TestedCar, point: CarPoint) -> CarPoint:
        """Return the point of another car of the same model in this one; further states are 0."""
        known = dict(zip((s.name for s in other.equations.states), point.state, strict=True))
        state = np.array([known.get(s.name, 0.0) for s in self.equations.states])
        guess = dict(zip((u.name for u in other.equations.unknowns), point.unknowns, strict=True))
        unknowns = np.array([guess.get(u.name, u.start) for u in self.equations.unknowns])
        places = {p.name: k for k, p in enumerate(other.equations.parameters)}
        parameters = self.kernel.parameters
        for name, place in self._places.items():
            if name in places:
                parameters[place] = point.parameters[places[name]]
        return CarPoint(state, unknowns, parameters)

    def hold_speed_by(self, control: SpeedControl) -> None:
        """Use a speed controller from now on."""
        self.control = control
        parameters = self.standing.parameters.copy()
        parameters[self.place("test.proportional_gain")] = control.proportional_gain
        parameters[self.place("test.integral_gain")] = control.integral_gain
        self.standing = replace(self.standing, parameters=parameters)

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
        """The car at rest on its springs.

        Raises
        ------
        NumericalError
            If it finds no equilibrium at rest.
        """
        point = equilibrium_point(self.prepared, 0.0, "static")
        return CarPoint(point.state, point.unknowns, self.kernel.parameters)

    @cached_property
    def wheel_loads(self) -> dict[str, float]:
        """Loads of the wheels at rest, by name [N]."""
        outputs = self.outputs(self.standing)
        return {c.name: outputs[f"{c.name}.tyre.normal_force"] for c in self.vehicle.corners}

    @property
    def mass(self) -> float:
        """Mass on the wheels as it is tested [kg]."""
        weight = math.hypot(*(self.worth(g) for g in self.vehicle.system.gravity))
        return sum(self.wheel_loads.values()) / weight

    @cached_property
    def front_share(self) -> float:
        """Part of the mass that is on the front wheels [1]."""
        loads = self.wheel_loads
        front = sum(loads[corner.name] for corner in self.vehicle.corners if corner.is_front)
        return front / sum(loads.values())

    @property
    def mass_ahead(self) -> float:
        """Distance of the centre of mass ahead of the chassis's origin, of a car by itself [m].

        A car with a trailer counts as having it there.
        """
        if self.vehicle.articulation is not None:
            return 0.0
        wheelbase = self.worth(self.vehicle.wheelbase)
        return self.worth(self.vehicle.front_distance) - (1.0 - self.front_share) * wheelbase

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


def _tested(target: Target, test: DrivingTest) -> RoadSubject:
    """Return the vehicle with its test, on a road whose one side may become slippery.

    That side has the friction of the road, until a test sets another; it is left out where tyres
    of a law of one's own feel no friction.
    """
    subject = build_tested(target, test, (slippery_side(1.0, "right", 0.0, 0.0),))
    return subject if _feel_friction(subject) else build_tested(target, test)


def _feel_friction(subject: RoadSubject) -> bool:
    wheels = [part for part in subject.system.parts if isinstance(part, RoadWheel)]
    return all(wheel.tyre.feels_friction for wheel in wheels)
