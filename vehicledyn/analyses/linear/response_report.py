"""Frequency responses as text and as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.analyse.response_figures import KeyFigures
from vehicledyn.base.units import shown
from vehicledyn.results.tables.response_table import ResponseTable, ratio_unit

_ROWS = 13


@dataclass(frozen=True)
class ResponseReport:
    """Responses with their key figures by (input, output).

    ``at`` are frequencies asked for [Hz] with the response there; ``growing`` counts modes that
    grow; ``undamped`` are frequencies of undamped modes in the range [Hz].
    """

    table: ResponseTable
    figures: dict[tuple[int, int], KeyFigures]
    at: tuple[float, ...]
    response_at: Any
    growing: int
    undamped: tuple[float, ...]
    remark: str

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks and warnings."""
        return tuple(self.remark.splitlines())

    def as_text(self) -> str:
        """Return key figures and a few rows for each input and output."""
        return "\n".join([self._head(), *(line for pair in self._pairs() for line in pair)])

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data: SI units, frequencies in Hz, phases in degrees."""
        table = self.table
        magnitude, phase = table.magnitude, np.degrees(table.phase)
        pairs = []
        for (i, k), figures in self.figures.items():
            given, output = table.inputs[i], table.outputs[k]
            values = table.response[:, i, k]
            pairs.append(
                {
                    "input": given.name,
                    "output": output.name,
                    "unit": ratio_unit(output.unit, given.unit),
                    "static_gain": figures.static_gain,
                    "peak": figures.peak,
                    "peak_frequency": figures.peak_frequency,
                    "bandwidth": figures.bandwidth,
                    "real": values.real,
                    "imaginary": values.imag,
                    "magnitude": magnitude[:, i, k],
                    "phase_deg": phase[:, i, k],
                    "at": [self._at(row, i, k) for row in range(len(self.at))],
                }
            )
        return {
            "model": table.model,
            "speed": table.speed,
            "stable": self.growing == 0,
            "growing_modes": self.growing,
            "undamped_frequencies": list(self.undamped),
            "remark": self.remark,
            "inputs": [vars(item) for item in table.inputs],
            "outputs": [vars(item) for item in table.outputs],
            "frequency": table.frequency,
            "responses": pairs,
        }

    def _at(self, row: int, i: int, k: int) -> dict[str, float]:
        value = complex(self.response_at[row, i, k])
        return {
            "frequency": self.at[row],
            "magnitude": abs(value),
            "phase_deg": float(np.degrees(np.angle(value))),
        }

    def _head(self) -> str:
        table = self.table
        speed = f" at {shown(table.speed, 'm/s')}" if table.speed else ""
        count = f"{self.growing} mode(s) grow: no run settles to this response"
        lines = [f"{table.model}{speed}: response, {count if self.growing else 'stable'}"]
        if self.undamped:
            places = ", ".join(f"{f:.6g} Hz" for f in self.undamped)
            lines.append(f"undamped modes at {places}: the response may be unbounded there")
        return "\n".join([*lines, self.remark] if self.remark else lines)

    def _pairs(self) -> list[list[str]]:
        return [self._pair(i, k, figures) for (i, k), figures in self.figures.items()]

    def _pair(self, i: int, k: int, figures: KeyFigures) -> list[str]:
        table = self.table
        unit = ratio_unit(table.outputs[k].unit, table.inputs[i].unit)
        unit = "" if unit == "1" else f" {unit}"
        gain, peak, width = figures.static_gain, figures.peak, figures.bandwidth
        place = figures.peak_frequency
        nothing = "none within the range"
        static = "none, it does not settle" if gain is None else f"{gain:.6g}{unit}"
        largest = nothing if peak is None else f"{peak:.6g}{unit} at {place:.6g} Hz"
        return [
            "",
            f"{table.outputs[k].name} by {table.inputs[i].name}",
            f"  static gain  {static}",
            f"  peak         {largest}",
            f"  bandwidth    {nothing if width is None else f'{width:.6g} Hz (-3 dB)'}",
            "",
            f"{'frequency':>14} {'magnitude':>{16 + len(unit)}} {'phase':>14}",
            *self._rows(i, k, unit),
        ]

    def _rows(self, i: int, k: int, unit: str) -> list[str]:
        if self.at:
            rows = [self._at(row, i, k) for row in range(len(self.at))]
            triples = [(r["frequency"], r["magnitude"], r["phase_deg"]) for r in rows]
        else:
            table = self.table
            size, phase = table.magnitude[:, i, k], np.degrees(table.phase[:, i, k])
            chosen = np.unique(np.linspace(0, len(size) - 1, _ROWS).round().astype(int))
            triples = [(table.frequency[n], size[n], phase[n]) for n in chosen]
        return [f"{f:>11.5g} Hz {m:>16.6g}{unit} {p:>10.2f} deg" for f, m, p in triples]
