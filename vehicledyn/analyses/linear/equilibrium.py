"""The verb "equilibrium": nominal position and equilibrium of a vehicle side by side."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.linear.stability import Stability, stability_of
from vehicledyn.analyses.preparation.own_speed import at_speed, own_speed, refuse_idle_speed
from vehicledyn.analyses.preparation.prepare import (
    AssembledPoint,
    equilibrium_point,
    nominal_point,
    prepare,
)
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.analyses.preparation.validity.points import validity_warnings
from vehicledyn.base.units import shown
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.equilibrium_table import EquilibriumTable

_FORCE_UNITS = ("N", "N*m")
_SMALL = 5e-10
_DIGITS = 1e-9
"""Relative change below which a channel stays as it was."""


@dataclass(frozen=True)
class EquilibriumRow:
    """One quantity in the nominal position and in equilibrium, in SI."""

    name: str
    unit: str
    nominal: float
    equilibrium: float
    description: str = ""


@dataclass(frozen=True)
class EquilibriumReport:
    """Coordinates, forces and other channels in the nominal position and in equilibrium."""

    title: str
    model: str
    speed: float
    kind: str
    residual: float
    coordinates: list[EquilibriumRow]
    forces: list[EquilibriumRow]
    stability: Stability = field(default_factory=Stability)
    notes: tuple[str, ...] = ()
    channels: list[EquilibriumRow] = field(default_factory=list)

    def as_text(self) -> str:
        """Return the report as a table."""
        head = f"{self.model}: {self.kind} equilibrium"
        if self.speed:
            head += f" at {shown(self.speed, 'm/s')}"
        lines = [
            f"{head}, largest unbalanced acceleration {self.residual:.1e}",
            self.stability.as_text(),
            *self.notes,
            "",
            _head("coordinate"),
        ]
        for row in self.coordinates:
            lines.append(_line(row.name, *_position_texts(row)))
        lines += ["", _head("force")]
        for row in self.forces:
            change = row.equilibrium - row.nominal
            numbers = (row.nominal, row.equilibrium, change)
            lines.append(_line(row.name, *(f"{_clean(v):.3f} {row.unit}" for v in numbers)))
        moved = [row for row in self.channels if _is_moved(row)]
        if moved:
            lines += ["", _head("what else changes")]
        lines += [_line(row.name, *_channel_texts(row)) for row in moved]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Return the report as plain data in SI."""

        def table(rows: list[EquilibriumRow]) -> dict[str, Any]:
            return {
                r.name: {"unit": r.unit, "nominal": r.nominal, "equilibrium": r.equilibrium}
                for r in rows
            }

        return {
            "model": self.model,
            "speed": self.speed,
            "kind": self.kind,
            "residual": self.residual,
            "stability": self.stability.as_dict(),
            "notes": list(self.notes),
            "coordinates": table(self.coordinates),
            "forces": table(self.forces),
            "channels": table(self.channels),
        }

    @property
    def table(self) -> EquilibriumTable:
        """Return the report as a result file holds it."""
        values = [[[r.nominal for r in rows], [r.equilibrium for r in rows]] for rows in self._rows]
        names = [
            tuple(Quantity(r.name, r.unit, r.description) for r in rows) for rows in self._rows
        ]
        verdict = self.stability.verdict
        head = (f"{self.kind.capitalize()} equilibrium: {self.title}", self.model, self.kind)
        facts = (*head, self.speed, self.residual, verdict)
        (first, second, third), (at, under, beside) = names, values
        return EquilibriumTable(*facts, first, at, second, under, third, beside)

    @property
    def _rows(self) -> tuple[list[EquilibriumRow], list[EquilibriumRow], list[EquilibriumRow]]:
        return self.coordinates, self.forces, self.channels


def find_equilibrium(
    target: Target,
    *,
    speed: float | None,
    backend: Backend,
    progress: Progress,
) -> EquilibriumReport:
    """Return the equilibrium of a vehicle, or of a system at rest.

    Parameters
    ----------
    target
        A scenario or a model.
    speed
        Forward speed [m/s]; None for a model that stands, or for the start of a scenario.
    backend, progress
        As for a run.

    Raises
    ------
    NumericalError
        If there is no equilibrium; the message names what stays unbalanced.
    """
    is_own = own_speed(target) is not None
    target, speed = at_speed(target, speed)
    check = refuse_idle_speed if speed else None
    prepared = prepare(target, backend=backend, progress=progress, check=check, varies_states=True)
    kind, wanted = "static", 0.0
    if is_own:
        wanted = speed or 0.0
    elif speed is not None:
        kind, wanted = ("steady" if speed > 0.0 else "static"), speed
    elif target.choices is not None and prepared.subject.usual_start == "steady":
        kind, wanted = target.choices.start or "steady", target.choices.speed or 0.0
    moving = 0.0 if kind == "static" else wanted
    progress("finding the equilibrium", None)
    start = nominal_point(prepared, moving)
    how: Literal["static", "steady"] = "steady" if moving else "static"
    point = equilibrium_point(prepared, moving, how, slopes=prepared.derivatives)
    is_still = not moving and prepared.subject.settling is None
    if is_still:
        start, point = _still(prepared, start), _still(prepared, point)
    nominal, balanced = _channels(prepared, start), _channels(prepared, point)
    progress("finding its stability", None)
    stability = stability_of(prepared, point)
    coordinates, forces, channels = _tables(prepared, nominal, balanced)
    return EquilibriumReport(
        target.title,
        prepared.equations.name,
        0.0 if is_still else wanted,
        kind,
        point.residual,
        coordinates,
        forces,
        stability,
        tuple(filter(None, [point.remark, *validity_warnings(prepared, point)])),
        channels,
    )


def _still(prepared: Prepared, point: AssembledPoint) -> AssembledPoint:
    """Return a point without the velocities that a start gives it."""
    state = point.state.copy()
    state[list(prepared.equations.speeds)] = 0.0
    return replace(point, state=state)


def _channels(prepared: Prepared, point: AssembledPoint) -> NDArray[np.float64]:
    """Return all outputs at a point, evaluated now while its speed is set."""
    return np.array(
        prepared.kernel.outputs(prepared.subject.balance_time, point.state, point.unknowns)
    )


def _tables(
    prepared: Prepared, nominal: NDArray[np.float64], balanced: NDArray[np.float64]
) -> tuple[list[EquilibriumRow], list[EquilibriumRow], list[EquilibriumRow]]:
    """Return the rows of coordinates, of forces and of all other channels."""
    e = prepared.equations
    turned = [k for attitude in e.attitudes for k in attitude.quaternion]
    coordinates = {s.name for s in (*(e.states[k] for k in (*e.positions, *turned)), *e.unknowns)}
    rows = [
        EquilibriumRow(c.name, c.unit, float(a), float(b), c.description)
        for c, a, b in zip(e.channels, nominal, balanced, strict=True)
    ]
    return (
        [row for row in rows if row.name in coordinates],
        [row for row in rows if row.unit in _FORCE_UNITS],
        [row for row in rows if row.name not in coordinates and row.unit not in _FORCE_UNITS],
    )


_SHOWN_IN = {"rad": (180.0 / np.pi, "deg"), "m": (1e3, "mm"), "1": (1.0, "")}
"""Factor and unit in which positions are printed, by their SI unit."""


_TOLD_IN = {**_SHOWN_IN, "Pa": (1e-6, "MPa")}
"""Factor and unit in which other channels are printed, by their SI unit."""


def _is_moved(row: EquilibriumRow) -> bool:
    """Tell whether a channel that is no rate or power differs in equilibrium."""
    size = max(abs(row.nominal), abs(row.equilibrium))
    change = abs(row.equilibrium - row.nominal)
    return "/s" not in row.unit and row.unit != "W" and change > max(_DIGITS * size, _SMALL)


def _channel_texts(row: EquilibriumRow) -> tuple[str, ...]:
    factor, unit = _TOLD_IN.get(row.unit, (1.0, row.unit))
    values = (row.nominal, row.equilibrium, row.equilibrium - row.nominal)
    return tuple(f"{_clean(v * factor):.6g} {unit}".rstrip() for v in values)


def _position_texts(row: EquilibriumRow) -> tuple[str, str, str]:
    factor, unit = _SHOWN_IN.get(row.unit, (1.0, row.unit))
    values = (row.nominal, row.equilibrium, row.equilibrium - row.nominal)
    nominal, balanced, change = (f"{_clean(v * factor):.4f} {unit}".rstrip() for v in values)
    return nominal, balanced, change


def _head(words: str) -> str:
    return _line(words, "nominal", "equilibrium", "change")


def _line(name: str, nominal: str, balanced: str, change: str) -> str:
    return f"{name:34} {nominal:>16} {balanced:>16} {change:>16}"


def _clean(value: float) -> float:
    """Return zero for what is zero but for rounding."""
    return 0.0 if abs(value) < _SMALL else value
