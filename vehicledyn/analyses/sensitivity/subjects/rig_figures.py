"""Derivatives of what the suspension rig shows: toe, camber, rates, centres, compliances."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import partial

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.mechanism.rig import (
    RigRequest,
    channels_of,
    check_test,
    named_test,
    swept,
    values_of,
)
from vehicledyn.analyses.mechanism.rig_bench import Bench
from vehicledyn.analyses.mechanism.rig_slopes import BenchSlopes
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.called import called_parts
from vehicledyn.analyses.sensitivity.names import START, matching
from vehicledyn.base.errors import InputError, NumericalError, unknown_name
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown, to_si
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

Floats = NDArray[np.float64]

_FORM = "rig(QUANTITY, TEST, -60 mm:60 mm:4)"
_OPTIONS = "travel", "steering"


@dataclass(frozen=True)
class _Asked:
    """What a name asks for: a pattern of quantities, and what to do on the rig."""

    name: str
    pattern: str
    request: RigRequest


def find_rig_sensitivity(
    target: Target, of: Sequence[str], to: Sequence[str], progress: Progress, *, memory: Memory
) -> SensitivityTable:
    """Return derivatives of quantities of an axle on the suspension rig by its parameters.

    Parameters
    ----------
    target
        A system with sensors ``wheel_angles``, or a scenario of one.
    of
        Names such as ``rig(left.toe_gain, parallel)``, ``rig(*.camber, roll, -2 deg:2 deg:4)``
        and ``rig(left.caster, steer, 10 mm, travel=20 mm)``.
    to
        Patterns of parameters.
    progress
        Called with what is going on.
    memory
        Knows places.

    Raises
    ------
    InputError
        If a name or range means nothing.
    NumericalError
        If a place cannot be reached, or has no derivative.
    """
    asked = [_parsed(name) for name in dict.fromkeys(of)]
    if any(name.startswith(START) for name in to):
        raise InputError("an axle on the rig has no start values; name parameters")
    progress("assembling the axle", None)
    rigs: dict[tuple[str | None, float], BenchSlopes] = {}
    tables: dict[RigRequest, Floats] = {}
    figures: list[tuple[Quantity, Floats]] = []
    for item in asked:
        own = item.request
        key = own.steering, own.travel
        if key not in rigs:
            bench = Bench(target, own.steering)
            bench.lift(own.travel)
            rigs[key] = BenchSlopes(bench)
        check_test(rigs[key].bench, own.test, target)
        if own not in tables:
            tables[own] = _table(rigs[key], own, progress, memory)
        figures += list(_figures(item, rigs[key].bench, tables[own]))
    slopes = next(iter(rigs.values()))
    parameters = [slopes.bench.equations.parameters[k] for k in slopes.parameters]
    model = slopes.bench.equations.name
    chosen = matching([p.name for p in parameters], to, model)
    rows = np.array([numbers for _, numbers in figures])
    lost = ~np.isfinite(rows).all(axis=1)
    notes = [
        f"warning: '{quantity.name}' has no {_lost_by(numbers)}"
        for (quantity, numbers), is_lost in zip(figures, lost, strict=True)
        if is_lost
    ]
    rows[lost, 1:] = np.nan
    return SensitivityTable(
        target.title,
        model,
        tuple(
            Quantity(parameters[k].name, parameters[k].unit, parameters[k].description)
            for k in chosen
        ),
        np.array([parameters[k].value for k in chosen]),
        tuple(quantity for quantity, _ in figures),
        rows[:, 0],
        rows[:, 1:][:, chosen],
        notes=tuple(notes),
    )


def _lost_by(numbers: Floats) -> str:
    """Return what a quantity lacks, from its value and derivatives, and why."""
    if np.isfinite(numbers[0]):
        return "derivative: a law has a corner here, such as a stop that begins to touch"
    return "value here, and no derivative"


def _table(slopes: BenchSlopes, own: RigRequest, progress: Progress, memory: Memory) -> Floats:
    """Return quantities and derivatives at all values, (n_values, 1 + n_parameters, n)."""
    test, bench = named_test(own.test), slopes.bench
    values = _values(own)

    def at(value: float) -> Floats:
        given = own.test, own.travel, own.steering, value, bench.place
        found, bench.place = memory.recall_or_raise(
            "slopes", given, partial(_found, slopes, own.test, value)
        )
        return found

    found, failure = swept(bench, test, values, at, progress=progress, memory=Memory())
    if failure:
        raise NumericalError(failure)
    return found


def _found(slopes: BenchSlopes, test: str, value: float) -> tuple[Floats, tuple[Floats, Floats]]:
    return slopes.at(named_test(test), value), slopes.bench.place


def _values(own: RigRequest) -> Floats:
    return values_of(named_test(own.test), "0" if own.values is None else own.values)


def _figures(asked: _Asked, bench: Bench, table: Floats) -> Iterator[tuple[Quantity, Floats]]:
    """Yield the quantities that a name asks for, with values and derivatives."""
    own, test = asked.request, named_test(asked.request.test)
    channels = channels_of(bench, test)[1:]
    known = [k for k, c in enumerate(channels) if np.isfinite(table[:, 0, k]).any()]
    chosen = [k for k in known if fnmatchcase(channels[k].name, asked.pattern)]
    if not chosen:
        names = [channels[k].name for k in known]
        raise InputError(f"'{asked.name}': {unknown_name('quantity', asked.pattern, names)}")
    for k in chosen:
        for row, value in zip(table, _values(own), strict=True):
            at = shown(float(value), test.unit)
            also = f", travel = {shown(own.travel, 'm')}" if own.travel else ""
            also += f", steering = {own.steering}" if own.steering else ""
            name = f"{channels[k].name} at {test.control} = {at}{also}"
            quantity = Quantity(name, channels[k].unit, channels[k].description)
            yield quantity, row[:, k]


def _parsed(name: str) -> _Asked:
    """Return what a name asks for.

    Raises
    ------
    InputError
        If a part is missing or means nothing.
    """
    parts, options = called_parts(name, _FORM, (2, 3), _OPTIONS)
    try:
        test = named_test(parts[1])
        travel = float(to_si(options.get("travel", 0.0), "m"))
        values = parts[2] if len(parts) > 2 else None
        request = RigRequest(parts[1], values, travel, options.get("steering"))
        if values is not None:
            values_of(test, values)
    except InputError as error:
        raise InputError(f"'{name}': {error}") from None
    return _Asked(name, parts[0], request)
