"""What the implicit methods of Newmark's family have in common."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.integrate.methods.tolerances import (
    how_constraints_are_met,
    local_tolerance,
    required_step,
    shown_velocities,
)
from vehicledyn.integrate.newmark.weights import Constraints, Velocities

if TYPE_CHECKING:
    from vehicledyn.integrate.newmark.weights import Weights
    from vehicledyn.integrate.task import Statistics, Task
    from vehicledyn.symbolic.equations import Equations


class ImplicitMethod(ParameterSet):
    """An implicit method with a step of one size or controlled by the error."""

    step: float = required_step()
    tolerance: float | None = local_tolerance()
    constraints: Constraints = how_constraints_are_met()
    velocities: Velocities = shown_velocities()

    @property
    @abstractmethod
    def weights(self) -> Weights:
        """Weights of a step."""

    def check(self, equations: Equations) -> None:
        """Raise InputError if ``constraints`` cannot hold what the equations have."""
        from vehicledyn.integrate.newmark.weights import refuse_constraints

        refuse_constraints(equations, self.constraints)

    @property
    def monitored_method(self) -> int | None:
        """The method as the watch of the accuracy knows it; None where a tolerance is given."""
        from vehicledyn.integrate.newmark.monitored_run import monitored_method

        return monitored_method(self.weights, self.constraints, self.tolerance)

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        from vehicledyn.integrate.newmark.monitored_run import run_monitored

        return run_monitored(task, self.kind, self, self.weights)
