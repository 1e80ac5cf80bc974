"""Tell of the samples of a run whether its first dependent coordinates serve to its end.

Most runs keep them. One that is followed with its derivatives need not be taken before, to find
where they change, as long as nothing in its samples asks for a closer look.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.expected_pivots import LastLook, are_harmless
from vehicledyn.analyses.simulation.partitions.repartitioning import steps_per_look
from vehicledyn.analyses.simulation.run_plan import looks_per_interval
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import StepRow

Floats = NDArray[np.float64]


class Unsteady(Exception):  # noqa: N818
    """A sample asks for a closer look: the dependent coordinates may have to change."""


class SteadyPartition:
    """Looks at the samples of a run, in their order."""

    def __init__(self, kernel: Kernel) -> None:
        """Look at the loops of a kernel."""
        self._kernel = kernel
        self._last: LastLook | None = None

    @staticmethod
    def sees(kernel: Kernel, grid: StepRow) -> bool:
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
        if self._last is None:
            first = (values[1] - values[0]) / (times[1] - times[0]) if len(times) > 1 else 0.0
            rates = np.zeros_like(values[0]) + first
            self._last = LastLook(float(times[0]), values[0], rates, np.abs(values[0]))
            times, values = times[1:], values[1:]
        if not len(times):
            return
        if not are_harmless(times, values, self._last).all():
            raise Unsteady
        self._last = self._last.then(times, values)
