"""Tell of the samples of a run whether its first dependent coordinates serve to its end.

Most runs keep them. One that is followed with its derivatives need not be taken before, to find
where they change, as long as nothing in its samples asks for a closer look.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.repartitioning import steps_per_look
from vehicledyn.analyses.simulation.partitions.singularity_monitor import are_harmless
from vehicledyn.analyses.simulation.run_plan import looks_per_interval
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import Grid

Floats = NDArray[np.float64]


class Unsteady(Exception):  # noqa: N818
    """A sample asks for a closer look: the dependent coordinates may have to change."""


class SteadyPartition:
    """Looks at the samples of a run, in their order."""

    def __init__(self, kernel: Kernel) -> None:
        """Look at the loops of a kernel."""
        self._kernel = kernel
        self._before, self._scale = np.zeros(0), np.zeros(0)

    @staticmethod
    def sees(kernel: Kernel, grid: Grid) -> bool:
        """Return whether samples tell all that a run with fixed steps looks at."""
        e = kernel.equations
        step, steps = grid.interval / grid.per_interval, steps_per_look(e)
        between = looks_per_interval(step, grid.interval, steps=steps) > 1
        return not (between or e.structure.get("rate_dependent"))

    def take(self, times: Floats, states: Floats, unknowns: Floats) -> None:
        """Look at samples: times (n,), states (n, n_states) and unknowns (n, n_unknowns).

        Raises
        ------
        Unsteady
            If one asks for a closer look.
        """
        values = self._kernel.pivots(times, states, unknowns)
        if not self._before.size:
            self._before, self._scale = values[0], np.abs(values[0])
        if not are_harmless(values, self._before, self._scale).all():
            raise Unsteady
        self._before = values[-1]
        self._scale = np.maximum(self._scale, np.abs(values).max(axis=0))
