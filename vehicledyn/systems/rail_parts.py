"""Build the wheels on rails that a system file describes, and the frames that follow the track."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.parts import Part
from vehicledyn.rail.rail_contact import RailWheels
from vehicledyn.rail.track_follower import TrackFollower
from vehicledyn.systems.algebra import NUMBERS
from vehicledyn.systems.expressions import Expression
from vehicledyn.systems.rail_wheels import missing_choices
from vehicledyn.systems.track_frame import TrackFrameSet
from vehicledyn.systems.values import Values


def track_frames(values: Values) -> list[Part]:
    """Return what carries the frames of bodies along the track."""
    return [
        TrackFollower(
            f"{name}.track_frame",
            tuple(c.name for c in joint.coordinates(name)),
            name,
            values.track,
            partial(values.at_time, joint.position),
        )
        for name, body in values.model.file.bodies.items()
        for joint in body.joints
        if isinstance(joint, TrackFrameSet)
    ]


def rail_wheel_parts(values: Values) -> list[Part]:
    """Return the wheels on rails.

    Raises
    ------
    InputError
        If they lack a track, a creep law or a model of contact, or do not fit the rails.
    """
    file, path = values.model.file, values.model.path
    if not file.rail_wheels:
        return []
    creep = values.choice.creep or file.creep
    contact = values.choice.rail_contact or file.rail_contact
    problems = missing_choices(creep, contact)
    if problems:
        raise InputError("\n".join(f"{path}: {problem}" for problem in problems))
    track = values.track
    law = values.table.add_set("creep", creep)  # type: ignore[type-var]
    entered = contact.entered(values.table)  # type: ignore[union-attr]
    parts: list[Part] = []
    for name, item in file.rail_wheels.items():
        try:
            tape_circle = float(values.number(item.tape_circle))
            item.check_gauge(tape_circle, track.gauge)
            wheels = RailWheels(
                name,
                item.body,
                item.wheels,
                item.open(path.parent),
                radius=values.value(item.radius),
                tape_circle=values.value(item.tape_circle),
                radius_number=float(values.number(item.radius)),
                track=track,
                creep=law,  # type: ignore[arg-type]
                guide=_guide(values, item.body),
                first_place=_first_place(values, item.body),
            )
            wheels.check_fit(tape_circle)
            parts.append(entered.part(wheels))
        except InputError as error:
            raise InputError(f"{path}: rail_wheels.{name}: {error}") from None
    return parts


def _guide(values: Values, name: str) -> Callable[[Any], Any] | None:
    """Return the arc coordinate of a body that a track frame carries, but for small motions."""
    ahead: Any = 0.0
    while name in values.model.file.bodies:
        body = values.model.file.bodies[name]
        first = body.joints[0] if body.joints else None
        if isinstance(first, TrackFrameSet):
            return partial(_ahead_of, values, first.position, ahead)
        name, ahead = body.parent, ahead + values.value(body.at)[0]
    return None


def _first_place(values: Values, name: str) -> float:
    """Return how far along x a body starts before anything turns it [m]."""
    file, place = values.model.file, 0.0

    def at_zero(expression: Expression, **names: Any) -> Any:
        return expression.value({**values.numbers, **names}, NUMBERS)

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


def _ahead_of(values: Values, position: Expression, ahead: Any, time: Any) -> Any:
    return values.at_time(position, time) + ahead
