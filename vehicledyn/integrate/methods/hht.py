"""Implicit method of Hilber, Hughes and Taylor with a fixed step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.tolerances import (
    how_constraints_are_met,
    local_tolerance,
    required_step,
)
from vehicledyn.integrate.newmark.weights import Constraints

if TYPE_CHECKING:
    from vehicledyn.integrate.newmark.weights import Weights
    from vehicledyn.integrate.task import Statistics, Task
    from vehicledyn.symbolic.equations import Equations


@register("solver", "hht")
class HilberHughesTaylor(ParameterSet):
    """Implicit HHT method, order 2; damps oscillations that the step cannot resolve.

    The usual parameter alpha is (r - 1)/(r + 1), of r the spectral radius.

    Hilber, Hughes, Taylor (1977), Improved numerical dissipation for time integration algorithms
    in structural dynamics, Earthquake Engineering and Structural Dynamics 5, 283-292.
    """

    step: float = required_step()
    spectral_radius: float = quantity(
        "1", "Factor a step leaves of infinitely fast oscillations", default=0.8, ge=0.5, le=1
    )
    tolerance: float | None = local_tolerance()
    constraints: Constraints = how_constraints_are_met()

    def check(self, equations: Equations) -> None:
        """Raise InputError if ``constraints`` cannot hold what the equations have."""
        from vehicledyn.integrate.newmark.weights import refuse_constraints

        refuse_constraints(equations, self.constraints)

    @property
    def weights(self) -> Weights:
        """Weights of a step."""
        from vehicledyn.integrate.newmark.weights import Weights

        return Weights.hht(self.spectral_radius)

    @property
    def watched_method(self) -> int | None:
        """The method as the watch of the accuracy knows it; None where a tolerance is given."""
        from vehicledyn.integrate.newmark.watched_run import watched_method

        return watched_method(self.weights, self.constraints, self.tolerance)

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.newmark.watched_run import run_watched

        return run_watched(task, "hht", self, self.weights)
