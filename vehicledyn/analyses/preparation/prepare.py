"""Derive and compile what is to run, and bring it to the state it starts from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.coarse_starts import refuse_coarse_start
from vehicledyn.analyses.preparation.curved_starts import (
    curve_advice,
    led_into_curve,
    straight_before,
)
from vehicledyn.analyses.preparation.error_locations import errors_with_locations
from vehicledyn.analyses.preparation.mass_checks import refuse_idle_start
from vehicledyn.analyses.preparation.memory.origins import key_of
from vehicledyn.analyses.preparation.memory.remembered import (
    recorded_warnings,
    remember_derived,
    remembered,
)
from vehicledyn.analyses.preparation.prepared import (
    Check,
    Prepared,
    Progress,
    by_partitioning,
    named,
)
from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.analyses.preparation.start_rates import start_rates
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.interrupts import undisturbed
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.make_kernel import Backend, compile_kernel
from vehicledyn.multibody.model.parts import BasePart

if TYPE_CHECKING:
    from vehicledyn.analyse.equilibrium import EquilibriumPoint
    from vehicledyn.kernel.derivatives import Slopes

Vector = NDArray[np.float64]
Start = Literal["nominal", "static", "steady"]

BALANCE_TOLERANCE = 1e-9
"""Largest acceleration that counts as balanced [m/s², rad/s²]."""

_LET_DOWN = 1e-3
"""Step in which a road vehicle is let down until its wheels carry it [m or rad]."""


@dataclass(frozen=True)
class AssembledPoint:
    """States and unknowns that fulfil the constraints; ``residual`` the largest unbalance.

    ``remark`` says how they were found, where that was not in the usual way.
    """

    state: Vector
    unknowns: Vector
    residual: float = 0.0
    remark: str = ""


def prepare(
    target: Target,
    *,
    backend: Backend,
    progress: Progress,
    change: Callable[[Subject], Subject] | None = None,
    check: Check | None = None,
    varies_states: bool = False,
    evaluations: float | None = None,
) -> Prepared:
    """Return the derived and compiled system of a scenario or model.

    Parameters
    ----------
    target
        A scenario or a model.
    backend
        "auto", "compiled" or "interpreted".
    progress
        Called with what is going on and the part done.
    change
        Returns a changed subject, before its equations are derived.
    check
        Raises InputError for what cannot be done with the subject; looks at no more than it
        needs of it, so that a refusal does not wait for a derivation or a compiler.
    varies_states
        Whether the states are to be varied one by one, as equilibria and linear analyses do: they
        are independent coordinates then, however the system's runs treat constraints. Equations
        that were compiled for this before, without a warning, are remembered.
    evaluations
        How many evaluations of the rates are expected; None where few are.
    """
    progress("deriving the equations of motion", None)
    with undisturbed(), errors_with_locations(target):
        subject = build_subject(target)
        if change is not None:
            subject = change(subject)
        if varies_states:
            subject = by_partitioning(subject)
    may_know = varies_states and change is None and backend != "interpreted"
    key = (key_of(target, "varied") if may_know else None) or ""
    derived, kernel = remembered(target, subject, key)
    with recorded_warnings() as warnings:
        if check is not None:
            check(derived)
        if kernel is not None:
            progress("found in the cache", 1.0)
            return Prepared(subject, derived.equations, kernel, derived)
        kernel = compile_kernel(
            derived.equations, backend=backend, progress=progress, evaluations=evaluations
        )
    if key and kernel.key and not warnings:
        remember_derived(derived, kernel)
    return Prepared(subject, derived.equations, kernel, derived)


def start_point(
    prepared: Prepared, speed: float, kind: Start | None, *, slopes: Slopes | None = None
) -> AssembledPoint:
    """Return the point a scenario starts from, at a speed [m/s].

    "nominal" is the position that the system's own start values assemble to; "static" and
    "steady" are equilibria, see :func:`equilibrium_point`. None asks for what is usual.
    """
    chosen = kind or prepared.subject.usual_start
    if chosen == "nominal":
        return nominal_point(prepared, speed)
    how: Literal["static", "steady"] = "static" if chosen == "static" else "steady"
    return equilibrium_point(prepared, speed, how, slopes=slopes)


def reference_point(
    prepared: Prepared, speed: float, start: Start | None, *, slopes: Slopes | None = None
) -> AssembledPoint:
    """Return the point to linearise about, see :func:`reference_start`.

    ``slopes`` are derivatives of the equations, where others than the prepared ones are quicker.
    """
    kind = reference_start(prepared.subject, speed, start)
    return start_point(prepared, speed, kind, slopes=slopes)


def reference_start(subject: Subject, speed: float, start: Start | None) -> Start:
    """Return how a model starts that is to be linearised.

    What runs along a road runs straight at a steady speed [m/s], or stands. Everything else is
    at the start that its scenario names, or in equilibrium.
    """
    if subject.usual_start == "steady":
        return "steady" if speed > 0.0 else "static"
    return start or "static"


def nominal_point(prepared: Prepared, speed: float) -> AssembledPoint:
    """Return the system in its nominal position at a forward speed [m/s].

    Raises
    ------
    InputError
        If the rates it is given to start with contradict its constraints, or a coordinate or rate
        is too large to say where it starts.
    """
    state = prepared.subject.start_state(prepared.equations, speed)
    return _moving(prepared, _closed(prepared, state, speed))


def equilibrium_point(
    prepared: Prepared,
    speed: float,
    kind: Literal["static", "steady"],
    *,
    slopes: Slopes | None = None,
) -> AssembledPoint:
    """Return the equilibrium of the system, moving at a speed.

    "static" balances it at rest and then gives it the velocities of its start; "steady"
    balances all but the slow loss of speed at the speed itself, including the spin of free
    wheels.
    """
    if prepared.has_multipliers:
        return _by_partitioning(prepared, speed, kind)
    e, subject = prepared.equations, prepared.subject
    balanced_speed = 0.0 if kind == "static" else speed
    moving = subject.start_state(e, speed)
    state = subject.still_state(e) if kind == "static" else moving
    start = _closed(prepared, state, balanced_speed)
    refuse_idle_start(prepared, subject.balance_time, start.state, start.unknowns)
    slopes = slopes or prepared.slopes
    try:
        found, remark = _balanced(prepared, start, balanced_speed, slopes)
    except NumericalError as error:
        if kind == "static" or subject.usual_start != "steady":
            raise
        try:
            found, remark = _from_rest(prepared, speed, slopes)
        except NumericalError:
            raise error from None
    free, _ = subject.balance_pairs(e, balanced_speed)
    final = found.state.copy()
    if kind == "static":
        velocities = [k for k in e.speeds if k not in free]
        final[velocities] = moving[velocities]
        set_speed(prepared, speed)
    return _moving(prepared, AssembledPoint(final, found.unknowns, found.residual, remark))


def _from_rest(prepared: Prepared, speed: float, slopes: Slopes) -> tuple[EquilibriumPoint, str]:
    """Return the equilibrium at a speed [m/s] from that at rest: the start was too far from both.

    Wheels far too deep in the ground carry loads for which tyres have no sensible forces.
    """
    resting = equilibrium_point(prepared, speed, "static", slopes=slopes)
    return _balanced(prepared, resting, speed, slopes)


def _balanced(
    prepared: Prepared, start: AssembledPoint, speed: float, slopes: Slopes
) -> tuple[EquilibriumPoint, str]:
    """Return the equilibrium at a speed [m/s], and how it was found where not from the start."""
    from vehicledyn.analyse.equilibrium import find_equilibrium

    subject = prepared.subject
    pairs = subject.balance_pairs(prepared.equations, speed)
    search = partial(
        find_equilibrium,
        prepared.equations,
        prepared.kernel,
        free=pairs[0],
        balanced=pairs[1],
        tolerance=BALANCE_TOLERANCE,
        derivatives=slopes,
        not_held=partial(not_held, subject),
    )
    settling = _let_down(prepared, start) or subject.settling
    begin = start.state, start.unknowns
    try:
        at = subject.balance_time
        return search(time=at, state=begin[0], unknowns=begin[1], settling=settling), ""
    except NumericalError as error:
        entry = straight_before(prepared, *begin) if settling else None
        advice = curve_advice(prepared, *begin)
        if settling is None or entry is None:
            raise NumericalError(f"{error}{advice}", about=error.about) from error
        try:
            found = led_into_curve(
                prepared, entry, begin, search, pairs=pairs, slopes=slopes, settling=settling
            )
        except NumericalError as other:
            tried = f"; nor does one follow from straight track: {other}"
            raise NumericalError(f"{error}{tried}{advice}", about=error.about) from error
        return found, entry.remark


def not_held(subject: Subject) -> dict[str, str]:
    """Return coordinates that parts of the system cannot hold, and why."""
    parts = [part for part in subject.system.parts if isinstance(part, BasePart)]
    return {name: why for part in parts for name, why in part.not_held().items()}


def _by_partitioning(
    prepared: Prepared, speed: float, kind: Literal["static", "steady"]
) -> AssembledPoint:
    """Return the equilibrium of a system with multipliers, found in independent coordinates."""
    other = prepared.partitioned
    point = equilibrium_point(other, speed, kind)
    set_speed(prepared, speed)
    e, time = other.equations, prepared.subject.balance_time
    outputs = other.kernel.outputs(time, point.state, point.unknowns)
    values = dict(named(e.channels, outputs))
    values.update(named(e.unknowns, point.unknowns))
    values.update(named(e.states, point.state))
    state = np.array([values[s.name] for s in prepared.equations.states])
    unknowns = np.array([values.get(u.name, u.start) for u in prepared.equations.unknowns])
    return AssembledPoint(state, unknowns, point.residual, point.remark)


def _let_down(prepared: Prepared, start: AssembledPoint) -> float | None:
    """Return the step in which a road vehicle settles that starts with a wheel off the ground.

    Wheels that only just touch count, since rounding alone would decide which of them carry [m or
    rad].
    """
    subject, e = prepared.subject, prepared.equations
    loads = {f"{wheel.name}.tyre.normal_force" for wheel in subject.ports.wheels}
    if not loads:
        return None
    outputs = prepared.kernel.outputs(subject.balance_time, start.state, start.unknowns)
    values = zip(e.channels, outputs, strict=True)
    hangs = any(value <= 0.0 for channel, value in values if channel.name in loads)
    return _LET_DOWN if hangs else None


def set_speed(prepared: Prepared, speed: float) -> None:
    """Set the parameters of the kernel that depend on the speed [m/s]."""
    changed = prepared.subject.parameters_at(speed)
    if not changed:
        return
    names = [p.name for p in prepared.equations.parameters]
    values = prepared.kernel.parameters.copy()
    for name, value in changed.items():
        values[names.index(name)] = value
    prepared.kernel.set_parameters(values)


def _moving(prepared: Prepared, point: AssembledPoint) -> AssembledPoint:
    """Return a point with the rates that were given to its coordinates, dependent ones too."""
    subject = prepared.subject
    state = start_rates(
        prepared.kernel, subject.given_rates, subject.balance_time, point.state, point.unknowns
    )
    refuse_coarse_start(prepared.equations, state)
    return replace(point, state=state)


def _closed(prepared: Prepared, state: Vector, speed: float) -> AssembledPoint:
    """Return a state with its loops closed, near where they were assembled."""
    from vehicledyn.analyse.equilibrium import assemble

    refuse_coarse_start(prepared.equations, state)
    guess = np.array([u.start for u in prepared.equations.unknowns])
    set_speed(prepared, speed)
    return AssembledPoint(
        state, assemble(prepared.kernel, prepared.subject.balance_time, state, guess)
    )
