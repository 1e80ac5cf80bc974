"""Figures of eigenmodes: a root locus over the cases, and bars of the mode shapes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.results.plots.figures import new_figure
from vehicledyn.results.plots.plot_style import BLUE, PALETTE, VERMILION, axis_label, plain
from vehicledyn.results.tables.mode_table import ModeCase, ModeTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

MODES_PER_FIGURE = 4
BARS = 8
NEAR_ZERO = 1e-4
"""Eigenvalues up to this belong to free motions, whose shapes are not drawn [1/s]."""

_HEADING, _PANEL, _LOCUS = 0.8, 1.75, 4.4  # inch
_ROUNDING = 1e-9
"""Part of the largest eigenvalue up to which real parts are rounding errors of zero [1]."""


def mode_figures(table: ModeTable) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure: the root locus, and the shapes of the first and last case."""
    yield "root_locus", _locus(table)
    ends = [0, len(table.cases) - 1] if len(table.cases) > 1 else [0]
    for number in ends:
        case = table.cases[number]
        modes = [int(k) for k in np.flatnonzero(np.abs(case.eigenvalue) > NEAR_ZERO)]
        for page, first in enumerate(range(0, len(modes), MODES_PER_FIGURE), 1):
            name = f"mode_shapes_case_{number + 1}_page_{page}"
            yield name, _shapes(table, case, modes[first : first + MODES_PER_FIGURE])


def _locus(table: ModeTable) -> Figure:
    from matplotlib import colormaps

    figure = new_figure(_LOCUS)
    axes = figure.subplots()
    many = len(table.cases) > len(PALETTE)
    shades = colormaps["viridis"](np.linspace(0.0, 0.9, len(table.cases)))
    for number, case in enumerate(table.cases):
        values = case.eigenvalue
        both = np.concatenate([values, values[values.imag > 0.0].conj()])
        colour = shades[number] if many else PALETTE[number]
        is_labelled = not many or number in (0, len(table.cases) - 1)
        label = case.label if is_labelled and case.label else None
        axes.plot(both.real, both.imag, "x", color=colour, label=label, markersize=5)
    axes.axvline(0.0, color="0.4", linewidth=0.8)
    _widen(axes, np.concatenate([case.eigenvalue for case in table.cases]))
    axes.set_xlabel(axis_label("Real part", "1/s"))
    axes.set_ylabel(axis_label("Imaginary part", "rad/s"))
    if any(case.label for case in table.cases):
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3)
    _entitle(figure, "Eigenvalues", table)
    return figure


def _widen(axes: Axes, values: NDArray[np.complex128]) -> None:
    """Keep the axis of real parts from showing rounding errors where nothing is damped."""
    largest = float(np.abs(values).max(initial=0.0))
    if largest > 0.0 and float(np.abs(values.real).max()) <= _ROUNDING * largest:
        axes.set_xlim(-0.1 * largest, 0.1 * largest)


def _shapes(table: ModeTable, case: ModeCase, modes: list[int]) -> Figure:
    figure = new_figure(_HEADING + _PANEL * len(modes))
    panels = figure.subplots(len(modes), 1, squeeze=False)[:, 0]
    for axes, mode in zip(panels, modes, strict=True):
        _bars(axes, table, case, mode)
    panels[-1].set_xlabel("Amplitude in SI units, the leading coordinate 1; phase in degrees")
    _entitle(figure, ", ".join(filter(None, ["Mode shapes", case.label])), table)
    return figure


def _bars(axes: Axes, table: ModeTable, case: ModeCase, mode: int) -> None:
    chosen = table.ranked(case, mode)[:BARS][::-1]
    shape = np.array([value for _, value, _ in chosen])
    sizes, phases = np.abs(shape), np.degrees(np.angle(shape))
    colours = [BLUE if abs(phase) <= 90.0 else VERMILION for phase in phases]
    axes.barh(range(len(chosen)), sizes, color=colours, height=0.7)
    axes.set_yticks(range(len(chosen)), [name for name, _, _ in chosen], fontsize=6.5)
    for row, (size, phase) in enumerate(zip(sizes, phases, strict=True)):
        axes.text(size, row, f" {round(phase) + 0}°", va="center", fontsize=6.5)
    axes.margins(x=0.12)
    axes.grid(visible=False, axis="y")
    axes.set_title(_mode_words(case, mode), fontsize=8.0, loc="left")


def _mode_words(case: ModeCase, mode: int) -> str:
    if case.kind[mode] == "oscillation":
        ratio = case.damping_ratio[mode]
        shown = 0.0 if abs(ratio) <= _ROUNDING else ratio
        return f"{case.frequency[mode]:.4g} Hz, damping ratio {shown:.3g}"
    return f"aperiodic, {case.eigenvalue[mode].real:.4g} 1/s"


def _entitle(figure: Figure, title: str, table: ModeTable) -> None:
    figure.suptitle(title, fontsize=10.5, fontweight="bold", x=0.01, ha="left")
    figure.supxlabel(plain(table.title), fontsize=6.5, color="0.45", x=0.99, ha="right")
