"""Implicit method of Hilber, Hughes and Taylor with a fixed step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.integrate.methods.implicit_method import ImplicitMethod

if TYPE_CHECKING:
    from vehicledyn.integrate.newmark.weights import Weights


@register("solver", "hht")
class HilberHughesTaylor(ImplicitMethod):
    """Implicit HHT method, order 2; damps oscillations that the step cannot resolve.

    The usual parameter alpha is (r - 1)/(r + 1), of r the spectral radius. All forces of a step,
    those of the time too, are averages of those at its ends.

    Hilber, Hughes, Taylor (1977), Improved numerical dissipation for time integration algorithms
    in structural dynamics, Earthquake Engineering and Structural Dynamics 5, 283-292.
    """

    spectral_radius: float = quantity(
        "1", "Factor a step leaves of infinitely fast oscillations", default=0.8, ge=0.5, le=1
    )

    @property
    def weights(self) -> Weights:
        """Weights of a step."""
        from vehicledyn.integrate.newmark.weights import Weights

        return Weights.hht(self.spectral_radius)
