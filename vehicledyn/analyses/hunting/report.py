"""Results of a hunting study as text and as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vehicledyn.analyse.periodic.critical import growing_oscillations
from vehicledyn.base.units import shown
from vehicledyn.results.tables.hunt_table import FIGURE_MEANINGS, CycleRow, HuntTable

_MOST_ROWS = 24


@dataclass(frozen=True)
class HuntReport:
    """Critical values and limit cycles; ``messages`` say what was cut short."""

    table: HuntTable
    messages: tuple[str, ...] = ()

    @property
    def status(self) -> str:
        """How the study ended."""
        return self.table.status

    def as_text(self) -> str:
        """Return critical values and a table of the branches."""
        t = self.table
        span = ""
        if len(t.locus_values):
            first, last = (shown(float(t.locus_values[k]), t.parameter.unit) for k in (0, -1))
            span = f" from {first} to {last}"
        lines = [f"{t.model}: {t.parameter.name}{span}"]
        known = [
            (words, self._value(key)) for key, words in FIGURE_MEANINGS.items() if key in t.figures
        ]
        lines += [f"  {words:56} {value}" for words, value in known]
        if "linear_critical" not in t.figures and len(t.locus_values):
            lines.append(f"  {self._without_critical()}")
        for number in t.branches:
            lines += ["", *self._branch(number)]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data in SI units."""
        t = self.table
        return {
            "model": t.model,
            "status": t.status,
            "messages": list(self.messages),
            "parameter": vars(t.parameter),
            "channels": [vars(c) for c in t.channels],
            "figures": dict(t.figures),
            "means": dict(t.means),
            "origins": [{"branch": k, "origin": words} for k, words in t.origins.items()],
            "equilibria": [
                {"value": v, "real": e.real, "imaginary": e.imag}
                for v, e in zip(t.locus_values, t.eigenvalues, strict=True)
            ],
            "cycles": [self._cycle(row) for row in t.cycles],
            "simulated": [vars(row) for row in t.simulated],
        }

    def _without_critical(self) -> str:
        """Return what is known of the stability of equilibria without a critical value."""
        if all(growing_oscillations(row) for row in self.table.eigenvalues):
            return "oscillations grow at all values of this range"
        return "no oscillation begins to grow in this range"

    def _value(self, key: str) -> str:
        value, unit = self.table.figures[key], self.table.figure_unit(key)
        means = f" ({self.table.means[key]})" if key in self.table.means else ""
        return f"{100.0 * value:.3g} %" if unit == "1" else shown(value, unit) + means

    def _cycle(self, row: CycleRow) -> dict[str, Any]:
        return {
            "branch": row.branch,
            "value": row.value,
            "period": row.period,
            "stable": row.stable,
            "kind": row.kind,
            "trivial_multiplier": row.trivial,
            "multipliers": [complex(m) for m in row.multipliers],
            "smallest": row.smallest,
            "greatest": row.greatest,
            "amplitude": row.amplitude,
        }

    def _branch(self, number: int) -> list[str]:
        t = self.table
        rows = t.branch(number)
        worst = max(abs(row.trivial - 1.0) for row in rows)
        head = f"branch {number}: {len(rows)} limit cycles, trivial multiplier 1 within {worst:.1g}"
        head += f"; {t.origins[number]}" if number in t.origins else ""
        step = max(1, -(-len(rows) // _MOST_ROWS))
        chosen = [
            row for k, row in enumerate(rows) if row.kind or k % step == 0 or k == len(rows) - 1
        ]
        return [
            head,
            f"{t.parameter.name + ' [' + t.parameter.unit + ']':>18} {'period [s]':>12} "
            f"{'amplitude of ' + t.channels[0].name + ' [' + t.channels[0].unit + ']':>44}  "
            "stability",
            *(self._line(row) for row in chosen),
        ]

    def _line(self, row: CycleRow) -> str:
        kind = row.kind.replace("_", " ")
        words = "  ".join(filter(None, ("stable" if row.stable else "unstable", kind)))
        return f"{row.value:18.6g} {row.period:12.6g} {float(row.amplitude[0]):44.6g}  {words}"
