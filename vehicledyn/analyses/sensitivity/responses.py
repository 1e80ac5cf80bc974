"""Derivatives of gains and phases at frequencies, of models linearised with inputs."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from vehicledyn.analyses.linear.linear_slopes import InputSlopes, differentiable
from vehicledyn.analyses.linear.response import chosen_rows, linearise_with_inputs
from vehicledyn.analyses.preparation.prepared import Progress, refuse_multipliers
from vehicledyn.analyses.sensitivity.names import directions
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.response_table import ratio_unit
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

_NAME = re.compile(r"(gain|phase)\(([^,]+),(.+),([^,]+)\)")
_KIND = re.compile(r"(gain|phase)\(.*\)")


def is_response(name: str) -> bool:
    """Return whether a name asks for a frequency response, such as ``gain(y, u, 2 Hz)``."""
    return _KIND.fullmatch(name) is not None and "," in name


def find_response_sensitivity(
    target: Target, of: Sequence[str], to: Sequence[str], speed: float | None, progress: Progress
) -> SensitivityTable:
    """Return derivatives of gains and phases by parameters.

    Parameters
    ----------
    target
        A scenario or model.
    of
        Names such as ``gain(OUTPUT, INPUT, 1.5 Hz)`` and ``phase(...)``.
    to
        Patterns of parameters.
    speed
        Forward speed [m/s]; the scenario's own if None.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If a name means nothing.
    NumericalError
        If there is no reference motion, or a derivative does not exist.
    """
    asked = [_parsed(name) for name in of]
    if any(name.startswith("start.") for name in to):
        raise InputError("a frequency response has no start values; name parameters")
    inputs = list(dict.fromkeys(item[2] for item in asked))
    outputs = list(dict.fromkeys(item[1] for item in asked))
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
    for name, (kind, output, which, frequency) in zip(of, asked, strict=True):
        row, column = outputs.index(output), inputs.index(which)
        value, slope = _figure(slopes, kind, row, column, frequency)
        units = e.channels[rows[row]].unit, model.inputs[column].unit
        unit = "rad" if kind == "phase" else ratio_unit(*units)
        text = f"{kind.capitalize()} of {output} to {which} at {frequency:g} Hz"
        figures.append(Quantity(name, unit, text))
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
    )


def _figure(
    slopes: InputSlopes, kind: str, row: int, column: int, frequency: float
) -> tuple[float, np.typing.NDArray[np.float64]]:
    """Return a gain or a phase [rad]: of d(ln H) the real and the imaginary part."""
    value, slope = slopes.response(column, row, frequency)
    if value == 0.0:
        missing = np.full(len(slope), np.nan)
        return 0.0 if kind == "gain" else np.nan, missing
    part = slope / value
    if kind == "gain":
        return abs(value), np.asarray(abs(value) * part.real, dtype=float)
    return float(np.angle(value)), np.asarray(part.imag, dtype=float)


def _parsed(name: str) -> tuple[str, str, str, float]:
    """Return kind, output, input and frequency [Hz] of a name.

    Raises
    ------
    InputError
        If one is missing or the frequency is none.
    """
    match = _NAME.fullmatch(name)
    if match is None:
        raise InputError(f"'{name}': write gain(OUTPUT, INPUT, 1.5 Hz), or phase(...) alike")
    try:
        frequency = float(to_si(match[4].strip(), "Hz"))
    except InputError as error:
        raise InputError(f"'{name}': {error}") from None
    if not 0.0 < frequency < np.inf:
        raise InputError(f"'{name}': the frequency must be above zero and finite")
    return match[1], match[2].strip(), match[3].strip(), frequency
