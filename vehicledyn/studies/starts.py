"""Where each case starts: the equilibrium at its own parameters, found from that of one case.

Newton's method with the Jacobian of the reference case and Broyden's corrections needs only
rates, which compiled code gives in microseconds. It begins at the reference case whatever was
computed before, so that a case starts the same in every order and company.

References
----------
Broyden (1965), Mathematics of Computation 19(92), 577-593: the "good" update.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.analyses.preparation.coarse_starts import refuse_coarse_start
from vehicledyn.analyses.preparation.prepare import (
    BALANCE_TOLERANCE,
    AssembledPoint,
    Start,
    equilibrium_point,
    nominal_point,
    set_speed,
)
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.analyses.preparation.runnable import Subject, Vector
from vehicledyn.analyses.preparation.start_rates import start_rates
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic.equations import Equations

_TRIALS = 60
_WANTED = 0.1 * BALANCE_TOLERANCE


@dataclass(frozen=True)
class RestPoint:
    """An equilibrium to begin from, with its inverse Jacobian (n_free, n_free)."""

    free: list[int]
    balanced: list[int]
    begin: Vector
    state: Vector
    unknowns: Vector
    follow: Vector
    inverse: Vector


def start_of(
    prepared: Prepared, speed: float, kind: Start | None, reference: RestPoint | None
) -> AssembledPoint:
    """Return the point a case starts from, as :func:`start_point` would.

    Parameters
    ----------
    prepared
        The case: its subject, starting values and parameters.
    speed
        Its speed [m/s].
    kind
        "nominal", "static", "steady" or None for what is usual.
    reference
        An equilibrium of the same kind, of a case with the same equations; None to search
        without.

    Raises
    ------
    InputError, NumericalError
        If there is no such point.
    """
    chosen = kind or prepared.subject.usual_start
    if chosen == "nominal":
        return nominal_point(prepared, speed)
    steady = chosen == "steady"
    if reference is not None:
        found = _near(prepared, speed if steady else 0.0, reference)
        if found is not None:
            return _moving(prepared, found, speed, None if steady else reference.free)
    return equilibrium_point(prepared, speed, "steady" if steady else "static")


def find_reference(prepared: Prepared, speed: float, kind: Start | None) -> RestPoint | None:
    """Return what the equilibria of other cases are found from; None if there is none."""
    chosen = kind or prepared.subject.usual_start
    if chosen == "nominal" or prepared.has_multipliers:
        return None
    subject, e = prepared.subject, prepared.equations
    balanced_speed = speed if chosen == "steady" else 0.0
    try:
        point = equilibrium_point(prepared, speed, "steady" if chosen == "steady" else "static")
    except NumericalError:
        return None
    set_speed(prepared, balanced_speed)
    begin = _begin(subject, e, balanced_speed)
    state = point.state.copy()
    free, balanced = subject.balance_pairs(e, balanced_speed)
    if chosen != "steady":
        velocities = [k for k in e.speeds if k not in free]
        state[velocities] = begin[velocities]
    total = prepared.slopes.total(
        subject.balance_time, state, point.unknowns, prepared.kernel.parameters
    )
    try:
        inverse = np.asarray(np.linalg.inv(total.rates[np.ix_(balanced, free)]), dtype=float)
    except np.linalg.LinAlgError:
        return None
    return RestPoint(free, balanced, begin, state, point.unknowns, total.unknowns[:, free], inverse)


def _begin(subject: Subject, equations: Equations, speed: float) -> Vector:
    return subject.start_state(equations, speed) if speed > 0.0 else subject.still_state(equations)


def _near(prepared: Prepared, speed: float, reference: RestPoint) -> AssembledPoint | None:
    """Return the equilibrium of a case near the reference; None if it is not found."""
    r, time = reference, prepared.subject.balance_time
    set_speed(prepared, speed)
    kernel = prepared.kernel
    begin = _begin(prepared.subject, prepared.equations, speed)
    state = begin.copy()
    shift = begin[r.free] - r.begin[r.free]
    place = r.state[r.free] + shift
    inverse = r.inverse.copy()
    unknowns = r.unknowns
    try:
        rates, unknowns = _rates(kernel, time, r, place, (state, unknowns))
        best = np.abs(rates).max(initial=0.0)
        for _ in range(_TRIALS):
            if best <= _WANTED:
                break
            step = -inverse @ rates
            trial, unknowns = _rates(kernel, time, r, place + step, (state, unknowns))
            largest = np.abs(trial).max(initial=0.0)
            if not np.isfinite(largest) or (best <= BALANCE_TOLERANCE and largest >= best):
                break
            backwards = inverse @ (trial - rates)
            slope = step @ backwards
            if slope == 0.0:
                break
            inverse += np.outer((step - backwards) / slope, step @ inverse)
            place, rates, best = place + step, trial, largest
    except NumericalError:
        return None
    if not best <= BALANCE_TOLERANCE:
        return None
    state[r.free] = place
    return AssembledPoint(state, kernel.solve_unknowns(time, state, unknowns), float(best))


def _rates(
    kernel: Kernel, time: float, r: RestPoint, place: Vector, point: tuple[Vector, Vector]
) -> tuple[Vector, Vector]:
    """Return the rates to balance, and the unknowns, with the free states at a place."""
    state, guess = point
    state[r.free] = place
    unknowns = kernel.solve_unknowns(time, state, guess)
    return kernel.rates(time, state, unknowns)[r.balanced], unknowns


def _moving(
    prepared: Prepared, point: AssembledPoint, speed: float, found: list[int] | None
) -> AssembledPoint:
    """Return a point with the rates of its start, but for those found; None for all of them."""
    subject, e = prepared.subject, prepared.equations
    state = point.state.copy()
    if found is not None:
        velocities = [k for k in e.speeds if k not in found]
        state[velocities] = subject.start_state(e, speed)[velocities]
        set_speed(prepared, speed)
    state = start_rates(
        prepared.kernel, subject.given_rates, subject.balance_time, state, point.unknowns
    )
    refuse_coarse_start(e, state)
    return AssembledPoint(state, point.unknowns, point.residual)
