"""Open-loop steering of the standards: lines between knots, and a sine that may wait or sweep."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields

from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.parameters import ParameterTable

_UNITS = {
    "amplitude": ("rad", "Amplitude of the sine"),
    "frequency": ("Hz", "Frequency of the sine at its begin"),
    "sweep_rate": ("Hz/s", "Rate at which the frequency grows"),
    "cycles": ("1", "Periods of the sine"),
    "hold_at": ("s", "Time after the begin at which the sine waits"),
    "dwell": ("s", "How long the sine waits"),
    "begin": ("s", "When the sine begins"),
}


@dataclass(frozen=True)
class SteeringSignal:
    """Steering angle δ(t) = table(t) + A sin(2π φ), φ = f τ + ½ k τ² within 0 and ``cycles``.

    τ is the time since ``begin``, which stands still for ``dwell`` from ``hold_at`` on. Angles
    are in rad, to the left; frequencies f in Hz, the sweep rate k in Hz/s.
    """

    knots: TimeTable = field(default_factory=TimeTable)
    amplitude: float = 0.0
    frequency: float = 1.0
    sweep_rate: float = 0.0
    cycles: float = 0.0
    hold_at: float = 1.0
    dwell: float = 0.0
    begin: float = 0.0

    def settings(self, name: str) -> Iterator[tuple[str, float]]:
        """Yield the parameters by name with their values."""
        for item in fields(self):
            if item.name != "knots":
                yield f"{name}.{item.name}", float(getattr(self, item.name))
        yield from self.knots.settings(f"{name}.angle")

    def enter(self, table: ParameterTable, name: str) -> Callable[[Scalar], Scalar]:
        """Enter all numbers as parameters and return the angle as a function of time."""
        numbers = dict(self.settings(name))
        p = {
            key: table.add(f"{name}.{key}", numbers[f"{name}.{key}"], unit, text)
            for key, (unit, text) in _UNITS.items()
        }
        line = self.knots.enter(table, f"{name}.angle", "rad", "steering angle")

        def law(time: Scalar) -> Scalar:
            since = ops.maximum(time - p["begin"], 0.0)
            waited = ops.maximum(since - p["hold_at"] - p["dwell"], 0.0)
            moved = ops.minimum(since, p["hold_at"]) + waited
            turned = moved * (p["frequency"] + 0.5 * p["sweep_rate"] * moved)
            phase = ops.minimum(turned, p["cycles"])
            return line(time) + p["amplitude"] * ops.sin(2.0 * math.pi * phase)

        return law


def ramp_and_hold(angle: float, rate: float, begin: float) -> SteeringSignal:
    """Return a ramp to an angle [rad] at a rate [rad/s] from a time [s] on, then held."""
    end = begin + max(abs(angle / rate), 1e-6)
    return SteeringSignal(TimeTable((begin, end), (0.0, angle)))


def sine_with_dwell(amplitude: float, frequency: float, dwell: float) -> SteeringSignal:
    """Return one period of a sine [rad, Hz] that waits at its second peak [s]."""
    return SteeringSignal(
        amplitude=amplitude,
        frequency=frequency,
        cycles=1.0,
        hold_at=0.75 / frequency,
        dwell=dwell,
    )
