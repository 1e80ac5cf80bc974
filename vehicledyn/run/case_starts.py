"""Starting points of many cases of one scenario: nominal, balanced at rest or at a speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.run.prepare import (
    BALANCE_TOLERANCE,
    Point,
    Prepared,
    Start,
    Vector,
    equilibrium_point,
    nominal_point,
    start_point,
)
from vehicledyn.run.subject import Subject
from vehicledyn.solve.batch import Batch, Cases
from vehicledyn.solve.case_balance import BalancedCases, balance_cases
from vehicledyn.solve.case_rates import CaseRates

_AT_ONCE = 512
_HOMOTOPY = (4, 16)
"""Steps in which cases are approached that are not found at once."""


@dataclass(frozen=True)
class StartedCases:
    """Cases ready to run; ``problems`` tells why some have no start, by their number.

    A case without a start stands at that of the base case.
    """

    cases: Cases
    problems: dict[int, str] = field(default_factory=dict)


class CaseStarter:
    """Finds where cases of a prepared scenario start, from where the scenario itself does.

    Balanced cases are found side by side from the scenario's own equilibrium; one that this does
    not find is balanced by itself, as a single run would be. A case starts at the same point
    whatever its neighbours and the number of lanes.
    """

    def __init__(
        self, prepared: Prepared, batch: Batch, *, speed: float, kind: Start | None
    ) -> None:
        """Find the scenario's own start, at a speed [m/s].

        Raises
        ------
        InputError, NumericalError
            If it has none.
        """
        self._prepared, self._batch = prepared, batch
        self._kind: Start = kind or _usual(prepared)
        base = prepared.kernel.parameters
        self._own = replace(prepared, kernel=prepared.kernel.with_parameters(base))
        self.base: Point = start_point(self._own, speed, self._kind)
        self._speed = speed
        if self._kind != "nominal":
            self._derive()

    def starts(
        self,
        parameters: Vector,
        *,
        speeds: Vector,
        subjects: Sequence[Subject] | None = None,
    ) -> StartedCases:
        """Return the cases with their starting points.

        Parameters
        ----------
        parameters
            Values in the order of the equations' parameters, in SI, shape
            (n_cases, n_parameters); those that depend on the speed are set here.
        speeds
            Forward speed of each case [m/s], shape (n_cases,).
        subjects
            What each case runs, where start values differ; None if all are as prepared.
        """
        parts = [
            self._some(
                parameters[first : first + _AT_ONCE],
                speeds[first : first + _AT_ONCE],
                None if subjects is None else subjects[first : first + _AT_ONCE],
            )
            for first in range(0, len(parameters), _AT_ONCE)
        ]
        arrays = zip(*[vars(part.cases).values() for part in parts], strict=True)
        problems = {
            number * _AT_ONCE + index: text
            for number, part in enumerate(parts)
            for index, text in part.problems.items()
        }
        return StartedCases(Cases(*[np.concatenate(items) for items in arrays]), problems)

    def _some(
        self, parameters: Vector, speeds: Vector, subjects: Sequence[Subject] | None
    ) -> StartedCases:
        n = len(parameters)
        own = list(subjects) if subjects is not None else [self._prepared.subject] * n
        final = self._at_speeds(parameters, speeds, own)
        moving = self._states(own, speeds)
        states = np.tile(self.base.state, (n, 1))
        unknowns = np.tile(self.base.unknowns, (n, 1))
        if self._prepared.subject.given_rates:
            found = np.zeros(n, dtype=bool)
        elif self._kind == "nominal":
            _, found = CaseRates(self._batch, final)(
                self._time, moving, unknowns, np.ones(n, dtype=bool)
            )
            states[found] = moving[found]
        else:
            balanced = self._balanced(parameters, speeds, own, moving)
            found = balanced.solved
            states[found], unknowns[found] = balanced.states[found], balanced.unknowns[found]
            if self._kind == "static":
                velocities = list(self._prepared.equations.velocities)
                states[:, velocities] = moving[:, velocities]
        problems = {}
        for index in np.flatnonzero(~found):
            try:
                point = self._alone(own[index], parameters[index], float(speeds[index]))
            except (InputError, NumericalError) as error:
                problems[int(index)] = str(error)
            else:
                states[index], unknowns[index] = point.state, point.unknowns
        return StartedCases(Cases(final, states, unknowns), problems)

    @property
    def _time(self) -> float:
        return self._prepared.subject.balance_time

    def _derive(self) -> None:
        """Derive the Jacobian of the balanced rates at the scenario's own equilibrium."""
        e, subject = self._prepared.equations, self._prepared.subject
        speed = 0.0 if self._kind == "static" else self._speed
        state = self.base.state.copy()
        self._begin = self._balancing(subject, speed)
        if self._kind == "static":
            velocities = list(e.velocities)
            state[velocities] = self._begin[velocities]
        self._free, self._rates = subject.balance_pairs(e, speed)
        own = self._own.kernel.parameters[None]
        values = self._values = self._at_speeds(own, np.array([speed]), [subject])[0]
        total = self._own.derivatives.total(self._time, state, self.base.unknowns, values)
        jacobian = total.rates[np.ix_(self._rates, self._free)]
        try:
            self._inverse: Vector = np.asarray(np.linalg.inv(jacobian), dtype=float)
        except np.linalg.LinAlgError:
            self._inverse = np.zeros_like(jacobian)  # no case is found; each is balanced alone
        self._place = state
        self._shift = state[self._free] - self._begin[self._free]

    def _balancing(self, subject: Subject, speed: float) -> Vector:
        e = self._prepared.equations
        return subject.still_state(e) if self._kind == "static" else subject.start_state(e, speed)

    def _balanced(
        self, parameters: Vector, speeds: Vector, subjects: list[Subject], moving: Vector
    ) -> BalancedCases:
        static = self._kind == "static"
        target = self._at_speeds(parameters, np.zeros_like(speeds) if static else speeds, subjects)
        begin = self._still(subjects) if static else moving.copy()
        begin[:, self._free] += self._shift
        unknowns = np.tile(self.base.unknowns, (len(begin), 1))
        found = self._solve(target, begin, unknowns, self._inverse)
        for n_steps in _HOMOTOPY:
            rest = np.flatnonzero(~found.solved)
            if rest.size == 0:
                break
            part = self._approach(target[rest], begin[rest], n_steps)
            for name in ("states", "unknowns", "residuals", "solved"):
                getattr(found, name)[rest] = getattr(part, name)
        return found

    def _approach(self, target: Vector, begin: Vector, n_steps: int) -> BalancedCases:
        """Balance cases in steps, from the scenario's own parameters and start to theirs."""
        n = len(target)
        own, place = np.tile(self._values, (n, 1)), np.tile(self._place, (n, 1))
        found = self._solve(own, place, np.tile(self.base.unknowns, (n, 1)), self._inverse)
        for step in range(1, n_steps + 1):
            part = step / n_steps
            states = place + part * (begin - place)
            states[:, self._free] = found.states[:, self._free]
            values = own + part * (target - own) if step < n_steps else target
            found = self._solve(values, states, found.unknowns, found.inverses)
        return found

    def _solve(
        self, parameters: Vector, states: Vector, unknowns: Vector, inverse: Vector
    ) -> BalancedCases:
        return balance_cases(
            CaseRates(self._batch, parameters),
            time=self._time,
            states=states,
            unknowns=unknowns,
            free=self._free,
            balanced=self._rates,
            inverse=inverse,
            tolerance=BALANCE_TOLERANCE,
        )

    def _alone(self, subject: Subject, parameters: Vector, speed: float) -> Point:
        kernel = self._prepared.kernel.with_parameters(parameters)
        prepared = replace(self._own, subject=subject, kernel=kernel)
        if self._kind == "nominal":
            return nominal_point(prepared, speed)
        kind: Literal["static", "steady"] = "static" if self._kind == "static" else "steady"
        return equilibrium_point(prepared, speed, kind)

    def _at_speeds(self, parameters: Vector, speeds: Vector, subjects: list[Subject]) -> Vector:
        """Return the parameters with those set that depend on the speed."""
        names = {p.name: k for k, p in enumerate(self._prepared.equations.parameters)}
        values = np.array(parameters, dtype=float)
        for row, speed, subject in zip(values, speeds, subjects, strict=True):
            for name, value in subject.parameters_at(float(speed)).items():
                row[names[name]] = value
        return values

    def _states(self, subjects: list[Subject], speeds: Vector) -> Vector:
        """Return the states to start from, evaluated once for equal subjects and speeds."""
        e, known = self._prepared.equations, {}
        rows = []
        for subject, speed in zip(subjects, speeds, strict=True):
            key = (id(subject), float(speed))
            if key not in known:
                known[key] = subject.start_state(e, float(speed))
            rows.append(known[key])
        return np.array(rows)

    def _still(self, subjects: list[Subject]) -> Vector:
        e = self._prepared.equations
        known = {
            id(subject): subject.still_state(e) for subject in {id(s): s for s in subjects}.values()
        }
        return np.array([known[id(subject)] for subject in subjects])


def _usual(prepared: Prepared) -> Start:
    usual = prepared.subject.usual_start
    return "nominal" if usual == "nominal" else "static" if usual == "static" else "steady"
