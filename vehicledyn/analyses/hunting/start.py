"""What a hunting study is asked for, and the equilibrium at which it begins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.critical import follow_balance
from vehicledyn.analyse.settling.parameter_rampdown import steps
from vehicledyn.analyses.hunting.parameter_starts import ParameterStarts
from vehicledyn.analyses.preparation.prepare import AssembledPoint, reference_point
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.argument_names import argument, given
from vehicledyn.base.errors import InputError, NumericalError, nearest_name, unknown_name
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario import Scenario
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.engine import Vector

DEGREE = 4
"""Degree of the polynomials of first cycles."""

_MOST_CHANNELS = 8

SPEED = "speed"
"""Parameter that has to be above zero [m/s]."""

_LOW_SPEED = 1.0

_APPROACH = 20
"""Values at which an equilibrium is followed from a file's own value to the first one."""


MOST_POINTS = 10_000
"""Cycles of a branch that may be asked for."""


@dataclass(frozen=True)
class HuntSettings:
    """What is asked of a study.

    ``parameter`` goes from ``first`` up to ``last``, numbers in SI or texts with unit;
    ``points`` is about the number of cycles of a branch, None for what suits the model;
    ``channels`` are watched, the first
    one for the amplitude. ``amplitude`` is the size of the first cycle at a Hopf bifurcation
    and ``disturbance`` that with which simulations start, both of the position that moves
    most, in its unit. ``simulate`` asks for the check by simulation at ``levels`` values, in which
    at most ``simulated`` seconds of motion are simulated, None for what suits the model.
    ``secondary`` asks for the branches that branch off where cycles lose their mirror symmetry;
    None for them where the equilibrium is unstable and no stable cycle is found.
    """

    parameter: str
    first: float | str
    last: float | str
    points: int | None = None
    channels: tuple[str, ...] = ()
    amplitude: float = 1e-4
    disturbance: float = 1e-3
    intervals: int = 30
    simulate: bool = True
    levels: int = 13
    simulated: float | str | None = None
    secondary: bool | None = None


def check_settings(settings: HuntSettings) -> None:
    """Refuse numbers that make no study."""
    s = settings
    if (s.points is not None and s.points < 2) or s.intervals < 5:
        few = f"{argument('points')} must be at least 2, and {argument('intervals')} at least 5"
        raise InputError(few)
    if s.points is not None and s.points > MOST_POINTS:
        raise InputError(f"{given('points', s.points)}: give {MOST_POINTS} or fewer")
    if not (s.amplitude > 0.0 and s.disturbance > 0.0):
        raise InputError(
            f"{argument('amplitude')} and {argument('disturbance')} must be above zero"
        )
    simulated_seconds(s)


def simulated_seconds(settings: HuntSettings) -> float | None:
    """Return how much motion may be simulated [s]; refuse what is no duration."""
    if settings.simulated is None:
        return None
    try:
        seconds = to_si(settings.simulated, "s")
    except InputError as error:
        raise InputError(f"{given('simulated', settings.simulated)}: {error}") from None
    if not (math.isfinite(seconds) and seconds > 0.0):
        words = f"{given('simulated', settings.simulated)}: must be above zero"
        raise InputError(f"{words}, such as '100 s'")
    return seconds


def parameter_index(names: Sequence[str], name: str, model: str) -> int:
    """Return the place of a parameter among all of a model; refuse a name that there is not."""
    if name in names:
        return list(names).index(name)
    guess = nearest_name(name, names)
    hint = f"; did you mean '{guess}'?" if guess else ""
    raise InputError(
        f"{given('parameter', name)}: '{model}' has no parameter of this name{hint} "
        "(a speed is one only where the model prescribes it); 'models show' lists them"
    )


def span_of(unit: str, settings: HuntSettings) -> tuple[float, float]:
    """Return the range of a parameter of a unit, in SI."""
    values = []
    for name, value in (("first", settings.first), ("last", settings.last)):
        try:
            values.append(to_si(value, unit))
        except InputError as error:
            raise InputError(f"{given(name, value)}: {error}") from None
    low, high = values
    asked = f"{given('first', settings.first)} {given('last', settings.last)}"
    if not (math.isfinite(low) and math.isfinite(high)):
        raise InputError(f"{asked}: both must be finite")
    if not low < high:
        hint = "exchange them" if low > high else "they are equal: 'eig' looks at a single value"
        raise InputError(f"{asked}: the first must be below the last; {hint}")
    if settings.parameter.rpartition(".")[2] == SPEED and low <= 0.0:
        raise InputError(
            f"{given('first', settings.first)}: a {settings.parameter} of zero or below is none to "
            "roll at, creepages are divided by it; begin above zero, such as "
            f"{argument('first')} '{_LOW_SPEED:g} m/s'"
        )
    return low, high


def watched_channels(
    prepared: Prepared, wanted: Sequence[str], model: AutonomousField
) -> list[int]:
    """Return the channels to watch: those asked for, else the coordinates.

    Coordinates that are set apart, such as the angle of a wheel that rolls, are none.
    """
    names = [c.name for c in prepared.equations.channels]
    apart = {s.name for k, s in enumerate(prepared.equations.states) if k not in model.kept}
    for name in wanted:
        if name not in names:
            raise InputError(f"{argument('channels')} {unknown_name('channel', name, names)}")
        if name in apart:
            raise InputError(
                f"{given('channels', name)}: no rate depends on it, so it is set apart and "
                "goes on for "
                "ever "
                "instead of repeating; watch its rate or another coordinate"
            )
    chosen = list(wanted)
    if not chosen:
        joints = [j.name for j in prepared.subject.system.joints() if j.name in names]
        joints = [name for name in joints if name not in apart]
        states = {s.name for s in prepared.equations.states}
        chosen = [n for n in joints if n in states][:_MOST_CHANNELS] or joints[:_MOST_CHANNELS]
    if not chosen:
        raise InputError(f"{argument('channels')}: missing: name a channel to watch")
    return [names.index(name) for name in dict.fromkeys(chosen)]


def moving_channels(prepared: Prepared, model: AutonomousField, shape: Vector) -> list[int]:
    """Return the channels of the coordinates that move most in a shape, the largest first.

    A radian counts as much as a metre.

    Parameters
    ----------
    prepared, model
        The model.
    shape
        Of the states kept, complex, shape (n_kept,).
    """
    names = {c.name: k for k, c in enumerate(prepared.equations.channels)}
    positions = set(model.equations.positions)
    among = [k for k, state in enumerate(model.kept) if state in positions]
    among.sort(key=lambda k: -abs(shape[k]))
    return [names[n] for k in among if (n := model.names[k]) in names][:_MOST_CHANNELS]


def first_balance(
    prepared: Prepared, index: int, first: float, target: Target
) -> tuple[AutonomousField, tuple[Vector, Vector]]:
    """Return the field and the equilibrium, states kept and unknowns, at the first value.

    The start is that which the file gives at this value. Where the search from there fails the
    equilibrium is followed from the file's own value.
    """
    name = prepared.equations.parameters[index].name
    own = float(prepared.kernel.parameters[index])
    scenario = target.choices
    starts = ParameterStarts(prepared, target, name)
    try:
        at_first = prepared if first == own else starts.at(first)
        model, start = balance_at(at_first, index, first, scenario)
    except NumericalError as error:
        reason = NumericalError(f"{name} = {first:.6g}: {error}")
        if own == first:
            raise reason from None
        try:
            model, (state, unknowns) = balance_at(prepared, index, own, scenario)
            values = list(steps(own, first, _APPROACH))
            found = follow_balance(model, values, state, unknowns)[-1]
        except NumericalError:
            raise reason from None
        start = found.state, found.unknowns
    return model, start


def balance_at(
    prepared: Prepared, index: int, value: float, scenario: Scenario | None
) -> tuple[AutonomousField, tuple[Vector, Vector]]:
    """Return the field and the equilibrium at a value, as searched from the start values."""
    name = prepared.equations.parameters[index].name
    values = prepared.kernel.parameters.copy()
    values[index] = value
    prepared.kernel.set_parameters(values)
    model = AutonomousField(prepared.equations, name, values)
    point = balanced_point(prepared, name, value, scenario, model)
    return model, (model.reduced(point.state), point.unknowns)


def balanced_point(
    prepared: Prepared,
    name: str,
    value: float,
    scenario: Scenario | None,
    model: AutonomousField,
) -> AssembledPoint:
    """Return the reference point of a system whose kernel has a parameter's value."""
    return reference_point(
        prepared,
        value if name == SPEED else (scenario.speed or 0.0 if scenario else 0.0),
        scenario.start if scenario else None,
        slopes=model,
    )
