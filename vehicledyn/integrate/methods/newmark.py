"""Newmark's implicit method, with a step of one size or controlled by the error."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.implicit_method import ImplicitMethod

if TYPE_CHECKING:
    from vehicledyn.integrate.newmark.weights import Weights


@register("solver", "newmark")
class Newmark(ImplicitMethod):
    """Newmark's implicit method; order 2 with gamma = 1/2, else order 1.

    With beta = 1/4 and gamma = 1/2 it is the trapezoidal rule: stable with any step where the
    model is linear, and without numerical damping.

    Newmark (1959), A method of computation for structural dynamics, Journal of the Engineering
    Mechanics Division 85, 67-94.
    """

    beta: float = quantity("1", "Weight of the new acceleration in positions", default=0.25, gt=0)
    gamma: float = quantity(
        "1", "Weight of the new acceleration in velocities", default=0.5, ge=0.5
    )

    @property
    def weights(self) -> Weights:
        """Weights of a step."""
        from vehicledyn.integrate.newmark.weights import Weights

        return Weights.newmark(self.beta, self.gamma)
