"""Chung and Hulbert's implicit generalised-alpha method."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.implicit_method import ImplicitMethod

if TYPE_CHECKING:
    from vehicledyn.integrate.newmark.weights import Weights


@register("solver", "generalised_alpha")
class GeneralisedAlpha(ImplicitMethod):
    """Implicit generalised-alpha method, order 2; damps what it cannot resolve.

    Of all methods of its family with this spectral radius it damps slow motion least. All forces
    of a step, those of the time too, are averages of those at its ends.

    Chung, Hulbert (1993), A time integration algorithm for structural dynamics with improved
    numerical dissipation: the generalized-alpha method, Journal of Applied Mechanics 60, 371-375.
    """

    spectral_radius: float = quantity(
        "1", "Factor a step leaves of infinitely fast oscillations", default=0.8, ge=0, le=1
    )

    @property
    def weights(self) -> Weights:
        """Weights of a step."""
        from vehicledyn.integrate.newmark.weights import Weights

        return Weights.generalised_alpha(self.spectral_radius)
