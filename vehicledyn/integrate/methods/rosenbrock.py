"""Rosenbrock-Wanner method with adaptive steps, for stiff systems with loops."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.tolerances import absolute_tolerance, relative_tolerance

if TYPE_CHECKING:
    from vehicledyn.integrate.task import Statistics, Task

_CHUNK = 8


@register("solver", "rosenbrock")
class Rosenbrock(ParameterSet):
    """Linearly implicit Rosenbrock method of order 5(4), for stiff systems with loops.

    Hairer, Wanner (1996), Solving Ordinary Differential Equations II, section IV.7; CasADi's
    implementation, with the loops as algebraic equations of index 1.
    """

    relative_tolerance: float = relative_tolerance()
    absolute_tolerance: float = absolute_tolerance()

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.casadi_integrators.adaptive_run import run_casadi

        options = {"reltol": self.relative_tolerance, "abstol": self.absolute_tolerance}
        return run_casadi(task, "rosenbrock", chunk=_CHUNK, options=options)
