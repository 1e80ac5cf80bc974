"""What pages show of searched, identified and scattering parameters."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.units import digits_of
from vehicledyn.results.report.content import ReportFigure
from vehicledyn.results.report.page import Notes, Section, TextTable
from vehicledyn.results.report.texts import number
from vehicledyn.results.tables.identification_table import (
    IdentificationTable,
    read_identification,
)
from vehicledyn.results.tables.optimum_table import OptimumTable, read_optimum
from vehicledyn.results.tables.response_table import ratio_unit
from vehicledyn.results.tables.uncertainty_table import UncertaintyTable, read_uncertainty

Parts = tuple[Sequence[ReportFigure], Sequence[Section]]

_NEAR = 1e-6
"""Part of its range within which a variable lies at its bound."""

_LARGE = 0.9
"""Size of a correlation of parameters that is worth a reader's attention."""


def notes_section(notes: Sequence[str]) -> list[Section]:
    """Return remarks as a section, none if there are none."""
    return [Section("Notes", [Notes(list(notes))])] if notes else []


def optimum_parts(path: Path) -> Parts:
    """Return variables, figures, limits, derivatives and compromises of an optimum."""
    table = read_optimum(path)
    sections = [
        Section("Variables", [_variables(table)]),
        Section("Figures of merit", [_merits(table)]),
    ]
    if table.limits:
        sections.append(Section("Constraints", [Notes(table.limits)]))
    sections.append(Section("Derivatives at the optimum", [_slopes(table)]))
    if table.front_figure is not None:
        sections.append(Section("Compromises", [_front(table)]))
    return [], [*sections, *notes_section(table.notes)]


def _variables(table: OptimumTable) -> TextTable:
    rows = []
    for k, item in enumerate(table.variables):
        numbers = [float(v[k]) for v in (table.low, table.high, table.start, table.best)]
        low, high, _, best = numbers
        is_bound = min(best - low, high - best) <= _NEAR * (high - low)
        rows.append(
            (item.name, item.unit, *map(number, numbers), "at its bound" if is_bound else "")
        )
    return TextTable(("Variable", "Unit", "From", "To", "Start", "Optimum", ""), rows, (2, 3, 4, 5))


def _merits(table: OptimumTable) -> TextTable:
    rows = [
        (item.name, item.unit, number(float(first)), number(float(last)))
        for item, first, last in zip(table.figures, *table.figure_values, strict=True)
    ]
    return TextTable(("Figure", "Unit", "Start", "Optimum"), rows, (2, 3))


def _slopes(table: OptimumTable) -> TextTable:
    rows = []
    for figure, slopes in zip(table.figures, table.figure_slopes, strict=True):
        for item, slope, value in zip(table.variables, slopes, table.best, strict=True):
            unit = ratio_unit(figure.unit, item.unit)
            change = 0.01 * float(slope) * float(value)
            row = (figure.name, item.name, number(float(slope)), unit)
            rows.append((*row, f"{number(change)} {figure.unit}".removesuffix(" 1")))
    head = ("Figure", "By", "Derivative", "Unit", "Change by 1 % of the variable")
    return TextTable(head, rows, (2, 4))


def _front(table: OptimumTable) -> TextTable:
    figure = table.front_figure
    assert figure is not None  # asked for where there is one
    names = [f"{item.name} [{item.unit}]" for item in table.variables]
    rows = [
        (
            number(item.objective),
            number(item.figure),
            *(number(float(v)) for v in item.variables),
            number(item.optimality),
            str(item.n_runs),
            "" if item.is_kept else "constraints not kept",
        )
        for item in table.front
    ]
    head = ("Objective", f"{figure.name} [{figure.unit}]", *names, "Optimality", "Runs", "")
    return TextTable(head, rows, range(len(head) - 1))


def identification_parts(path: Path) -> Parts:
    """Return identified parameters with intervals, their correlations and what is to be known."""
    table = read_identification(path)
    figures = [
        ReportFigure(
            "residuals",
            float(np.sqrt(table.variance)),
            "1",
            "Residuals, in deviations of the noise given",
        ),
        ReportFigure(
            "whiteness",
            table.whiteness,
            "1",
            "Largest autocorrelation of the residuals, in its error if they are white",
        ),
    ]
    rows = []
    for k, item in enumerate(table.parameters):
        values = [float(v[k]) for v in (table.start, table.value, table.low, table.high)]
        digits = digits_of(values[1], values[3] - values[2])
        rows.append((item.name, item.unit, *(number(v, digits) for v in values)))
    head = ("Parameter", "Unit", "Start", "Identified", "95 % from", "to")
    sections = [Section("Parameters", [TextTable(head, rows, (2, 3, 4, 5))])]
    if len(table.parameters) > 1:
        sections.append(Section("Correlations", [_correlations(table)]))
    return figures, [*sections, *notes_section(table.notes)]


def _correlations(table: IdentificationTable) -> TextTable:
    sizes = np.sqrt(np.diag(table.covariance))
    with np.errstate(invalid="ignore", divide="ignore"):
        found = np.asarray(table.covariance) / np.outer(sizes, sizes)
    names = [item.name for item in table.parameters]
    rows = [
        (name, *(_correlation(value, is_own=k == own) for own, value in enumerate(row)))
        for k, (name, row) in enumerate(zip(names, found, strict=True))
    ]
    return TextTable(("", *names), rows, range(1, len(names) + 1))


def _correlation(value: float, *, is_own: bool) -> str:
    if is_own or not np.isfinite(value):
        return "1" if is_own else "–"
    return f"{value:+.2f}" + (" !" if abs(value) >= _LARGE else "")


def uncertainty_parts(path: Path) -> Parts:
    """Return mean and deviation of figures, shares of parameters and risks."""
    table = read_uncertainty(path)
    rows = [
        (item.name, item.unit, *(number(float(v[k])) for v in _spreads(table)))
        for k, item in enumerate(table.figures)
    ]
    head = ("Figure", "Unit", "Mean", "its error", "Deviation", "its error")
    sections = [Section("Spread", [TextTable(head, rows, (2, 3, 4, 5))])]
    if table.risks:
        sections.append(Section("Risks", [Notes(table.risks)]))
    shares = [
        (
            figure.name,
            table.parameters[k].name,
            *(_share(value[k]) for value in (alone, alone_error, total, total_error)),
        )
        for figure, alone, alone_error, total, total_error in zip(
            table.figures,
            table.shares,
            _given(table.shares_error, table.shares),
            table.totals,
            _given(table.totals_error, table.shares),
            strict=True,
        )
        if np.isfinite(alone).any()
        for k in np.argsort(-alone)
    ]
    if shares:
        heads = (
            *("Figure", "Parameter", "Part of the variance", "its error"),
            *("With interactions", "its error"),
        )
        sections.append(Section("Shares of the variance", [TextTable(heads, shares, (2, 3, 4, 5))]))
    return [], [*sections, *notes_section(table.notes)]


def _spreads(table: UncertaintyTable) -> tuple[Sequence[float], ...]:
    return table.mean, table.mean_error, table.deviation, table.deviation_error


def _given(values: Any, like: Any) -> Any:
    """Return values, or gaps of the shape of others where there are none."""
    return np.full(np.shape(like), np.nan) if values is None else values


def _share(value: float) -> str:
    return f"{100.0 * value:.1f} %" if np.isfinite(value) else "–"
