"""How the motion itself carries small changes along an orbit, piece by piece, by integration.

Each piece of an orbit, from one representation point to the next, is integrated with its exact
tangent, all pieces side by side, by Radau's method IIA (implicit, with a stage at the end of the
step, decaying motions decay however fast they are). For the flow and its tangent Φ

    Φ f(x(0)) = f(x(h)),

also across a kink of the rates f. By how much a step misses that is its error: steps shrink where
it is too large, down to the kink, whose side is thus told as finely as the multipliers need.

References
----------
Hairer, Wanner (1996), Solving Ordinary Differential Equations II, section IV.5: the method.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.periodic.autonomous import AutonomousField
from vehicledyn.solve.periodic.orbit import Orbit

TOLERANCE = 1e-5
"""Part of the rates that the tangent of a step may miss."""

_STAGES = 4

_ITERATIONS = 7
_CONVERGED = 1e-7
"""Change of a state, part of its scale, from which on Newton's next step would be rounding."""

_ASTRAY = 1e3
"""Change at which Newton's method is given up."""

_SAFETY, _SMALLEST, _LARGEST = 0.85, 0.1, 5.0
_SHORTEST = 1e-12
"""Part of the period below which no step shrinks."""

_MOST_TRIALS = 400


@dataclass(frozen=True)
class Passages:
    """The motion along the pieces of an orbit and its derivatives; states count in ``scales``.

    ``ends`` (n_pieces, n) are reached from the orbit's points, ``by_state`` (n_pieces, n, n) and
    ``by_parameter`` (n_pieces, n) are their derivatives, ``first`` and ``last`` (n_pieces, n) the
    rates at begin and end [1/s], ``durations`` (n_pieces,) in s. ``error`` is that of the worst
    step.
    """

    orbit: Orbit
    scales: Vector
    ends: Vector
    by_state: Vector
    by_parameter: Vector
    first: Vector
    last: Vector
    durations: Vector
    error: float

    @property
    def gaps(self) -> Vector:
        """Distances from the ends of the pieces to the beginnings of the next, (n_pieces, n)."""
        starts = self.orbit.states / self.scales
        return np.asarray(self.ends - np.roll(starts, -1, axis=0))

    @property
    def monodromy(self) -> Vector:
        """The map of changes at the first point to those one period later, shape (n, n)."""
        product = np.eye(len(self.scales))
        for piece in self.by_state:
            product = piece @ product
        return product


def _radau() -> tuple[Vector, Vector]:
    """Return the nodes of the method, the last one 1, and its weights A, square."""
    ahead = np.polynomial.legendre.Legendre.basis(_STAGES)
    behind = np.polynomial.legendre.Legendre.basis(_STAGES - 1)
    nodes = np.sort(0.5 * (1.0 + (ahead - behind).roots().real))
    nodes[-1] = 1.0
    powers = np.arange(1, _STAGES + 1)
    return nodes, nodes[:, None] ** powers / powers @ np.linalg.inv(nodes[:, None] ** (powers - 1))


_NODES, _WEIGHTS = _radau()


def passages(field: AutonomousField, orbit: Orbit, *, tolerance: float = TOLERANCE) -> Passages:
    """Integrate the pieces of an orbit with their derivatives.

    Parameters
    ----------
    field
        The equations.
    orbit
        The orbit, its unknowns a guess.
    tolerance
        Error allowed of a step, see above.

    Raises
    ------
    NumericalError
        If a piece cannot be integrated.
    """
    pieces = _Pieces.of(field, orbit)
    for _ in range(_MOST_TRIALS):
        active = np.flatnonzero(pieces.places < pieces.stops)
        if not active.size:
            return pieces.result()
        pieces.advance(active, tolerance)
    raise NumericalError("the motion along a cycle cannot be integrated: steps become too small")


@dataclass
class _Pieces:
    """Pieces under way: where they are, and what they have carried along, all scaled.

    Places and steps are parts of the period.
    """

    field: AutonomousField
    orbit: Orbit
    scales: Vector
    begins: Vector
    stops: Vector
    places: Vector
    steps: Vector
    states: Vector
    rates: Vector
    first: Vector
    by_state: Vector
    by_parameter: Vector
    error: float = 0.0

    @staticmethod
    def of(field: AutonomousField, orbit: Orbit) -> _Pieces:
        """Return pieces at their beginnings."""
        begins = orbit.times_of(orbit.mesh)[0]
        stops = np.append(begins[1:], 1.0)
        scales, n = orbit.scales(), field.size
        _, unknowns = orbit.sample(begins)
        for _ in range(_ITERATIONS):
            found = field.evaluate(orbit.states, unknowns, orbit.parameter)
            unknowns = unknowns - found.gap
            if np.abs(found.gap).max(initial=0.0) <= _CONVERGED * np.abs(unknowns).max(initial=0.0):
                break
        rates = found.rates / scales
        return _Pieces(
            field,
            orbit,
            scales,
            begins,
            stops,
            begins.copy(),
            stops - begins,
            orbit.states / scales,
            rates,
            rates.copy(),
            np.broadcast_to(np.eye(n), (len(begins), n, n)).copy(),
            np.zeros((len(begins), n)),
        )

    def result(self) -> Passages:
        """Return the passages of pieces at their ends."""
        return Passages(
            self.orbit,
            self.scales,
            self.states,
            self.by_state,
            self.by_parameter,
            self.first,
            self.rates,
            (self.stops - self.begins) * self.orbit.period,
            self.error,
        )

    def advance(self, active: NDArray[np.intp], tolerance: float) -> None:
        """Try a step of some pieces, and take those that are accurate."""
        left = self.stops[active] - self.places[active]
        sizes = np.minimum(self.steps[active], left)
        trial = self._trial(active, sizes)
        change = trial.by_state @ self.rates[active][:, :, None]
        missed = np.abs(change[:, :, 0] - trial.rates).max(axis=1)
        missed = np.where(trial.found, missed / np.abs(trial.rates).max(axis=1), np.inf)
        error = missed / tolerance
        taken = trial.found & ((error < 1.0) | (sizes <= _SHORTEST))
        self.error = max(self.error, float(missed[taken].max(initial=0.0)))
        if (~taken & (sizes <= _SHORTEST)).any():
            raise NumericalError("the motion along a cycle cannot be integrated")
        factor = _SAFETY * np.maximum(error, 1e-9) ** (-1.0 / (2 * _STAGES))
        self.steps[active] = sizes * np.clip(factor, _SMALLEST, _LARGEST)
        which = active[taken]
        whole = taken & (sizes >= left)
        self.places[which] += sizes[taken]
        self.places[active[whole]] = self.stops[active[whole]]
        self.states[which], self.rates[which] = trial.states[taken], trial.rates[taken]
        maps = trial.by_state[taken]
        self.by_state[which] = maps @ self.by_state[which]
        carried = (maps @ self.by_parameter[which][:, :, None])[:, :, 0]
        self.by_parameter[which] = carried + trial.by_parameter[taken]

    def _trial(self, active: NDArray[np.intp], sizes: Vector) -> _Trial:
        """Return a step of some pieces, found by Newton's method."""
        begin, count, n = self.states[active], len(active), self.field.size
        nodes = self.places[active][:, None] + sizes[:, None] * _NODES
        guess, unknowns = self.orbit.sample(np.minimum(nodes, 1.0).ravel())
        before, _ = self.orbit.sample(self.places[active])
        beside = begin - before / self.scales
        stages = (guess / self.scales).reshape(count, _STAGES, n) + beside[:, None]
        unknowns = unknowns.reshape(count, _STAGES, self.field.n_unknowns)
        weights = _WEIGHTS * (sizes * self.orbit.period)[:, None, None]
        going, trial = np.ones(count, dtype=bool), _Trial.none(count, n)
        for _ in range(_ITERATIONS):
            k = np.flatnonzero(going)
            system = _System.at(self, stages[k], unknowns[k], weights[k])
            change = system.newton(begin[k])
            size = np.abs(change).max(axis=(1, 2))
            stages[k] += change
            unknowns[k] -= system.followed(change)
            small = size < _CONVERGED
            if small.any():
                trial.enter(k[small], system, small, stages[k], change)
            going[k] = ~small & (size < _ASTRAY)
            if not going.any():
                break
        return trial


@dataclass
class _Trial:
    """A step of some pieces: states at its end, rates there and derivatives.

    ``found`` tells where Newton's method has found one.
    """

    found: NDArray[np.bool_]
    states: Vector
    rates: Vector
    by_state: Vector
    by_parameter: Vector

    @staticmethod
    def none(count: int, n: int) -> _Trial:
        """Return a trial of which nothing is found yet."""
        vectors = [np.ones((count, n)) for _ in range(3)]
        return _Trial(
            np.zeros(count, dtype=bool), vectors[0], vectors[1], np.zeros((count, n, n)), vectors[2]
        )

    def enter(
        self,
        which: NDArray[np.intp],
        system: _System,
        chosen: NDArray[np.bool_],
        stages: Vector,
        change: Vector,
    ) -> None:
        """Enter the steps that are found."""
        self.found[which] = True
        self.states[which] = stages[chosen, -1]
        bend = (system.by_state[chosen, -1] @ change[chosen, -1][:, :, None])[:, :, 0]
        self.rates[which] = system.rates[chosen, -1] + bend
        self.by_state[which], self.by_parameter[which] = system.tangents(chosen)


@dataclass(frozen=True)
class _System:
    """The linear equations of Newton's method for the stages of steps, all scaled.

    Over k pieces and s stages: ``stages``, ``rates`` and ``by_parameter`` (k, s, n), ``by_state``
    (k, s, n, n), ``weights`` (k, s, s) [s] and ``matrix`` (k, s n, s n); ``gap`` (k, s, m) and
    ``follow`` (k, s, m, n) correct the m unknowns.
    """

    stages: Vector
    rates: Vector
    by_state: Vector
    by_parameter: Vector
    gap: Vector
    follow: Vector
    weights: Vector
    matrix: Vector

    @staticmethod
    def at(pieces: _Pieces, stages: Vector, unknowns: Vector, weights: Vector) -> _System:
        """Return the equations at stages."""
        count, n = len(stages), stages.shape[2]
        field, scales = pieces.field, pieces.scales
        found = field.evaluate(
            stages.reshape(-1, n) * scales,
            unknowns.reshape(_STAGES * count, -1)
            if unknowns.size
            else np.zeros((_STAGES * count, 0)),
            pieces.orbit.parameter,
        )
        by_state = (found.by_state * (scales / scales[:, None])).reshape(count, _STAGES, n, n)
        pull = weights[:, :, :, None, None] * by_state[:, None]
        matrix = -np.transpose(pull, (0, 1, 3, 2, 4)).reshape(count, _STAGES * n, _STAGES * n)
        matrix[:, np.arange(_STAGES * n), np.arange(_STAGES * n)] += 1.0
        return _System(
            stages,
            (found.rates / scales).reshape(count, _STAGES, n),
            by_state,
            (found.by_parameter / scales).reshape(count, _STAGES, n),
            found.gap.reshape(count, _STAGES, field.n_unknowns),
            (found.follow * scales).reshape(count, _STAGES, field.n_unknowns, n),
            weights,
            matrix,
        )

    def newton(self, begin: Vector) -> Vector:
        """Return the change of the stages, shape (k, s, n)."""
        residual = self.stages - begin[:, None] - self.weights @ self.rates
        return self._solved(-residual.reshape(len(begin), -1, 1)).reshape(self.stages.shape)

    def followed(self, change: Vector) -> Vector:
        """Return by how much the unknowns fall with a change of the stages, (k, s, m)."""
        return np.asarray(self.gap + (self.follow @ change[:, :, :, None])[:, :, :, 0])

    def tangents(self, chosen: NDArray[np.bool_]) -> tuple[Vector, Vector]:
        """Return the derivatives of the ends by the beginnings and by the parameter."""
        n = self.stages.shape[2]
        count = int(chosen.sum())
        known = np.empty((count, _STAGES, n, n + 1))
        known[:, :, :, :n] = np.eye(n)
        known[:, :, :, n] = self.weights[chosen] @ self.by_parameter[chosen]
        matrix = self.matrix[chosen]
        solved = _solve(matrix, known.reshape(count, _STAGES * n, n + 1))[:, -n:]
        return solved[:, :, :n], solved[:, :, n]

    def _solved(self, right: Vector) -> Vector:
        return _solve(self.matrix, right)


def _solve(matrix: Vector, right: Vector) -> Vector:
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        raise NumericalError("the equations of a step along a cycle are singular") from None
