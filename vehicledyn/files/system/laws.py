"""Force laws of links and coordinates, and time laws of drives."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable
from typing import Any, Self

from pydantic import model_validator

from vehicledyn.base.registry import register
from vehicledyn.files.expressions.expressions import zero
from vehicledyn.files.expressions.fields import Scalar, Scalars, SystemSet, measured
from vehicledyn.symbolic import ops

Values = Callable[..., Any]
"""Value of an expression, with further names as keywords."""


class ForceLaw(SystemSet):
    """Base of the force laws: a force against growing length, as in a spring under tension."""

    @abstractmethod
    def tension(self, length: Any, rate: Any, value: Values) -> Any:
        """Return the force from the length [m or rad] and its rate."""


@register("force_law", "spring_damper")
class SpringDamper(ForceLaw):
    """Linear spring and damper, F = F_0 + k (Z - Z_0) + c Z'."""

    stiffness: Scalar = measured("{force}/{length}", "Stiffness k", default=zero())
    damping: Scalar = measured("{force}*s/{length}", "Damping c", default=zero())
    free_length: Scalar = measured("{length}", "Length Z_0 without spring force", default=zero())
    preload: Scalar = measured("{force}", "Constant force F_0", default=zero())

    def tension(self, length: Any, rate: Any, value: Values) -> Any:
        """Return the sum of spring, damper and preload."""
        spring = value(self.stiffness) * (length - value(self.free_length))
        return value(self.preload) + spring + value(self.damping) * rate


@register("force_law", "constant")
class ConstantForce(ForceLaw):
    """The same force at any length."""

    amount: Scalar = measured("{force}", "The force")

    def tension(self, length: Any, rate: Any, value: Values) -> Any:
        """Return the amount."""
        return value(self.amount)


@register("force_law", "polynomial")
class Polynomial(ForceLaw):
    """F = Σ a_k (Z - Z_0)^k + Σ b_k Z'^k, the coefficients from k = 1 on."""

    stiffness: Scalars = measured(
        "{force}/{length}^{k}", "Coefficients a_1, a_2 ... of the stretch", default=()
    )
    damping: Scalars = measured(
        "{force}*s^{k}/{length}^{k}", "Coefficients b_1, b_2 ... of its rate", default=()
    )
    free_length: Scalar = measured("{length}", "Length Z_0 without force", default=zero())

    def tension(self, length: Any, rate: Any, value: Values) -> Any:
        """Return both polynomials."""
        stretch = length - value(self.free_length)
        elastic = _polynomial([value(a) for a in self.stiffness], stretch)
        return elastic + _polynomial([value(b) for b in self.damping], rate)


def _polynomial(coefficients: list[Any], x: Any) -> Any:
    total: Any = 0.0
    for coefficient in reversed(coefficients):
        total = x * (coefficient + total)
    return total


@register("force_law", "table")
class Table(ForceLaw):
    """Straight lines between points, the first and last line going on; and a linear damper."""

    lengths: Scalars = measured("{length}", "Lengths of the points, growing")
    forces: Scalars = measured("{force}", "Force at each of them")
    damping: Scalar = measured("{force}*s/{length}", "Damping", default=zero())

    @model_validator(mode="after")
    def _as_many(self) -> Self:
        if len(self.lengths) != len(self.forces) or len(self.lengths) < 2:
            counts = f"{len(self.lengths)} lengths and {len(self.forces)} forces"
            raise ValueError(f"{counts}; give as many, two at least")
        return self

    def tension(self, length: Any, rate: Any, value: Values) -> Any:
        """Return the line's force and the damper's."""
        x, y = [[value(item) for item in items] for items in (self.lengths, self.forces)]
        slopes = [(y[k + 1] - y[k]) / (x[k + 1] - x[k]) for k in range(len(x) - 1)]
        total = y[0] + slopes[0] * (length - x[0])
        for k in range(1, len(slopes)):
            total = total + (slopes[k] - slopes[k - 1]) * ops.maximum(length - x[k], 0.0)
        return total + value(self.damping) * rate


@register("force_law", "expression")
class WrittenForce(ForceLaw):
    """Any expression of ``length`` and ``rate``."""

    force: Scalar = measured("{force}", "The force", variables="law")

    def tension(self, length: Any, rate: Any, value: Values) -> Any:
        """Return the expression's value."""
        return value(self.force, length=length, rate=rate)


class TimeLaw(SystemSet):
    """Base of the time laws: a coordinate as a function of time."""

    @abstractmethod
    def at(self, time: Any, value: Values) -> Any:
        """Return the coordinate [m or rad] at a time [s]."""


@register("time_law", "constant_rate")
class ConstantRateLaw(TimeLaw):
    """q = q_0 + rate · t."""

    rate: Scalar = measured("{length}/s", "The rate")
    start: Scalar = measured("{length}", "Value q_0 at time zero", default=zero())

    def at(self, time: Any, value: Values) -> Any:
        """Return the line."""
        return value(self.start) + value(self.rate) * time


@register("time_law", "ramp")
class Ramp(TimeLaw):
    """From one value to another along the smooth step 10 s³ - 15 s⁴ + 6 s⁵."""

    first: Scalar = measured("{length}", "Value before", default=zero())
    last: Scalar = measured("{length}", "Value after")
    begin: Scalar = measured("s", "When it begins", default=zero())
    duration: Scalar = measured("s", "How long it takes", above=0.0)

    def at(self, time: Any, value: Values) -> Any:
        """Return the step; its first two derivatives are continuous."""
        first = value(self.first)
        s = (time - value(self.begin)) / value(self.duration)
        s = ops.minimum(ops.maximum(s, 0.0), 1.0)
        return first + (value(self.last) - first) * s**3 * (10.0 + s * (6.0 * s - 15.0))


@register("time_law", "sine")
class Sine(TimeLaw):
    """q = q_0 + A sin(2 π f t + φ)."""

    amplitude: Scalar = measured("{length}", "Amplitude A")
    frequency: Scalar = measured("Hz", "Frequency f", least=0.0)
    phase: Scalar = measured("rad", "Phase φ", default=zero())
    offset: Scalar = measured("{length}", "Mean q_0", default=zero())

    def at(self, time: Any, value: Values) -> Any:
        """Return the sine."""
        angle = 2.0 * math.pi * value(self.frequency) * time + value(self.phase)
        return value(self.offset) + value(self.amplitude) * ops.sin(angle)


@register("time_law", "expression")
class WrittenMotion(TimeLaw):
    """Any expression of ``time``, of continuous rate."""

    position: Scalar = measured("{length}", "The coordinate", variables="time")

    def at(self, time: Any, value: Values) -> Any:
        """Return the expression's value."""
        return value(self.position, time=time)
