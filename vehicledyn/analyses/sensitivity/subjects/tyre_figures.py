"""Derivatives of forces and stiffnesses of a tyre property file by its coefficients."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.called import called_parts
from vehicledyn.analyses.sensitivity.names import matching
from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.ranges import read_range
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable
from vehicledyn.road.tyre_files.names import coefficients
from vehicledyn.road.tyre_files.tyre_file import ValidRange
from vehicledyn.road.tyres.tyre import TyreInput
from vehicledyn.road.tyres.tyre_of_file import TyreOfFile
from vehicledyn.symbolic import ops

Floats = NDArray[np.float64]

_FORM = "tyre(lateral_force, 4000 N, slip_angle=0 deg:8 deg:4, camber=1 deg)"
_SPEED = 16.7
"""Speed of the wheel [m/s], as in the curves of a tyre file."""

_SLIPS = {"longitudinal_slip": "1", "slip_angle": "rad", "camber": "rad"}
_FORCES = {
    "longitudinal_force": ("N", "Force along the wheel"),
    "lateral_force": ("N", "Force across the wheel, to the left"),
    "aligning_moment": ("N*m", "Moment about the ground normal"),
    "overturning_moment": ("N*m", "Moment about the longitudinal axis"),
    "rolling_resistance": ("N*m", "Moment about the spin axis"),
}
_STIFFNESSES = {
    "slip_stiffness": ("longitudinal_force", "longitudinal_slip", "N"),
    "cornering_stiffness": ("lateral_force", "slip_angle", "N/rad"),
    "aligning_stiffness": ("aligning_moment", "slip_angle", "N*m/rad"),
    "camber_stiffness": ("lateral_force", "camber", "N/rad"),
}
"""Slopes of a force by a slip: both, and the unit."""

_PEAKS = {
    "peak_longitudinal_force": ("longitudinal_force", "longitudinal_slip", 0.6),
    "peak_lateral_force": ("lateral_force", "slip_angle", 0.5),
}
"""Largest sizes of a force over a slip: both, and how far to both sides it is sought."""

_SCANNED = 241
"""Slips at which a peak is looked for, before it is found between two of them."""

_LEFT_OUT_AT_ZERO = ("QSY7",)
"""Coefficients that the law does without where they are zero, so that they have no derivative."""

_UNITS = {
    "length": "m",
    "force": "N",
    "time": "s",
    "mass": "kg",
    "angle": "rad",
    "pressure": "Pa",
}


@dataclass(frozen=True)
class _Asked:
    """A force or stiffness, with what the tyre feels: load and slips, one row each place."""

    quantity: str
    inputs: Floats


def find_tyre_sensitivity(
    file: str, of: Sequence[str], to: Sequence[str], progress: Progress, *, memory: Memory
) -> SensitivityTable:
    """Return derivatives of steady forces of a tyre property file by its coefficients.

    Parameters
    ----------
    file
        Tyre property file, or the name of one of the library.
    of
        Names such as ``tyre(lateral_force, 4000 N, slip_angle=4 deg)`` and
        ``tyre(cornering_stiffness, 2 kN:6 kN:4)``, the latter at no slip where none is given.
    to
        Patterns of coefficients, such as ``PDY*``.
    progress
        Called with what is going on.
    memory
        Not used: it takes no time.

    Raises
    ------
    InputError
        If the file cannot be read, or a name means nothing.
    """
    asked = [_parsed(name) for name in of]
    tyre = TyreOfFile(file=file, mirror="never")
    known, values = coefficients(), tyre.content.values
    names = [n for n in values if n in known and known[n].section.endswith("_COEFFICIENTS")]
    chosen = [names[k] for k in matching(names, to, tyre.path.name)]
    progress("differentiating the tyre", None)
    law = _Law(tyre, chosen)
    figures, found, places = [], [], []
    for item in asked:
        for inputs in item.inputs:
            figures.append(_quantity(item, inputs))
            places.append(law.place(item.quantity, inputs))
            found.append(law.at(item.quantity, places[-1]))
    outside = _outside(tyre.content.ranges, figures, places)
    return SensitivityTable(
        f"Tyre {tyre.path.name}",
        tyre.path.name,
        tuple(Quantity(n, _unit(known[n].dimension), known[n].meaning) for n in chosen),
        np.array([float(values[n]) for n in chosen]),
        tuple(figures),
        np.array([value for value, _ in found]),
        np.array([slope for _, slope in found]).reshape(len(found), len(chosen)),
        notes=tuple(outside),
    )


class _Law:
    """Forces and stiffnesses of a tyre, with their derivatives by chosen coefficients."""

    def __init__(self, tyre: TyreOfFile, chosen: Sequence[str]) -> None:
        inputs = ops.column([ops.symbol(name) for name in ("load", *_SLIPS)])
        symbols = ops.column([ops.symbol(name) for name in chosen])
        p = tyre.coefficients()
        self._values = np.array([float(getattr(p, name)) for name in chosen])
        moving = zip(chosen, self._values, strict=True)
        acts = [v != 0.0 or name not in _LEFT_OUT_AT_ZERO for name, v in moving]
        p = p.changed(**{n: symbols[k] for k, n in enumerate(chosen) if acts[k]})
        forces = tyre.acting_forces(
            p, TyreInput(inputs[0], inputs[1], inputs[2], inputs[3], _SPEED)
        )
        rows: dict[str, Any] = {name: ops.scalar(getattr(forces, name)) for name in _FORCES}
        for name, (force, slip, _) in _STIFFNESSES.items():
            rows[name] = ops.derivative(rows[force], inputs[1 + list(_SLIPS).index(slip)], 1.0)
        self._names = list(rows)
        column = ops.column(list(rows.values()))
        self._value = ops.numeric([inputs, symbols], column)
        self._slope = ops.numeric([inputs, symbols], ops.jacobian(column, symbols))

    def place(self, quantity: str, inputs: Floats) -> Floats:
        """Return what the tyre feels where a quantity is taken: of a peak, where that is.

        Raises
        ------
        InputError
            If there is no peak.
        """
        if quantity not in _PEAKS:
            return inputs
        force, slip, reach = _PEAKS[quantity]
        return self._peak(force, 1 + list(_SLIPS).index(slip), inputs, reach)

    def at(self, quantity: str, inputs: Floats) -> tuple[float, Floats]:
        """Return a quantity at its place, and its derivatives.

        That of a peak is the force's there, where moving it makes no difference.

        Raises
        ------
        InputError
            If they are no numbers.
        """
        if quantity in _PEAKS:
            value, slope = self.at(_PEAKS[quantity][0], inputs)
            return abs(value), np.sign(value) * slope
        row = self._names.index(quantity)
        value = float(self._value(inputs, self._values)[row, 0])
        slope = self._slope(inputs, self._values)[row]
        if not (np.isfinite(value) and np.isfinite(slope).all()):
            raise InputError(f"{quantity} at {inputs[0]:g} N has no finite derivatives there")
        return value, slope

    def _peak(self, force: str, column: int, inputs: Floats, reach: float) -> Floats:
        """Return what the tyre feels where the size of a force is largest."""
        from scipy.optimize import minimize_scalar

        row = self._names.index(force)

        def at(slip: float) -> Floats:
            moved = inputs.copy()
            moved[column] = slip
            return moved

        def size(slip: float) -> float:
            return -abs(float(self._value(at(slip), self._values)[row, 0]))

        places = np.linspace(-reach, reach, _SCANNED)
        k = int(np.argmin([size(float(place)) for place in places]))
        if not 0 < k < _SCANNED - 1:
            raise InputError(f"the {force.replace('_', ' ')} at {inputs[0]:g} N has no peak")
        ends = float(places[k - 1]), float(places[k + 1])
        found = minimize_scalar(size, bounds=ends, method="bounded", options={"xatol": 1e-12})
        return at(float(found.x))


def _quantity(asked: _Asked, inputs: Floats) -> Quantity:
    pairs = zip(_SLIPS.items(), inputs[1:], strict=True)
    slips = [f"{name} = {shown(float(v), u if u != '1' else '')}" for (name, u), v in pairs if v]
    name = f"{asked.quantity} at {', '.join([shown(float(inputs[0]), 'N'), *slips])}"
    if asked.quantity in _FORCES:
        return Quantity(name, *_FORCES[asked.quantity])
    if asked.quantity in _PEAKS:
        force, slip, _ = _PEAKS[asked.quantity]
        return Quantity(name, "N", f"Largest size of the {force} over {slip}".replace("_", " "))
    force, slip, unit = _STIFFNESSES[asked.quantity]
    words = f"{force} by {slip}".replace("_", " ").capitalize()
    return Quantity(name, unit, words)


def _outside(
    ranges: Mapping[str, ValidRange], figures: Sequence[Quantity], places: Sequence[Floats]
) -> list[str]:
    """Return a warning for each range of a tyre file that is left, with where this is farthest."""
    inputs, notes = np.array(places), []
    for column, name in enumerate(("load", *_SLIPS)):
        known = ranges.get(name)
        if known is None:
            continue
        beyond = np.maximum(known.lowest - inputs[:, column], inputs[:, column] - known.highest)
        count, worst = int(np.sum(beyond > 0.0)), int(np.argmax(beyond))
        if not count:
            continue
        low, high, value = known.lowest, known.highest, float(inputs[worst, column])
        unit = "" if known.unit == "1" else f" {known.unit}"
        others = f" and {count - 1} more" if count > 1 else ""
        words = name.replace("_", " ")
        notes.append(
            f"warning: '{figures[worst].name}'{others}: the {words} of {value:.4g}{unit} is "
            f"outside {low:.4g} to {high:.4g}{unit}, the range of the tyre file"
        )
    return notes


def _unit(dimension: str) -> str:
    """Return the SI unit of a dimension such as "force*length/angle"."""
    return re.sub(r"[a-z]+", lambda match: _UNITS[match[0]], dimension)


def _parsed(name: str) -> _Asked:
    """Return what a name asks for.

    Raises
    ------
    InputError
        If a part is missing or means nothing.
    """
    parts, options = called_parts(name, _FORM, (2,), _SLIPS)
    known = [*_FORCES, *_STIFFNESSES, *_PEAKS]
    if parts[0] not in known:
        raise InputError(f"'{name}': {unknown_name('quantity', parts[0], known)}")
    try:
        loads = read_range(parts[1]).values("N")
        slips = [read_range(options.get(s, "0")).values(unit) for s, unit in _SLIPS.items()]
    except InputError as error:
        raise InputError(f"'{name}': {error}") from None
    if not min(loads) > 0.0:
        raise InputError(f"'{name}': the load must be above zero")
    axes = np.meshgrid(loads, *slips, indexing="ij")
    return _Asked(parts[0], np.stack([axis.ravel() for axis in axes], axis=1))
