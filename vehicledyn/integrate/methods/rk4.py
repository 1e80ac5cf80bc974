"""Classical Runge-Kutta method of order four with a fixed step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.tolerances import fixed_step

if TYPE_CHECKING:
    from vehicledyn.integrate.task import Statistics, Task
    from vehicledyn.kernel.engine import Method


@register("solver", "rk4")
class RungeKutta4(ParameterSet):
    """Classical Runge-Kutta method, order 4, fixed step; the whole loop runs compiled.

    Hairer, Nørsett, Wanner (1993), Solving Ordinary Differential Equations I, section II.1.
    """

    step: float | None = fixed_step()

    @property
    def fixed_method(self) -> Method:
        """The method inside the kernel, with which many cases run side by side."""
        from vehicledyn.kernel.engine import Method

        return Method.RK4

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.fixed_step import run_fixed

        return run_fixed(task, "rk4", self.fixed_method, self.step)
