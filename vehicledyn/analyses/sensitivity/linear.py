"""Derivatives of equilibria, eigenvalues and the linear critical speed, by all parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.equilibrium import find_equilibrium
from vehicledyn.analyse.gradients.eigenvalues import EigenDerivatives, EigenSlopes, LinearPoint
from vehicledyn.analyse.gradients.linear_system import Following, SystemDerivatives
from vehicledyn.analyses.linear.mode_report import NEAR_ZERO
from vehicledyn.analyses.linear.reference_motion import ReferenceMotion
from vehicledyn.analyses.preparation.own_speed import at_speed
from vehicledyn.analyses.preparation.prepare import (
    BALANCE_TOLERANCE,
    AssembledPoint,
    prepare,
    start_point,
)
from vehicledyn.analyses.preparation.prepared import Prepared, Progress, refuse_multipliers
from vehicledyn.analyses.preparation.validity.bent_beams import bent_among
from vehicledyn.analyses.sensitivity.figure_kinds import (
    BALANCE,
    CRITICAL,
    EIGENVALUES,
    is_mode_shape,
)
from vehicledyn.analyses.sensitivity.mode_figures import Found, mode_figures
from vehicledyn.analyses.sensitivity.mode_shapes import mode_shapes
from vehicledyn.analyses.sensitivity.names import directions
from vehicledyn.base.errors import InputError, NumericalError, nearest_name
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

Floats = NDArray[np.float64]

_STRIDE, _MOST_STRIDES, _MOST_STEPS = 1.15, 40, 30
_FOUND = 1e-9
"""Part of a critical speed that its last correction may have; what is then left is its square."""

_MOST_SECANTS, _NEAR = 6, 1e-6
"""Rough steps towards a critical speed, and the part of it to which they are worth while."""


KINDS = LinearPoint, EigenSlopes, Quantity
"""Results of steps that a memory knows."""


@dataclass
class _Model:
    """A model at its point to linearise about."""

    prepared: Prepared
    point: LinearPoint
    following: Following
    """How the states that are held follow the parameters."""
    derivatives: EigenDerivatives
    motion: ReferenceMotion
    speed: float
    """At which it is balanced [m/s]."""
    memory: Memory
    """Knows results of :data:`KINDS`."""

    @property
    def speed_index(self) -> int:
        """Number of the parameter that is the speed.

        Raises
        ------
        InputError
            If there is none.
        """
        names = [p.name for p in self.prepared.equations.parameters]
        if "speed" not in names:
            raise InputError(
                f"'{self.prepared.equations.name}' has no parameter 'speed', so no critical speed"
            )
        return names.index("speed")

    def slopes(self, choice: Callable[[Any], list[int]]) -> EigenSlopes:
        """Return the derivatives of the eigenvalues that are chosen, at the point."""
        find = partial(self.derivatives.at, self.point, choice)
        return self.memory.recall_or_raise("slopes", (choice.__name__, self.point), find)

    def eigenvalues(self) -> Any:
        """Return the eigenvalues at the point."""
        find = partial(self.derivatives.eigenvalues, self.point)
        return self.memory.recall_or_raise("eigenvalues", self.point, find)

    def at_speed(self, speed: float, base: LinearPoint | None = None) -> LinearPoint:
        """Return the equilibrium at another speed [m/s], near the last one or a given one."""
        old = base or self.point
        find = partial(self._at_speed, speed, old)
        self.point = self.memory.recall_or_raise("at speed", (speed, old), find)
        if self.motion.is_given:
            point = AssembledPoint(self.point.state, self.point.unknowns)
            self.following = self.motion.at(point, self.point.parameters)[1]
        return self.point

    def _at_speed(self, speed: float, old: LinearPoint) -> LinearPoint:
        index = self.speed_index
        parameters = old.parameters.copy()
        along = self.derivatives.along(old, index, self.following.by_held[:, index])
        state = old.state + (speed - parameters[index]) * along
        parameters[index] = speed
        if self.motion.is_given:
            found = self.motion.started(parameters, speed)
            return replace(old, parameters=parameters, state=found.state, unknowns=found.unknowns)
        kernel = self.prepared.kernel.with_parameters(parameters)
        near = self.derivatives.balanced(old, kernel, state, BALANCE_TOLERANCE)
        if near is not None:
            return near
        balanced = find_equilibrium(
            self.prepared.equations,
            kernel,
            time=old.time,
            state=state,
            unknowns=old.unknowns,
            free=old.pairs[0],
            balanced=old.pairs[1],
            tolerance=BALANCE_TOLERANCE,
            derivatives=self.prepared.derivatives,
        )
        return replace(old, parameters=parameters, state=balanced.state, unknowns=balanced.unknowns)


def find_linear_sensitivity(
    target: Target,
    of: list[str],
    to: list[str],
    speed: float | None,
    progress: Progress,
    *,
    memory: Memory,
) -> SensitivityTable:
    """Return derivatives of an equilibrium, its eigenvalues or the critical speed.

    Parameters
    ----------
    target
        A scenario or model.
    of
        ``eigenvalues``, ``mode_shapes``, ``critical_speed``, or ``equilibrium.`` or
        ``mode_shapes.`` and patterns of states.
    to
        Patterns of parameters.
    speed
        Forward speed [m/s]; the scenario's own if None. The search for the critical speed begins
        there.
    progress
        Called with what is going on.
    memory
        Knows results of :data:`KINDS`.

    Raises
    ------
    InputError
        If a name means nothing, or the model has no speed.
    NumericalError
        If there is no equilibrium or no critical speed.
    """
    model = _model(target, speed, progress, memory)
    e = model.prepared.equations
    if any(name.startswith("start.") for name in to):
        raise InputError("an equilibrium has no start values; name parameters")
    figures: list[Quantity] = []
    values: list[float] = []
    rows: list[Floats] = []
    for name in of:
        progress(f"differentiating {name}", None)
        if name == EIGENVALUES:
            found = _eigenvalues(model)
        elif name == CRITICAL:
            found = _critical_speed(model)
        elif is_mode_shape(name):
            find = partial(mode_shapes, model.prepared, model.point, model.following, name)
            found = memory.recall_or_raise("shapes", name, find)
        else:
            found = _balance(model, name.removeprefix(BALANCE))
        for quantity, value, slope in found:
            figures.append(quantity)
            values.append(value)
            rows.append(slope)
    chosen = directions(e, model.point.parameters, model.point.state, to)
    kernel = model.prepared.kernel.with_parameters(model.point.parameters)
    point = AssembledPoint(model.point.state, model.point.unknowns)
    return SensitivityTable(
        target.title,
        e.name,
        chosen.quantities,
        chosen.values,
        tuple(figures),
        np.array(values),
        np.array(rows) @ chosen.by_parameter,
        notes=tuple(bent_among(model.prepared, [("", kernel, point)])),
    )


def _model(target: Target, speed: float | None, progress: Progress, memory: Memory) -> _Model:
    target, own = at_speed(target, speed)
    if own is None and target.choices is not None:
        own = target.choices.speed
    prepared = prepare(target, backend="auto", progress=progress, varies_states=True)
    refuse_multipliers(prepared.equations)
    motion = ReferenceMotion(prepared, own or 0.0, target)
    start = start_point(prepared, own or 0.0, motion.kind)
    point, following = motion.at(start, prepared.kernel.parameters)
    derivatives = EigenDerivatives(prepared.equations)
    return _Model(prepared, point, following, derivatives, motion, own or 0.0, memory)


def _by_parameter(model: _Model, slopes: EigenSlopes) -> Any:
    """Return the derivatives by parameters, which move the held states as well."""
    for row in slopes.by_held:
        model.following.check(row)
    return slopes.by_parameter + slopes.by_held @ model.following.by_held


def _eigenvalues(model: _Model) -> Found:
    """Return the figures of all modes but the zero ones, fastest growing first."""

    def chosen(values: Any) -> list[int]:
        kept = [k for k, v in enumerate(values) if v.imag >= 0.0 and abs(v) > NEAR_ZERO]
        return sorted(kept, key=lambda k: -values[k].real)

    slopes = model.slopes(chosen)
    by_parameter = _by_parameter(model, slopes)
    found: Found = []
    for k, value in enumerate(slopes.values):
        found += mode_figures(k + 1, complex(value), by_parameter[k])
    if not found:
        name = model.prepared.equations.name
        raise InputError(f"'{name}' has no modes but zeros, whose eigenvalues have no derivatives")
    return found


def _critical_speed(model: _Model) -> Found:
    """Return the speed at which a mode begins to grow: dv = -Re(dλ/dp) / Re(dλ/dv)."""
    index = model.speed_index
    stable, unstable, speed = _nearer(model, *_bracket(model, index))
    for _ in range(_MOST_STEPS):
        model.at_speed(speed)
        slopes = model.slopes(_fastest)
        growth, by_parameter = float(slopes.values[0].real), _by_parameter(model, slopes)[0]
        rate = float(by_parameter[index].real)
        stable, unstable = (stable, speed) if growth > 0.0 else (speed, unstable)
        step = -growth / rate if rate else np.inf
        if abs(step) <= _FOUND * speed:
            speed += step
            break
        inside = stable < speed + step < unstable
        speed = speed + step if inside else 0.5 * (stable + unstable)
    else:
        raise NumericalError(f"the critical speed near {speed:g} m/s was not found exactly")
    by_speed = -by_parameter.real / rate
    by_speed[index] = 0.0
    value = slopes.values[0].imag / (2.0 * np.pi)
    along = (by_parameter.imag + by_parameter[index].imag * by_speed) / (2.0 * np.pi)
    along[index] = 0.0
    return [
        (Quantity(CRITICAL, "m/s", "Speed at which a mode begins to grow"), speed, by_speed),
        (Quantity("critical_frequency", "Hz", "Frequency of that mode"), float(value), along),
    ]


def _fastest(values: Any) -> list[int]:
    """Return the oscillation that grows fastest, or decays most slowly."""
    moving = [k for k, v in enumerate(values) if v.imag > NEAR_ZERO]
    return [max(moving, key=lambda k: values[k].real)] if moving else []


def _bracket(model: _Model, index: int) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return a speed at which all oscillations decay and a higher one at which one grows.

    Each is returned with the growth of the oscillation that grows fastest there [1/s].
    """

    def growth(speed: float) -> float:
        model.at_speed(speed)
        values = model.eigenvalues()
        chosen = _fastest(values)
        return float(values[chosen[0]].real) if chosen else -np.inf

    speed = float(model.point.parameters[index])
    if speed <= 0.0:
        raise InputError("the search for the critical speed needs a speed above zero to begin at")
    here = speed, growth(speed)
    up = here[1] <= 0.0
    for _ in range(_MOST_STRIDES):
        other = here[0] * _STRIDE if up else here[0] / _STRIDE
        there = other, growth(other)
        if (there[1] <= 0.0) != up:
            return (here, there) if up else (there, here)
        here = there
    raise NumericalError(
        f"no mode begins to grow up to {here[0]:g} m/s: no critical speed was found"
    )


def _nearer(
    model: _Model, low: tuple[float, float], high: tuple[float, float]
) -> tuple[float, float, float]:
    """Return a bracket and a speed in it to go on from, sought with rough eigenvalues.

    ``low`` and ``high`` are speeds with the growth of an oscillation there, of which the first
    decays. The bracket stays as it is, since rough values decide nothing.
    """
    if not np.isfinite(low[1]):
        return low[0], high[0], high[0]
    (a, below), (b, above) = low, high
    speed = a + below / (below - above) * (b - a)
    if model.prepared.kernel.backend != "compiled":
        return low[0], high[0], speed
    base = model.point
    for _ in range(_MOST_SECANTS):
        point = model.at_speed(speed, base)
        kernel = model.prepared.kernel.with_parameters(point.parameters)
        find = partial(model.derivatives.rough_eigenvalues, point, base, kernel)
        values = model.memory.recall_or_raise("rough", (point, base), find)
        chosen = _fastest(values)
        growth = float(values[chosen[0]].real) if chosen else np.nan
        a, below, b, above = b, above, speed, growth
        found = b - above * (b - a) / (above - below) if above != below else np.nan
        if not low[0] < found < high[0]:
            break
        speed = float(found)
        if abs(speed - b) <= _NEAR * speed:
            break
    return low[0], high[0], speed


def _balance(model: _Model, pattern: str) -> Found:
    """Return the states, unknowns and channels of the equilibrium that a pattern names."""
    e = model.prepared.equations
    items = {item.name: item for item in (*e.states, *e.unknowns)}
    shown = [k for k, c in enumerate(e.channels) if c.name not in items]
    names = [*items, *(e.channels[k].name for k in shown)]
    kept = [name for name in names if fnmatchcase(name, pattern)]
    if not kept:
        guess = nearest_name(pattern, names)
        hint = f"; did you mean '{guess}'?" if guess else ""
        raise InputError(
            f"'{BALANCE}{pattern}' matches no coordinate and no channel of '{e.name}'{hint}"
        )
    slopes = np.vstack(model.derivatives.equilibrium(model.point, model.following.by_held))
    values = np.concatenate([model.point.state, model.point.unknowns])
    found: Found = []
    for (name, item), value, slope in zip(items.items(), values, slopes, strict=True):
        if name in kept:
            quantity = Quantity(f"{BALANCE}{name}", item.unit, item.description)
            found.append((quantity, float(value), slope))
    shown = [k for k in shown if e.channels[k].name in kept]
    return found + (_balanced_channels(model, shown, slopes[: len(e.states)]) if shown else [])


def _balanced_channels(model: _Model, shown: list[int], states: Floats) -> Found:
    """Return channels of the equilibrium by their numbers; ``states`` are its slopes."""
    prepared, point, following = model.prepared, model.point, model.following
    e, speeds = prepared.equations, list(prepared.equations.speeds)
    if not model.speed and prepared.subject.settling is None:
        state, held = point.state.copy(), states.copy()
        state[speeds], held[speeds] = 0.0, 0.0
        point = LinearPoint(point.parameters, point.time, state, point.unknowns)
        following = Following((), held)
    slopes = SystemDerivatives(e, (), shown).at(point, following).outputs
    kernel = prepared.kernel.with_parameters(point.parameters)
    values = kernel.outputs(point.time, point.state, point.unknowns)
    return [
        (
            Quantity(
                f"{BALANCE}{e.channels[k].name}", e.channels[k].unit, e.channels[k].description
            ),
            float(values[k]),
            slope,
        )
        for k, slope in zip(shown, slopes, strict=True)
    ]
