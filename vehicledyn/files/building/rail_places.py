"""Where along the track the bodies of a system file are, and how far apart its axles."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from vehicledyn.files.building.values import Values
from vehicledyn.files.expressions.algebra import NUMBERS
from vehicledyn.files.expressions.expressions import Expression
from vehicledyn.files.system.track_frame import TrackFrameSet

_SAME_AXLE = 0.1


def guide(values: Values, name: str) -> Callable[[Any], Any] | None:
    """Return the arc coordinate of a body that a track frame carries, but for small motions."""
    ahead: Any = 0.0
    while name in values.model.file.bodies:
        body = values.model.file.bodies[name]
        first = body.joints[0] if body.joints else None
        if isinstance(first, TrackFrameSet):
            return partial(_ahead_of, values, first.position, ahead)
        name, ahead = body.parent, ahead + values.value(body.at)[0]
    return None


def first_place(values: Values, name: str) -> float:
    """Return how far along x a body starts before anything turns it [m]."""
    file, place = values.model.file, 0.0
    at_zero = partial(_at_zero, values)
    laws = {drive.coordinate: drive.law for drive in file.drives.values()}
    while name in file.bodies:
        body = file.bodies[name]
        place += float(values.number(body.at)[0])
        slides = [c for c in body.coordinates(name) if c.joint == "T1"]
        for slide in slides:
            law = laws.get(slide.name)
            given = file.initial.get(slide.name, slide.start)
            place += float(values.number(given) if law is None else law.at(0.0, at_zero))
        name = body.parent
    return place


def nominal_lateral(values: Values, name: str) -> Any:
    """Return how far to the left of the track a body is before anything moves it [m]."""
    file, place = values.model.file, 0.0
    while name in file.bodies:
        body = file.bodies[name]
        place, name = place + values.value(body.at)[1], body.parent
    return place


def nearest_axle(values: Values, name: str) -> float:
    """Return how far along the track the nearest other axle with wheels on rails is at the start.

    Returns
    -------
    float
        Distance of the two bodies [m]; zero where there is no other axle.
    """
    bodies = dict.fromkeys(item.body for item in values.model.file.rail_wheels.values())
    own = _start(values, name)
    apart = [abs(_start(values, other) - own) for other in bodies if other != name]
    return min((gap for gap in apart if gap > _SAME_AXLE), default=0.0)


def _start(values: Values, name: str) -> float:
    """Return where along the track a body starts, but for small motions [m]."""
    file, ahead, body = values.model.file, 0.0, name
    while body in file.bodies:
        first = next(iter(file.bodies[body].joints), None)
        if isinstance(first, TrackFrameSet):
            return float(_at_zero(values, first.position, time=0.0)) + ahead
        ahead += float(values.number(file.bodies[body].at)[0])
        body = file.bodies[body].parent
    return first_place(values, name)


def _at_zero(values: Values, expression: Expression, **names: Any) -> Any:
    return expression.value({**values.numbers, **names}, NUMBERS)


def _ahead_of(values: Values, position: Expression, ahead: Any, time: Any) -> Any:
    return values.at_time(position, time) + ahead
