"""Newmark's implicit method, with a step of one size or controlled by the error."""

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


@register("solver", "newmark")
class Newmark(ParameterSet):
    """Newmark's implicit method; order 2 with gamma = 1/2, else order 1.

    With beta = 1/4 and gamma = 1/2 it is the trapezoidal rule: stable with any step where the
    model is linear, and without numerical damping.

    Newmark (1959), A method of computation for structural dynamics, Journal of the Engineering
    Mechanics Division 85, 67-94.
    """

    step: float = required_step()
    beta: float = quantity("1", "Weight of the new acceleration in positions", default=0.25, gt=0)
    gamma: float = quantity(
        "1", "Weight of the new acceleration in velocities", default=0.5, ge=0.5
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

        return Weights.newmark(self.beta, self.gamma)

    @property
    def watched_method(self) -> int | None:
        """The method as the watch of the accuracy knows it; None where a tolerance is given."""
        from vehicledyn.integrate.newmark.watched_run import watched_method

        return watched_method(self.weights, self.constraints, self.tolerance)

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.newmark.watched_run import run_watched

        return run_watched(task, "newmark", self, self.weights)
