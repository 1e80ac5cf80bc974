"""Arrange lines in panels so that each can be read: few lines, of ranges that suit each other."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.plots.plot_description import Panel, TimePlot
from vehicledyn.results.store.reader import Result

MOST_LINES = 6
MOST_PANELS = 8
FLATTEST = 0.06
"""Smallest share of a panel's height that a line which moves may take."""
_ROUNDING = 1e-9


@dataclass
class _Range:
    """Lines of one panel and the values they reach; ``least`` is the smallest extent."""

    channels: list[str] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)
    low: float = np.inf
    high: float = -np.inf
    least: float = np.inf

    def takes(self, low: float, high: float) -> bool:
        """Return whether a line between two values fits."""
        if not self.channels:
            return True
        extent = max(self.high, high) - min(self.low, low)
        moving = [e for e in (self.least, high - low) if np.isfinite(e) and e > _small(low, high)]
        return len(self.channels) < MOST_LINES and (not moving or min(moving) >= FLATTEST * extent)

    def add(self, channel: str, label: str, low: float, high: float) -> None:
        """Take a line."""
        self.channels.append(channel)
        self.labels.append(label)
        self.low, self.high = min(self.low, low), max(self.high, high)
        if high - low > _small(low, high):
            self.least = min(self.least, high - low)


def arranged(result: Result, plot: TimePlot, rows: NDArray[np.intp] | None = None) -> TimePlot:
    """Return a plot with the lines of each panel put into panels of like range.

    A panel keeps at most six lines, none flatter than a sixteenth of its height unless it is
    constant. Of more than eight panels the first are kept, and the title says so. The ranges are
    those of the samples shown, or of some rising ``rows`` of the file.
    """
    panels = [part for panel in plot.panels for part in _split(result, panel, rows)]
    shown = tuple(panels[:MOST_PANELS])
    title = plot.title
    if len(panels) > MOST_PANELS:
        kept, total = (sum(len(p.channels) for p in group) for group in (shown, panels))
        title = f"{plot.title} (the first {kept} of {total})"
    return replace(plot, title=title, panels=shown)


def _split(result: Result, panel: Panel, rows: NDArray[np.intp] | None) -> list[Panel]:
    ranges: list[_Range] = []
    for channel, label in zip(panel.channels, panel.labels, strict=True):
        values = result.channel(channel, rows).values
        finite = values[np.isfinite(values)]
        low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
        home = next((r for r in ranges if r.takes(low, high)), None)
        if home is None:
            home = _Range()
            ranges.append(home)
        home.add(channel, label, low, high)
    return [Panel(panel.label, panel.unit, tuple(r.channels), tuple(r.labels)) for r in ranges]


def _small(low: float, high: float) -> float:
    """Return the extent below which a line counts as constant."""
    return _ROUNDING * max(1.0, abs(low), abs(high))
