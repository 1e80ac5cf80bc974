"""Derivatives of gains, phases, parts and peaks of models linearised with inputs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.linear.linear_slopes import InputSlopes, differentiable
from vehicledyn.analyses.linear.response import chosen_rows, linearise_with_inputs
from vehicledyn.analyses.preparation.prepared import Progress, refuse_multipliers
from vehicledyn.analyses.sensitivity.names import directions
from vehicledyn.analyses.sensitivity.response_peaks import find_peak
from vehicledyn.base.errors import InputError
from vehicledyn.base.ranges import read_range
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.response_table import ratio_unit
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

_KINDS = "gain|phase|real|imaginary|peak_gain|peak_frequency"
_NAME = re.compile(rf"({_KINDS})\(([^,]+),(.+),([^,]+)\)")


class _Asked(NamedTuple):
    """What a name asks for: frequencies, or for peaks the ends of their range [Hz]."""

    kind: str
    output: str
    input: str
    frequencies: tuple[float, ...]


class _Place(NamedTuple):
    """Numbers of an output and an input, and the unit of their ratio."""

    row: int
    column: int
    unit: str


def find_response_sensitivity(
    target: Target,
    of: Sequence[str],
    to: Sequence[str],
    speed: float | None,
    progress: Progress,
    *,
    memory: Memory,
) -> SensitivityTable:
    """Return derivatives of gains, phases and peaks by parameters.

    Parameters
    ----------
    target
        A scenario or model.
    of
        Names such as ``gain(OUTPUT, INPUT, 1.5 Hz)``, ``phase(OUTPUT, INPUT, 1 Hz:5 Hz:8)``, whose
        range stands for several frequencies, ``real(...)`` and ``imaginary(...)`` alike,
        ``peak_gain(OUTPUT, INPUT, 0.5 Hz:3 Hz)`` and ``peak_frequency(...)``.
    to
        Patterns of parameters.
    speed
        Forward speed [m/s]; the scenario's own if None.
    progress
        Called with what is going on.
    memory
        Knows figures.

    Raises
    ------
    InputError
        If a name means nothing.
    NumericalError
        If there is no reference motion, a derivative does not exist, or there is no peak.
    """
    asked = [_parsed(name) for name in of]
    if any(name.startswith("start.") for name in to):
        raise InputError("a frequency response has no start values; name parameters")
    inputs = list(dict.fromkeys(item.input for item in asked))
    outputs = list(dict.fromkeys(item.output for item in asked))
    model = linearise_with_inputs(
        target, inputs=inputs, speed=speed, progress=progress, outputs=outputs
    )
    refuse_multipliers(model.prepared.equations)
    rows = chosen_rows(model.prepared, outputs)
    progress("differentiating the response", None)
    slopes = differentiable(model, rows, target)
    e = model.prepared.equations
    chosen = directions(e, model.prepared.kernel.parameters, model.point.state, to)
    own = {e.parameters[k].name for k in slopes.parameters}
    kept = [k for k, item in enumerate(chosen.quantities) if item.name in own]
    figures, values, found = [], [], []
    for name, item in zip(of, asked, strict=True):
        row, column = outputs.index(item.output), inputs.index(item.input)
        unit = ratio_unit(e.channels[rows[row]].unit, model.inputs[column].unit)
        place = _Place(row, column, unit)
        for quantity, value, slope in _figures(slopes, name, item, place, memory):
            figures.append(quantity)
            values.append(value)
            found.append(slope)
    return SensitivityTable(
        target.title,
        e.name,
        tuple(chosen.quantities[k] for k in kept),
        chosen.values[kept],
        tuple(figures),
        np.array(values),
        (np.array(found) @ chosen.by_parameter)[:, kept],
        notes=model.remarks,
    )


def _figures(
    slopes: InputSlopes, name: str, asked: _Asked, place: _Place, memory: Memory
) -> Iterator[tuple[Quantity, float, NDArray[np.float64]]]:
    """Yield what a name asks for, with values and derivatives by all parameters."""
    kind, output, which, frequencies = asked
    row, column, unit = place
    if kind.startswith("peak"):
        find = partial(find_peak, slopes, row, column, *frequencies)
        gain, gain_slope, peak, moved = memory.recall_or_raise("peak", name, find)
        words = f"of the peak of {output} to {which}"
        if kind == "peak_gain":
            yield Quantity(name, unit, f"Gain {words}"), gain, gain_slope
        else:
            yield Quantity(name, "Hz", f"Frequency {words}"), peak, moved
        return
    for frequency in frequencies:
        given = kind, row, column, frequency
        value, slope = memory.recall_or_raise("figure", given, partial(_figure, slopes, *given))
        label = name if len(frequencies) == 1 else f"{kind}({output}, {which}, {frequency:g} Hz)"
        words = f"{kind} part" if kind in ("real", "imaginary") else kind
        text = f"{words.capitalize()} of {output} to {which} at {frequency:g} Hz"
        yield Quantity(label, "rad" if kind == "phase" else unit, text), value, slope


def _figure(
    slopes: InputSlopes, kind: str, row: int, column: int, frequency: float
) -> tuple[float, np.typing.NDArray[np.float64]]:
    """Return a part, or a gain or a phase [rad]: of d(ln H) the real and the imaginary part."""
    value, slope = slopes.response(column, row, frequency)
    if kind in ("real", "imaginary"):
        both = (value.real, slope.real) if kind == "real" else (value.imag, slope.imag)
        return float(both[0]), np.array(both[1])
    if value == 0.0:
        missing = np.full(len(slope), np.nan)
        return 0.0 if kind == "gain" else np.nan, missing
    part = slope / value
    if kind == "gain":
        return abs(value), np.asarray(abs(value) * part.real, dtype=float)
    return float(np.angle(value)), np.asarray(part.imag, dtype=float)


def _parsed(name: str) -> _Asked:
    """Return what a name asks for.

    Raises
    ------
    InputError
        If a part is missing or a frequency is none.
    """
    match = _NAME.fullmatch(name)
    if match is None:
        raise InputError(
            f"'{name}': write gain(OUTPUT, INPUT, 1.5 Hz), likewise phase, real or imaginary, or "
            "peak_gain(OUTPUT, INPUT, 0.5 Hz:3 Hz)"
        )
    try:
        frequencies = _frequencies(match[1], match[4].strip())
    except InputError as error:
        raise InputError(f"'{name}': {error}") from None
    if not all(0.0 < frequency < np.inf for frequency in frequencies):
        raise InputError(f"'{name}': the frequency must be above zero and finite")
    return _Asked(match[1], match[2].strip(), match[3].strip(), frequencies)


def _frequencies(kind: str, text: str) -> tuple[float, ...]:
    if not kind.startswith("peak"):
        return read_range(text).values("Hz")
    ends = [float(to_si(part.strip(), "Hz")) for part in text.split(":") if part.strip()]
    if len(ends) != 2 or not ends[0] < ends[1]:
        raise InputError(f"'{text}': a peak lies in a range, such as 0.5 Hz:3 Hz")
    return tuple(ends)
