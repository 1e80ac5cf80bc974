"""Build the wheels on rails that a system file describes, and the frames that follow the track."""

from __future__ import annotations

from functools import partial

from vehicledyn.base.errors import InputError
from vehicledyn.files.building.rail_places import first_place, guide, nearest_axle, nominal_lateral
from vehicledyn.files.building.values import Values
from vehicledyn.files.system.rail_wheels import missing_choices
from vehicledyn.files.system.track_frame import TrackFrameSet
from vehicledyn.multibody.model.parts import Part
from vehicledyn.rail.contact.rail_contact import RailWheels
from vehicledyn.rail.track.follower import TrackFollower


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
                guide=guide(values, item.body),
                first_place=first_place(values, item.body),
                nearest=nearest_axle(values, item.body),
                nominal=nominal_lateral(values, item.body) if len(item.wheels) == 1 else 0.0,
            )
            wheels.check_fit(tape_circle)
            parts.append(entered.part(wheels))
        except InputError as error:
            raise InputError(f"{path}: rail_wheels.{name}: {error}") from None
    return parts
