"""Contact geometry as text and as plain data."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from vehicledyn.results.tables.contact_table import SIDES, ContactColumns, ContactTable

TOUCHING = 1e-6
"""Gap up to which a further contact is reported [m]."""

_HEADS = (
    "lateral shift y, positive to the left; contact on the wheels and on the rails, outwards",
    "       y    wheel    wheel      rail      rail    radius    radius   angle   angle  delta r"
    "      roll",
    "    [mm]     left    right      left     right      left     right    left   right     [mm]"
    "    [mrad]",
    "             [mm]     [mm]      [mm]      [mm]      [mm]      [mm]   [deg]   [deg]",
)


@dataclass(frozen=True)
class ContactReport:
    """Contact geometry as text and as plain data."""

    table: ContactTable

    def as_text(self) -> str:
        """Return contact points against shift, jumps and conicities."""
        table = self.table
        settings = table.settings
        lines = [
            f"{table.title}, rails inclined {table.lean}, back to back "
            f"{1e3 * settings['back_to_back']:g} mm, yaw {1e3 * settings['yaw']:g} mrad",
            *table.notes,
            "",
            *_HEADS,
            *(self._row(n) for n in range(len(table.shift))),
            *self._twins(),
            *(
                f"contact jumps at y = {1e3 * shift:.3f} mm, {side}: from {1e3 * before:.2f} "
                f"to {1e3 * after:.2f} mm"
                for shift, side, before, after in table.jumps
            ),
            "",
            "amplitude [mm]   tan gamma_e (EN 15302)   with roll   harmonic   regression",
            *(self._conicity(n) for n in range(len(table.amplitude))),
        ]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data in SI units."""
        table = self.table
        return {
            "wheel": table.wheel,
            "rail": table.rail,
            "settings": table.settings,
            "notes": list(table.notes),
            "shift": table.shift,
            "roll": table.roll,
            "height": table.height,
            "radius_difference": table.radius_difference,
            "contacts": {
                side: {
                    f.name: getattr(table.contacts, f.name)[:, k] for f in fields(ContactColumns)
                }
                for k, side in enumerate(SIDES)
            },
            "jumps": [
                {"shift": shift, "side": side, "from": before, "to": after}
                for shift, side, before, after in table.jumps
            ],
            "amplitude": table.amplitude,
            "conicity": table.conicity,
            "conicity_with_roll": table.conicity_with_roll,
            "conicity_harmonic": table.conicity_harmonic,
            "conicity_regression": table.conicity_regression,
        }

    def _row(self, n: int) -> str:
        table, points = self.table, self.table.contacts
        lengths = [
            1e3 * column[n, k, 0]
            for column in (points.place, points.rail_place, points.radius)
            for k in range(2)
        ]
        angles = np.degrees(points.angle[n, :, 0])
        return (
            f"{1e3 * table.shift[n]:8.3f} {lengths[0]:8.3f} {lengths[1]:8.3f} "
            + " ".join(f"{length:9.3f}" for length in lengths[2:])
            + f" {angles[0]:7.3f} {angles[1]:7.3f} {1e3 * table.radius_difference[n]:8.3f} "
            f"{1e3 * table.roll[n]:9.4f}"
        )

    def _twins(self) -> list[str]:
        """Return a line for each shift at which a wheel touches at several points."""
        points = self.table.contacts
        lines = []
        for n, shift in enumerate(self.table.shift):
            for k, side in enumerate(SIDES):
                touching = np.flatnonzero(points.gap[n, k] <= TOUCHING)
                if len(touching) > 1:
                    listed = ", ".join(f"{1e3 * points.place[n, k, m]:.2f}" for m in touching)
                    lines.append(
                        f"at y = {1e3 * shift:.3f} mm the {side} wheel touches at {listed} mm"
                    )
        return lines

    def _conicity(self, n: int) -> str:
        table = self.table
        return (
            f"{1e3 * table.amplitude[n]:14.2f} {_number(table.conicity[n]):>24} "
            f"{_number(table.conicity_with_roll[n]):>11} {_number(table.conicity_harmonic[n]):>10} "
            f"{_number(table.conicity_regression[n]):>12}"
        )


def _number(value: float) -> str:
    return f"{value:.4f}" if np.isfinite(value) else "-"
