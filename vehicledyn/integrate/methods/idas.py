"""Variable-order backward differentiation on differential-algebraic equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.tolerances import absolute_tolerance, relative_tolerance

if TYPE_CHECKING:
    from vehicledyn.integrate.task import Statistics, Task

_CHUNK = 64


@register("solver", "idas")
class Idas(ParameterSet):
    """Backward differentiation of order 1 to 5, for stiff smooth systems with loops.

    Hindmarsh et al. (2005), ACM Trans. Math. Softw. 31(3), 363-396; through CasADi, with the
    loops as algebraic equations of index 1.
    """

    relative_tolerance: float = relative_tolerance()
    absolute_tolerance: float = absolute_tolerance()

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.casadi_integrators.adaptive_run import run_casadi

        options = {
            "reltol": self.relative_tolerance,
            "abstol": self.absolute_tolerance,
            "disable_internal_warnings": True,
        }
        return run_casadi(task, "idas", chunk=_CHUNK, options=options)
