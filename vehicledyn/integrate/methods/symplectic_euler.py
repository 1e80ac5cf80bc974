"""Semi-implicit Euler method with a fixed step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.tolerances import fixed_step

if TYPE_CHECKING:
    from vehicledyn.integrate.task import Statistics, Task
    from vehicledyn.kernel.engine import Method


@register("solver", "symplectic_euler")
class SymplecticEuler(ParameterSet):
    """Semi-implicit Euler method, order 1, fixed step: positions move with new velocities.

    Hairer, Lubich, Wanner (2006), Geometric Numerical Integration, section I.1.2.
    """

    step: float | None = fixed_step()

    @property
    def fixed_method(self) -> Method:
        """The method inside the kernel, with which many cases run side by side."""
        from vehicledyn.kernel.engine import Method

        return Method.SYMPLECTIC_EULER

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.fixed_step import run_fixed

        return run_fixed(task, "symplectic_euler", self.fixed_method, self.step)
