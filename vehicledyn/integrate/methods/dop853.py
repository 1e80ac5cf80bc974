"""Dormand and Prince's explicit pair of order eight with adaptive steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.tolerances import absolute_tolerance, relative_tolerance

if TYPE_CHECKING:
    from vehicledyn.integrate.task import Statistics, Task


@register("solver", "dop853")
class DormandPrince853(ParameterSet):
    """Explicit pair of order 8(5,3) with adaptive steps, for accurate smooth motion.

    Hairer, Nørsett, Wanner (1993), Solving Ordinary Differential Equations I, section II.10;
    sampled on its dense output of order 7.
    """

    relative_tolerance: float = relative_tolerance()
    absolute_tolerance: float = absolute_tolerance()

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.explicit_pairs.adaptive_run import run_explicit

        return run_explicit(
            task,
            "dop853",
            "DOP853",
            relative_tolerance=self.relative_tolerance,
            absolute_tolerance=self.absolute_tolerance,
        )
