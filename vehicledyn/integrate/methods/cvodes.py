"""Variable-order backward differentiation on ordinary differential equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.tolerances import absolute_tolerance, relative_tolerance

if TYPE_CHECKING:
    from vehicledyn.integrate.task import Statistics, Task
    from vehicledyn.symbolic.equations import Equations

_CHUNK = 64


@register("solver", "cvodes")
class Cvodes(ParameterSet):
    """Backward differentiation of order 1 to 5, for stiff smooth systems without loops.

    Hindmarsh et al. (2005), ACM Trans. Math. Softw. 31(3), 363-396; through CasADi.
    """

    relative_tolerance: float = relative_tolerance()
    absolute_tolerance: float = absolute_tolerance()

    def check(self, equations: Equations) -> None:
        """Raise InputError if the model has algebraic unknowns, which this method cannot treat."""
        if equations.unknowns:
            raise InputError(
                f"solver 'cvodes' cannot treat the loops of model '{equations.name}'; "
                "take 'rosenbrock' or 'idas'"
            )

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task.

        Raises
        ------
        InputError
            If the model has algebraic unknowns.
        """
        from vehicledyn.integrate.casadi_integrators.adaptive_run import run_casadi

        self.check(task.kernel.equations)
        options = {
            "reltol": self.relative_tolerance,
            "abstol": self.absolute_tolerance,
            "disable_internal_warnings": True,
        }
        return run_casadi(task, "cvodes", chunk=_CHUNK, options=options)
