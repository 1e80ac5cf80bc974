"""Tables in exported functions: their numbers, and three functions that look them up.

``cell`` returns the number of the cell of a place, counted from zero in all languages, ``knot``
where it begins and ``entry`` the coefficient of a power of the distance from there. A place that
is no number has the last cell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.export.identifiers import safe_names
from vehicledyn.export.procedures import Procedure
from vehicledyn.symbolic.table_calls import tables_in
from vehicledyn.symbolic.tables import CurveTable


@dataclass(frozen=True)
class NamedTable:
    """A table and its identifier."""

    name: str
    table: CurveTable

    @property
    def comment(self) -> str:
        """What it is, in a line."""
        t = self.table
        return f"Table '{' '.join(t.name.split())}' from {t.start:g} to {t.stop:g}."

    @property
    def grid(self) -> dict[str, str]:
        """Numbers of the look-up by name."""
        t = self.table
        numbers = {"origin": t.origin, "step": t.step, "per_step": 1.0 / t.step}
        texts = {name: repr(float(number)) for name, number in numbers.items()}
        return {"name": self.name, "last": repr(len(t.cells) - 1.0), **texts}

    def rows(self) -> list[list[str]]:
        """Return the coefficients of each cell as literals."""
        return [[repr(float(number)) for number in row] for row in self.table.cells]


def named_tables(procedures: Sequence[Procedure]) -> tuple[NamedTable, ...]:
    """Return the tables that functions look up, with different identifiers."""
    expressions = [
        expression
        for procedure in procedures
        for expression in (
            *(label.expression for label in procedure.labels),
            *(value for target in procedure.targets for value in target.entries.values()),
        )
    ]
    tables = tables_in(expressions)
    names = safe_names([f"table_{table.name}" for table in tables])
    return tuple(NamedTable(*pair) for pair in zip(names, tables, strict=True))


_C = """\
static inline double {name}_cell(double x) {{
  return floor(fmax(fmin((x - ({origin})) * {per_step}, {last}), 0.0));
}}
static inline double {name}_knot(double cell) {{ return {origin} + {step} * cell; }}
static inline double {name}_entry(double cell, int power) {{
  return {name}_cells[(long)cell][power];
}}"""

_PYTHON = """\
def {name}_cell(x):
    return np.floor(np.fmax(np.fmin((x - ({origin})) * {per_step}, {last}), 0.0))


def {name}_knot(cell):
    return {origin} + {step} * cell


def {name}_entry(cell, power):
    return {name}_cells[int(cell), power]"""

_MATLAB = """\
function cell = {name}_cell(x)
  cell = floor(max(min((x - ({origin})) * {per_step}, {last}), 0.0));
end

function x = {name}_knot(cell)
  x = {origin} + {step} * cell;
end

function value = {name}_entry(cell, power)
  persistent cells
  if isempty(cells)
    cells = [
{rows}
    ];
  end
  value = cells(cell + 1, power + 1);
end"""


def c_table(named: NamedTable) -> list[str]:
    """Return the lines of a table in C."""
    rows = named.rows()
    return [
        f"// {named.comment}",
        f"static const double {named.name}_cells[][{len(rows[0])}] = {{",
        *(f"  {{{', '.join(row)}}}," for row in rows),
        "};",
        *_C.format(**named.grid).splitlines(),
    ]


def python_table(named: NamedTable) -> list[str]:
    """Return the lines of a table in Python."""
    return [
        f"# {named.comment}",
        f"{named.name}_cells = np.array(",
        "    [",
        *(f"        [{', '.join(row)}]," for row in named.rows()),
        "    ]",
        ")",
        "",
        "",
        *_PYTHON.format(**named.grid).splitlines(),
    ]


def matlab_table(named: NamedTable) -> list[str]:
    """Return the lines of a table in MATLAB."""
    rows = "\n".join(f"      {', '.join(row)}" for row in named.rows())
    return [f"% {named.comment}", *_MATLAB.format(**named.grid, rows=rows).splitlines()]
