"""Bogacki and Shampine's explicit pair of order three with adaptive steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.tolerances import absolute_tolerance, relative_tolerance

if TYPE_CHECKING:
    from vehicledyn.integrate.task import Statistics, Task


@register("solver", "rk23")
class BogackiShampine23(ParameterSet):
    """Explicit pair of order 3(2) with adaptive steps, for low accuracy and rates with corners.

    Bogacki, Shampine (1989), A 3(2) pair of Runge-Kutta formulas, Applied Mathematics Letters
    2(4), 321-325; SciPy's implementation, sampled on its dense output of order 3.
    """

    relative_tolerance: float = relative_tolerance()
    absolute_tolerance: float = absolute_tolerance()

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.explicit_pairs.adaptive_run import run_explicit

        return run_explicit(
            task,
            "rk23",
            "RK23",
            relative_tolerance=self.relative_tolerance,
            absolute_tolerance=self.absolute_tolerance,
        )
