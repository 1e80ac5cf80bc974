"""Wavy ground: one sine wave along the road and one across it."""

from __future__ import annotations

import math

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@register("road", "sine")
class Sine(RoadSurface):
    """Wavy ground, z = a_x sin(2π x/l_x) + a_y sin(2π y/l_y).

    A disc touches it in one point while its radius stays below the smallest radius of
    curvature l²/(4π² a).
    """

    amplitude_x: float = quantity("m", "Amplitude a_x of the wave along world x")
    wavelength_x: float = quantity("m", "Length l_x of the wave along world x", gt=0)
    amplitude_y: float = quantity("m", "Amplitude a_y of the wave along world y")
    wavelength_y: float = quantity("m", "Length l_y of the wave along world y", gt=0)

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the ground [m]."""
        along = self.amplitude_x * ops.sin(2.0 * math.pi / self.wavelength_x * x)
        return along + self.amplitude_y * ops.sin(2.0 * math.pi / self.wavelength_y * y)

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the two slopes [1]."""
        number_x, number_y = 2.0 * math.pi / self.wavelength_x, 2.0 * math.pi / self.wavelength_y
        return (
            self.amplitude_x * number_x * ops.cos(number_x * x),
            self.amplitude_y * number_y * ops.cos(number_y * y),
        )
