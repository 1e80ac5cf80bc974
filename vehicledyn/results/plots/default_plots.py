"""Plots of all channels of a file that describes none: one figure a unit, one panel a quantity."""

from __future__ import annotations

import re

from vehicledyn.results.plots.plot_description import Panel, Plot, TimePlot
from vehicledyn.results.store.reader import Result

LINES_PER_PANEL = 7
PANELS_PER_FIGURE = 4


def default_plots(result: Result) -> tuple[Plot, ...]:
    """Return time plots of all channels, grouped by unit and by the last word of their names.

    The wheel loads of all wheels, ``wheel_*.tyre.normal_force``, share a panel so.
    """
    quantities: dict[tuple[str, str], list[str]] = {}
    for name in result.channels:
        key = (result.facts(name)[0], name.rsplit(".", 1)[-1])
        quantities.setdefault(key, []).append(name)
    by_unit: dict[str, list[Panel]] = {}
    for (unit, word), names in quantities.items():
        for start in range(0, len(names), LINES_PER_PANEL):
            lines = tuple(names[start : start + LINES_PER_PANEL])
            panel = Panel(word.replace("_", " ").capitalize(), unit, lines, lines)
            by_unit.setdefault(unit, []).append(panel)
    return tuple(plot for unit, panels in by_unit.items() for plot in _figures(unit, panels))


def _figures(unit: str, panels: list[Panel]) -> list[Plot]:
    count = -(-len(panels) // PANELS_PER_FIGURE)
    word = re.sub(r"[^A-Za-z0-9]+", "_", unit.replace("/", " per ").replace("^", "")).strip("_")
    plots: list[Plot] = []
    for index in range(count):
        part = f" ({index + 1} of {count})" if count > 1 else ""
        chosen = panels[index * PANELS_PER_FIGURE : (index + 1) * PANELS_PER_FIGURE]
        name = f"channels_{word or 'none'}" + (f"_part_{index + 1}" if count > 1 else "")
        plots.append(TimePlot(name, f"Channels in {unit}{part}", tuple(chosen)))
    return plots
