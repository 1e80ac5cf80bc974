"""Report wheels that stand and whose laws hold for rolling: all on rails, some on the road."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from vehicledyn.analyses.preparation.prepare import Point
from vehicledyn.analyses.preparation.prepared import Prepared

_SLOW = 0.1
"""Speed along the track below which a wheel counts as standing [m/s]."""
_SPEED = ".track_speed"


_LOAD, _DEFLECTION = ".tyre.normal_force", ".tyre.longitudinal_deflection"
_SPIN = ".spin_rate"


def standing_wheels(prepared: Prepared, start: Point) -> list[str]:
    """Return a line about wheels that stand at the start of a run, on rails or on the road."""
    names = [channel.name for channel in prepared.equations.channels]
    if not any(name.endswith((_SPEED, _LOAD)) for name in names):
        return []
    outputs = prepared.kernel.outputs(0.0, start.state, start.unknowns)
    values = dict(zip(names, map(float, outputs), strict=True))
    return [*_on_rails(values), *_on_the_road(values, {s.name for s in prepared.equations.states})]


def _on_rails(values: Mapping[str, float]) -> list[str]:
    found = [
        name.removesuffix(_SPEED)
        for name, value in values.items()
        if name.endswith(_SPEED) and abs(value) < _SLOW
    ]
    if not found:
        return []
    return [
        f"wheels on rails stand at the start: {', '.join(found)}; creep forces are those of "
        f"rolling wheels, below {_SLOW:g} m/s they are stiff and chatter in fixed steps: give a "
        "speed, or use an implicit solver and keep to the vertical motion"
    ]


def _on_the_road(values: Mapping[str, float], states: Collection[str]) -> list[str]:
    """Return the line about wheels whose tyres resist only while they slide."""
    wheels = [name.removesuffix(_LOAD) for name in values if name.endswith(_LOAD)]
    found = [
        wheel
        for wheel in wheels
        if values.get(f"{wheel}{_SPIN}") == 0.0 and f"{wheel}{_DEFLECTION}" not in states
    ]
    if not found:
        return []
    return [
        f"wheels stand at the start: {', '.join(found)}; without 'relaxation' a tyre resists only "
        "while it slides, so that locked wheels creep on slopes, whatever the step: give "
        "'relaxation' for a vehicle that is to stand"
    ]
