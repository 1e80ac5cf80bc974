"""Chung and Hulbert's implicit generalised-alpha method."""

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


@register("solver", "generalised_alpha")
class GeneralisedAlpha(ParameterSet):
    """Implicit generalised-alpha method, order 2; damps what it cannot resolve.

    Of all methods of its family with this spectral radius it damps slow motion least.

    Chung, Hulbert (1993), A time integration algorithm for structural dynamics with improved
    numerical dissipation: the generalized-alpha method, Journal of Applied Mechanics 60, 371-375.
    """

    step: float = required_step()
    spectral_radius: float = quantity(
        "1", "Factor a step leaves of infinitely fast oscillations", default=0.8, ge=0, le=1
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

        return Weights.generalised_alpha(self.spectral_radius)

    @property
    def watched_method(self) -> int | None:
        """The method as the watch of the accuracy knows it; None where a tolerance is given."""
        from vehicledyn.integrate.newmark.watched_run import watched_method

        return watched_method(self.weights, self.constraints, self.tolerance)

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.newmark.watched_run import run_watched

        return run_watched(task, "generalised_alpha", self, self.weights)
