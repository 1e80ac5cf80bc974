"""Ground of any kind as tandem cams envelop it: their lift, on lines along the road."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.road.ground.enveloping import Array, Tandem
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.grids.grid_table import GridTable
from vehicledyn.symbolic.grids.run_time_numbers import RunTimeNumbers

MOST_NODES = 2_000_000
"""Most places at which the lift of the cams is kept."""


@dataclass(frozen=True)
class EnvelopedGround:
    """Effective height and slope over places u along and v across the road [m].

    Two cams feel the mean of their lifts and the slope between them.
    """

    lift: GridTable
    spacing: float

    def height(self, u: Any, v: Any) -> Any:
        """Return the effective height [m]."""
        if self.spacing == 0.0:
            return self.lift.value(u, v)
        return 0.5 * sum(self.lift.value(place, v) for place in self._cams(u, self._apart(u)))

    def slopes(self, u: Any, v: Any) -> tuple[Any, Any]:
        """Return the effective slopes along u and v [1]."""
        if self.spacing == 0.0:
            return self.lift.slopes(u, v)
        spacing = self._apart(u)
        behind, ahead = self._cams(u, spacing)
        rise = self.lift.value(ahead, v) - self.lift.value(behind, v)
        across = self.lift.slopes(ahead, v)[1] + self.lift.slopes(behind, v)[1]
        return rise / spacing, 0.5 * across

    @cached_property
    def _spacing(self) -> RunTimeNumbers:
        return RunTimeNumbers("felt road: spacing of the cams", [self.spacing])

    def _apart(self, u: Any) -> Any:
        """Return the spacing, which compiled code looks up."""
        return self._spacing.at(u)[0]

    def _cams(self, u: Any, spacing: Any) -> tuple[Any, Any]:
        return u - 0.5 * spacing, u + 0.5 * spacing


def enveloped_ground(
    height: Callable[[Any, Any], Any],
    tandem: Tandem,
    along: tuple[float, float],
    across: Array,
    step: float,
    *,
    anchor: float = 0.0,
) -> EnvelopedGround:
    """Return what cams feel of a ground.

    Parameters
    ----------
    height
        Height at a place u, v of symbols [m].
    tandem
        The cams, which roll along u.
    along
        First and last u where they are wanted [m].
    across
        Places v of the lines, growing, at least two [m].
    step
        Distance of the samples along u, between which the ground is straight [m].
    anchor
        A place u at which a sample lies [m]; corners of the ground that lie at samples are exact.

    Raises
    ------
    InputError
        If there are more than ``MOST_NODES`` places.
    """
    start, cells = samples(tandem, along, len(across), step, anchor=anchor)
    reach = tandem.cam.steps_to_end(step)
    places = anchor + step * np.arange(start - reach, start + cells + reach + 1)
    u, v = ops.symbol("u"), ops.symbol("v")
    number = ops.numeric([u, v], ops.column([height(u, v)]))
    lines = [number(places[None, :], np.full((1, len(places)), at))[0] for at in across]
    lift = tandem.cam.even_lift(np.stack(lines, axis=1), step)
    table = GridTable("felt road", anchor + step * start, step, across, lift)
    return EnvelopedGround(table, tandem.spacing)


def samples(
    tandem: Tandem, along: tuple[float, float], lines: int, step: float, *, anchor: float = 0.0
) -> tuple[int, int]:
    """Return the first place along, counted in steps from the anchor, and how many cells follow.

    Raises
    ------
    InputError
        If there are more than ``MOST_NODES`` places on all lines.
    """
    half = 0.5 * tandem.spacing
    start = int(np.floor((along[0] - half - anchor) / step + 1e-9))
    cells = int(np.ceil((along[1] + half - anchor) / step - 1e-9)) - start
    if (cells + 1) * lines > MOST_NODES:
        raise InputError(
            f"the cams are wanted at {cells + 1} places along {lines} lines, more than "
            f"{MOST_NODES:,} in all; give a larger step, or a smaller part of the road by first, "
            "last, right and left"
        )
    return start, cells
