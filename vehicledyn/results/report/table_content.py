"""What a page shows of the files of tables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from vehicledyn.results.plots.table_results import describe_table, table_figures
from vehicledyn.results.report.content import Content, ReportFigure, words
from vehicledyn.results.report.page import Block, Facts, Notes, Section, TextTable
from vehicledyn.results.report.parameter_content import (
    identification_parts,
    notes_section,
    optimum_parts,
    uncertainty_parts,
)
from vehicledyn.results.report.texts import number, reading
from vehicledyn.results.store.linear_file import format_of
from vehicledyn.results.tables import (
    cam_table,
    contact_table,
    equilibrium_table,
    handling_table,
    hunt_table,
    identification_table,
    manoeuvre_table,
    mode_table,
    optimum_table,
    response_table,
    sensitivity_table,
    track_table,
    tyre_table,
    uncertainty_table,
)
from vehicledyn.results.tables.response_table import ratio_unit

MOST_CASES = 12
LEADING = 3
_FACTS = ("holds", "title", "status", "modes", "notes", "settings")
_ROUNDING = 1e-9
"""Damping ratios up to this are rounding errors of zero."""


def table_content(path: Path) -> Content:
    """Return what a page shows of such a file."""
    facts = describe_table(path).facts
    kind = format_of(path)
    what, parts = _KINDS[kind]
    key_figures, sections = parts(path)
    state = _state(hunt_table.read_hunt(path)) if kind == hunt_table.FORMAT else ""
    rows = [
        (words(name), ", ".join(map(str, value)) if isinstance(value, list) else str(value))
        for name, value in facts.items()
        if name not in _FACTS and name not in {figure.name for figure in key_figures}
    ]
    return Content(
        path=path,
        what=what,
        title=str(facts["title"]),
        state=state,
        facts=[row for row in rows if row[1]],
        key_figures=key_figures,
        figures=lambda: table_figures(path),
        details=lambda: sections,
    )


Parts = tuple[Sequence[ReportFigure], Sequence[Section]]


def _state(table: hunt_table.HuntTable) -> str:
    return "" if table.status == "ok" else f"{table.status}: {table.message}"


def _no_parts(_: Path) -> Parts:
    return [], []


def _handling(path: Path) -> Parts:
    table = handling_table.read_handling(path)
    found = [
        ReportFigure(f.key, f.value, f.unit, f"{words(f.test)}: {f.description}")
        for f in table.figures
    ]
    return found, notes_section(table.notes)


def _cam(path: Path) -> Parts:
    table = cam_table.read_cam(path)
    found = [
        ReportFigure(name, value, unit, words(meaning))
        for name, (value, unit, meaning) in table.figures.items()
    ]
    return found, notes_section(table.notes)


def _equilibrium(table: equilibrium_table.EquilibriumTable) -> Parts:
    sections = [
        Section(
            title,
            [
                TextTable(
                    (title, "Unit", "Nominal", "Equilibrium"),
                    [
                        (item.name, item.unit, number(float(first)), number(float(last)))
                        for item, first, last in zip(quantities, *values, strict=True)
                    ],
                    (2, 3),
                )
            ],
        )
        for title, quantities, values in (
            ("Coordinates", table.coordinates, table.coordinate_values),
            ("Forces", table.forces, table.force_values),
            ("Other channels", table.channels, table.channel_values),
        )
        if quantities
    ]
    return [], sections


def _sensitivities(table: sensitivity_table.SensitivityTable) -> Parts:
    """Return the derivatives of each figure, those that matter most first."""
    sections = []
    for row, figure in enumerate(table.figures):
        lines = [
            (
                table.parameters[k].name,
                number(float(table.values_at(row)[k])),
                number(float(table.slopes[row][k])),
                table.unit(row, k),
            )
            for k in table.ranked(row)
            if table.slopes[row][k]
        ]
        heads = ("Parameter", "Value, SI", "Derivative", "Unit")
        blocks: list[Block] = [TextTable(heads, lines, (1, 2))]
        if np.isnan(table.slopes[row]).any():
            blocks.append(Notes(["Some derivatives do not exist here; a dash marks them."]))
        sections.append(Section(f"{figure.name} [{figure.unit}]", blocks))
    return [], [*sections, *notes_section(table.notes)]


def _modes(table: mode_table.ModeTable) -> Parts:
    figures = []
    for case in table.cases:
        moving = np.array([kind in ("aperiodic", "oscillation") for kind in case.kind], dtype=bool)
        if not moving.any():
            continue
        growth = float(case.eigenvalue.real[moving].max())
        label = f" at {case.label}" if case.label else ""
        figures.append(
            ReportFigure(
                f"growth{label}",
                growth,
                "1/s",
                f"Largest real part of an eigenvalue, free motions left out{label}",
            )
        )
    sections = [
        Section(
            f"Modes of case {k}{': ' + case.label if case.label else ''}",
            [_mode_table(table, case)],
        )
        for k, case in enumerate(table.cases[:MOST_CASES], 1)
    ]
    return figures[:MOST_CASES], sections


def _mode_table(table: mode_table.ModeTable, case: mode_table.ModeCase) -> TextTable:
    rows = []
    for k, value in enumerate(case.eigenvalue):
        oscillates = case.kind[k] == "oscillation"
        text = f"{value.real:.5g}" + (f" ± {abs(value.imag):.5g}i" if oscillates else "")
        frequency = number(float(case.frequency[k])) if oscillates else "–"
        damping = _damping(float(case.damping_ratio[k])) if oscillates else "–"
        leading = ", ".join(name for name, *_ in table.ranked(case, k)[:LEADING])
        rows.append((text, case.kind[k], frequency, damping, leading))
    head = ("Eigenvalue [1/s]", "Kind", "Frequency [Hz]", "Damping ratio", "Leading coordinates")
    return TextTable(head, rows, (2, 3))


def _damping(ratio: float) -> str:
    return "0" if abs(ratio) <= _ROUNDING else f"{ratio:.4g}"


def _responses(table: response_table.ResponseTable) -> Parts:
    rows, figures = [], []
    for i, given in enumerate(table.inputs):
        for k, output in enumerate(table.outputs):
            sizes, unit = table.magnitude[:, i, k], ratio_unit(output.unit, given.unit)
            known = np.isfinite(sizes)
            if not known.any():
                continue
            at = int(np.nanargmax(np.where(known, sizes, np.nan)))
            name = f"{output.name} by {given.name}"
            peak, place = float(sizes[at]), float(table.frequency[at])
            still = float(table.static_gain[i, k])
            text = number(still) if np.isfinite(still) else "does not settle"
            rows.append((name, unit, text, number(peak), number(place)))
            figures.append(
                ReportFigure(f"{name}, at", place, "Hz", f"Frequency of the peak, {name}")
            )
    head = ("Response", "Unit", "At rest", "Largest magnitude", "At [Hz]")
    return figures, [Section("Gains", [TextTable(head, rows, (2, 3, 4))])]


def _critical(table: hunt_table.HuntTable, name: str, meaning: str) -> ReportFigure:
    value, unit = table.figures[name], table.figure_unit(name)
    if name in table.means:
        meaning = f"{meaning}: {table.means[name]}"
    return ReportFigure(name, *((100.0 * value, "%") if unit == "1" else (value, unit)), meaning)


def _contacts(table: contact_table.ContactTable) -> Parts:
    figures = [
        ReportFigure(
            f"conicity at {1e3 * amplitude:.3g} mm",
            float(value),
            "",
            f"Equivalent conicity (EN 15302) at {1e3 * amplitude:.3g} mm",
        )
        for amplitude, value in zip(table.amplitude, table.conicity, strict=True)
    ]
    conicity = [
        (f"{1e3 * row[0]:.3g}", *map(number, map(float, row[1:])))
        for row in zip(
            table.amplitude,
            table.conicity,
            table.conicity_with_roll,
            table.conicity_harmonic,
            table.conicity_regression,
            strict=True,
        )
    ]
    head = ("Amplitude [mm]", "EN 15302", "With roll", "Harmonic", "Regression")
    blocks: list[Block] = [TextTable(head, conicity, (1, 2, 3, 4))]
    jumps = [
        (f"{1e3 * shift:.3f}", side, f"{1e3 * before:.2f}", f"{1e3 * after:.2f}")
        for shift, side, before, after in table.jumps
    ]
    jump_head = ("Shift [mm]", "Side", "From [mm]", "To [mm]")
    settings = [(words(name), _setting(table, name)) for name in table.settings]
    sections = [Section("Settings", [Facts(settings)]), Section("Equivalent conicity", blocks)]
    if jumps:
        sections.append(Section("Jumps of the contact", [TextTable(jump_head, jumps, (2, 3))]))
    return figures, [*sections, *notes_section(table.notes)]


def _setting(table: contact_table.ContactTable, name: str) -> str:
    """Return a setting of the contact with its unit."""
    value = table.settings[name]
    if name == "curvature":
        return reading(value, "1/m")
    if name == "inclination":
        return table.lean
    return reading(value, "rad") if name == "yaw" else f"{1e3 * value:.6g}\u00a0mm"


def _cycles(table: hunt_table.HuntTable) -> Parts:
    figures = [
        _critical(table, name, words(meaning))
        for name, meaning in hunt_table.FIGURE_MEANINGS.items()
        if name in table.figures
    ]
    watched = [f"{channel.name} [{channel.unit}]" for channel in table.channels]
    head = (
        f"{table.parameter.name} [{table.parameter.unit}]",
        "Branch",
        "Period [s]",
        "Stability",
        *(f"Amplitude of {name}" for name in watched),
    )
    rows = [
        (
            number(row.value),
            str(row.branch),
            number(row.period),
            " ".join(
                filter(None, ("stable" if row.stable else "unstable", row.kind.replace("_", " ")))
            ),
            *(number(float(size)) for size in row.amplitude),
        )
        for row in table.cycles
    ]
    numbers = (1, 2, *range(4, len(head)))
    caption = f"Limit cycles ({len(rows)})"
    sections = (
        [Section("Cycles", [TextTable(head, rows, numbers, caption, closed=True)])] if rows else []
    )
    if table.message:
        sections.append(Section("Messages", [Notes([table.message])]))
    return figures, sections


_KINDS: dict[str, tuple[str, Callable[[Path], Parts]]] = {
    mode_table.FORMAT: ("Eigenmodes", lambda path: _modes(mode_table.read_modes(path))),
    response_table.FORMAT: (
        "Responses",
        lambda path: _responses(response_table.read_response(path)),
    ),
    contact_table.FORMAT: ("Contact", lambda path: _contacts(contact_table.read_contacts(path))),
    equilibrium_table.FORMAT: (
        "Equilibrium",
        lambda path: _equilibrium(equilibrium_table.read_equilibrium(path)),
    ),
    optimum_table.FORMAT: ("Optimum", optimum_parts),
    manoeuvre_table.FORMAT: ("Optimal manoeuvre", _no_parts),
    identification_table.FORMAT: ("Identification", identification_parts),
    uncertainty_table.FORMAT: ("Uncertainty", uncertainty_parts),
    sensitivity_table.FORMAT: (
        "Sensitivities",
        lambda path: _sensitivities(sensitivity_table.read_sensitivity(path)),
    ),
    hunt_table.FORMAT: ("Limit cycles", lambda path: _cycles(hunt_table.read_hunt(path))),
    handling_table.FORMAT: ("Handling", _handling),
    cam_table.FORMAT: ("Cam", _cam),
    tyre_table.FORMAT: ("Tyres", _no_parts),
    track_table.FORMAT: ("Track", _no_parts),
}
"""Heading of the page, and what gives its key figures and sections, by format."""
