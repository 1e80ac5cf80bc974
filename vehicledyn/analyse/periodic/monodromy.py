"""How the motion itself carries small changes along an orbit, piece by piece, by integration.

Each piece of an orbit, from one representation point to the next, is integrated with its exact
tangent, all pieces side by side: by compiled explicit steps, or where there are none, or too many,
by Radau's method. For the flow and its tangent Φ

    Φ f(x(0)) = f(x(h)),

also across a kink of the rates f. By how much a step misses that is its error: steps shrink where
it is too large, down to the kink, whose side is thus resolved as finely as the multipliers need.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.mirror_symmetry import Mirror
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.periodic.radau import (
    NODES,
    ORDER,
    STAGES,
    ParameterPoint,
    TriedSteps,
    radau_steps,
)
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.path_code import StepTrace
from vehicledyn.kernel.point_slopes import CarriedMotions

TOLERANCE = 1e-5
"""Part of the rates that the tangent of a step may miss."""

_SAFETY, _SMALLEST, _LARGEST = 0.85, 0.1, 5.0
_SHORTEST = 1e-12
"""Part of the period below which no step shrinks."""

_MOST_TRIALS, _MOST_EXPLICIT = 400, 2000
_ITERATIONS, _CONVERGED = 7, 1e-7


@dataclass(frozen=True)
class Passages:
    """The motion along the pieces of an orbit and its derivatives; states count in ``scales``.

    ``ends`` (n_pieces, n) are reached from the orbit's points, ``by_state`` (n_pieces, n, n) and
    ``by_parameter`` (n_pieces, n) are their derivatives, ``first`` and ``last`` (n_pieces, n) the
    rates at begin and end [1/s], ``durations`` (n_pieces,) in s. ``error`` is that of the worst
    step. With a ``mirror`` the pieces are those of the first half of the orbit.
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
    mirror: Mirror | None = None

    @property
    def gaps(self) -> Vector:
        """Distances from the ends of the pieces to the beginnings of the next, (n_pieces, n)."""
        count, starts = len(self.ends), self.orbit.states / self.scales
        following = np.append(starts[1:count], self.returned(starts[:1].T).T, axis=0)
        return np.asarray(self.ends - following)

    def returned(self, maps: Vector) -> Vector:
        """Return maps (n, m) to the end of the last piece as such to what comes to the begin."""
        return maps if self.mirror is None else self.mirror.scaled(self.scales).rows(maps)

    @property
    def monodromy(self) -> Vector:
        """The map of changes at the first point to those one period later, shape (n, n)."""
        product = np.eye(len(self.scales))
        for piece in self.by_state:
            product = piece @ product
        product = self.returned(product)
        return product if self.mirror is None else product @ product

    @property
    def trivial(self) -> float:
        """What is left along the motion of a small shift along it after one period."""
        ahead = self.first[0] / np.linalg.norm(self.first[0])
        return float(ahead @ self.monodromy @ ahead)


def passages(
    field: AutonomousField,
    orbit: Orbit,
    *,
    tolerance: float = TOLERANCE,
    mirror: Mirror | None = None,
) -> Passages:
    """Integrate the pieces of an orbit with their derivatives.

    Parameters
    ----------
    field
        The equations.
    orbit
        The orbit, its unknowns a guess.
    tolerance
        Error allowed of a step, see above.
    mirror
        Asks for the first half alone, where compiled code carries it; the other one is its image.

    Raises
    ------
    NumericalError
        If a piece cannot be integrated.
    """
    quick = _carried(field, orbit, tolerance, mirror)
    if quick is not None:
        return quick
    pieces = _Pieces.of(field, orbit)
    for _ in range(_MOST_TRIALS):
        active = np.flatnonzero(pieces.places < pieces.stops)
        if not active.size:
            return pieces.result()
        pieces.advance(active, tolerance)
    raise NumericalError("the motion along a cycle cannot be integrated: steps become too small")


def _carried(
    field: AutonomousField, orbit: Orbit, tolerance: float, mirror: Mirror | None
) -> Passages | None:
    """Return the passages by compiled explicit steps, None where there is no such code.

    None too where the motion is so stiff that they would be too many.
    """
    scales = orbit.scales()
    durations = durations_of(orbit, mirror)
    found = field.carried(
        orbit.states[: len(durations)],
        orbit.parameter,
        durations,
        scales=scales,
        tolerance=tolerance,
        trials=_MOST_EXPLICIT,
    )
    return None if found is None else _scaled(orbit, found, scales, mirror)


def durations_of(orbit: Orbit, mirror: Mirror | None = None) -> Vector:
    """Return how long the pieces of an orbit, or of its first half, last, shape (n_pieces,) [s]."""
    times = orbit.times_of(orbit.mesh)[0]
    count = len(times) if mirror is None else len(times) // 2
    return np.asarray(np.diff(np.append(times, 1.0)) * orbit.period)[:count]


def passages_along(
    field: AutonomousField,
    orbit: Orbit,
    path: StepTrace,
    scales: Vector,
    *,
    tolerances: Sequence[float],
    shifted: float = np.inf,
    mirror: Mirror | None = None,
) -> Passages:
    """Return the passages of an orbit whose points compiled code has found on one path.

    Parameters
    ----------
    field
        The equations.
    orbit
        The orbit.
    path
        The motion from its first point through the durations of its pieces.
    scales
        Sizes of the states, shape (n,).
    tolerances
        Parts of the rates that the tangent of a step may miss, the largest first.
    shifted
        Distance of the trivial multiplier from 1 from which on the next tolerance is asked for.
    mirror
        Says that the path is half the orbit, the other half its image.
    """
    tangents = field.tangents(path, orbit.parameter, scales=scales)
    for tolerance in tolerances:
        found = _scaled(orbit, tangents.carried(tolerance), scales, mirror)
        if abs(found.trivial - 1.0) < shifted:
            break
    return found


def _scaled(orbit: Orbit, found: CarriedMotions, scales: Vector, mirror: Mirror | None) -> Passages:
    return Passages(
        orbit,
        scales,
        found.ends / scales,
        found.maps[:, :, :-1] * (scales / scales[:, None]),
        found.maps[:, :, -1] / scales,
        found.first / scales,
        found.last / scales,
        durations_of(orbit, mirror),
        float(found.errors.max(initial=0.0)),
        mirror,
    )


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
        rates, count = found.rates / scales, len(begins)
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
            np.broadcast_to(np.eye(n), (count, n, n)).copy(),
            np.zeros((count, n)),
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
        last = trial.rates
        missed = np.abs(change[:, :, 0] - last).max(axis=1) / np.abs(last).max(axis=1)
        error = np.where(trial.found, missed / tolerance, np.inf)
        taken = trial.found & ((error < 1.0) | (sizes <= _SHORTEST))
        if (~taken & (sizes <= _SHORTEST)).any():
            raise NumericalError("the motion along a cycle cannot be integrated")
        self.error = max(self.error, float(missed[taken].max(initial=0.0)))
        factor = _SAFETY * np.maximum(error, 1e-9) ** (-1.0 / (ORDER + 1))
        self.steps[active] = sizes * np.clip(factor, _SMALLEST, _LARGEST)
        self._enter(active[taken], trial, taken)
        self.places[active[taken]] += sizes[taken]
        whole = active[taken & (sizes >= left)]
        self.places[whole] = self.stops[whole]

    def _enter(self, which: NDArray[np.intp], trial: TriedSteps, taken: NDArray[np.bool_]) -> None:
        """Enter the steps taken."""
        maps = trial.by_state[taken]
        carried = (maps @ self.by_parameter[which][:, :, None])[:, :, 0]
        self.by_parameter[which] = carried + trial.by_parameter[taken]
        self.by_state[which] = maps @ self.by_state[which]
        self.states[which] = trial.ends[taken]
        self.rates[which] = trial.rates[taken]

    def _trial(self, active: NDArray[np.intp], sizes: Vector) -> TriedSteps:
        """Return a step of some pieces."""
        begin, count, n = self.states[active], len(active), self.field.size
        nodes = self.places[active][:, None] + sizes[:, None] * NODES
        guess, unknowns = self.orbit.sample(np.minimum(nodes, 1.0).ravel())
        before, _ = self.orbit.sample(self.places[active])
        beside = begin - before / self.scales
        return radau_steps(
            ParameterPoint(self.field, self.scales, self.orbit.parameter),
            begin,
            (guess / self.scales).reshape(count, STAGES, n) + beside[:, None],
            unknowns.reshape(count, STAGES, self.field.n_unknowns),
            sizes * self.orbit.period,
        )
