"""Results of a test on the suspension rig: table, plain data and figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.symbolic.equations import Channel

Array = NDArray[np.float64]

_DEGREES = 180.0 / np.pi
SHOWN = {
    "m": ("mm", 1e3),
    "rad": ("deg", _DEGREES),
    "rad/m": ("deg/m", _DEGREES),
    "rad/N": ("deg/kN", _DEGREES * 1e3),
    "m/N": ("mm/kN", 1e6),
    "rad/(N*m)": ("deg/(kN*m)", _DEGREES * 1e3),
    "N/m": ("N/mm", 1e-3),
    "N*m/rad": ("N*m/deg", 1.0 / _DEGREES),
    "1": ("", 1.0),
}
"""Units that people read instead of SI, with factors."""
_FIGURE_UNITS = {"m": "mm", "rad": "deg"}
_PANELS = 4
_FLAT = 1e-12


@dataclass(frozen=True)
class RigReport:
    """Results of a test: rows of the control and all quantities, in SI.

    ``middle`` is the row nearest to the design position, which the table shows.
    """

    model: str
    test: str
    path: Path
    status: str
    channels: tuple[Channel, ...]
    table: Array
    middle: int
    failure: str = ""
    notes: tuple[str, ...] = ()

    @property
    def messages(self) -> list[str]:
        """Return what a person must know beside the table."""
        partial = f"{self.failure}; the partial result is kept in {self.path}"
        return [*self.notes, *([partial] if self.failure else [])]

    def as_text(self) -> str:
        """Return the quantities at the middle and their ranges over the test."""
        control, row = self.channels[0], self.table[self.middle]
        at = _text(row[0], control.unit)
        lines = [
            f"{self.path}: {self.status}, {len(self.table)} places of the test '{self.test}'",
            "",
            f"{'quantity':44} {f'at {at}':>18} {'least':>14} {'most':>14}  unit",
        ]
        for k, channel in enumerate(self.channels[1:], 1):
            unit, factor = SHOWN.get(channel.unit, (channel.unit, 1.0))
            column = self.table[:, k] * factor
            cells = (row[k] * factor, np.nanmin(column), np.nanmax(column))
            numbers = (_clean(float(cell)) for cell in cells)
            first, *others = (f"{number:.6g}" for number in numbers)
            lines.append(
                f"{channel.name:44} {first:>18} {others[0]:>14} {others[1]:>14}  {unit}".rstrip()
            )
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data, in SI."""
        return {
            "model": self.model,
            "test": self.test,
            "result": self.path,
            "status": self.status,
            "failure": self.failure,
            "notes": list(self.notes),
            "channels": {
                c.name: {"unit": c.unit, "description": c.description, "values": self.table[:, k]}
                for k, c in enumerate(self.channels)
            },
        }


def figures(
    channels: Sequence[Channel], table: Array, corners: Sequence[str]
) -> list[dict[str, Any]]:
    """Return figures of the quantities over the control, both wheels in one panel."""
    control = channels[0]
    columns = {c.name: table[:, k] for k, c in enumerate(channels)}
    panels = []
    for name, channel in _of_wheels(channels, corners).items():
        names = [f"{corner}.{name}" for corner in corners if f"{corner}.{name}" in columns]
        if any(np.isfinite(columns[n]).all() and np.ptp(columns[n]) > _FLAT for n in names):
            unit = _FIGURE_UNITS.get(channel.unit, channel.unit)
            label = name.replace("_", " ").capitalize()
            panels.append({"label": label, "unit": unit, "channels": names})
    unit = _FIGURE_UNITS.get(control.unit, control.unit)
    return [
        {
            "name": f"rig_{number // _PANELS + 1}",
            "kind": "time",
            "title": f"Quantities of the wheels over {control.name.replace('_', ' ')}",
            "x": control.name,
            "x_unit": unit,
            "panels": panels[number : number + _PANELS],
        }
        for number in range(0, len(panels), _PANELS)
    ]


def _of_wheels(channels: Sequence[Channel], corners: Sequence[str]) -> dict[str, Channel]:
    """Return the quantities that wheels have by their last names."""
    found: dict[str, Channel] = {}
    for channel in channels[1:]:
        for corner in corners:
            if channel.name.startswith(f"{corner}."):
                found.setdefault(channel.name.removeprefix(f"{corner}."), channel)
    return found


def _text(value: float, unit: str) -> str:
    shown, factor = SHOWN.get(unit, (unit, 1.0))
    return f"{value * factor:.4g} {shown}".rstrip()


def _clean(value: float) -> float:
    return 0.0 if abs(value) < 5e-10 else value


def corner_notes(channels: Sequence[Channel], values: Array, sides: Array) -> tuple[str, ...]:
    """Return a line for each place at which quantities jump, as where a stop begins to touch.

    Parameters
    ----------
    channels
        The control, then all quantities.
    values
        Of the control, shape (n_places,).
    sides
        Quantities below and above the places, shape (n_places, 2, n), not a number where they do
        not jump.
    """
    notes, control = [], channels[0]
    for value, (below, above) in zip(values, sides, strict=True):
        jumping = np.flatnonzero(np.isfinite(below))
        if not jumping.size:
            continue
        first = channels[1 + jumping[0]]
        unit, factor = SHOWN.get(first.unit, (first.unit, 1.0))
        both = " and ".join(f"{_clean(float(s[jumping[0]] * factor)):.6g}" for s in (below, above))
        more = jumping.size - 1
        which = f" and {more} more jump there, it" if more else " jumps there"
        notes.append(
            f"warning: at {control.name} = {_text(value, control.unit)} a law has a corner, such "
            f"as a stop that begins to touch: '{first.name}'{which} between {both} {unit}".rstrip()
            + "; what is shown lies between both sides"
        )
    return tuple(notes)
