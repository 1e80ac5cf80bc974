"""Runge-Kutta-Chebyshev method of order two with a fixed step, for mildly stiff models."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import Field

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.tolerances import fixed_step

if TYPE_CHECKING:
    from vehicledyn.integrate.task import Statistics, Task


@register("solver", "rkc")
class RungeKuttaChebyshev(ParameterSet):
    """Stabilised explicit method, order 2, fixed step; the whole loop runs compiled.

    With s stages a step h is stable where rates decay at up to 0.65 s²/h: creep forces of rail
    wheels and stiff dampers cost far fewer evaluations than with ``rk4``, and need no Jacobian.
    Fast oscillations must be damped or resolved.

    Sommeijer, Shampine, Verwer (1998), RKC: an explicit solver for parabolic PDEs, Journal of
    Computational and Applied Mathematics 88, 315-326.
    """

    step: float | None = fixed_step()
    stages: int = Field(description="Stages of a step", ge=2, le=50)

    @property
    def fixed_method(self) -> int:
        """The method inside the kernel, with which many cases run side by side."""
        from vehicledyn.kernel.engine import Method

        return Method.CHEBYSHEV + self.stages

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.fixed_step import run_fixed

        return run_fixed(task, "rkc", self.fixed_method, self.step)
