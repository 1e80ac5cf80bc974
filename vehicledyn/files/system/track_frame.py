"""The joint that carries a body along the railway track, and checks of its use."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from vehicledyn.base.problems import Place
from vehicledyn.base.registry import register
from vehicledyn.files.expressions.expressions import zero
from vehicledyn.files.expressions.fields import Scalar, measured
from vehicledyn.files.system.joints import Coordinate, JointSet, full_name
from vehicledyn.multibody.model.ground import GROUND

if TYPE_CHECKING:
    from vehicledyn.files.system.sets import SystemFile

_MEANINGS = {
    "T1": ("x", "x of the track frame"),
    "T2": ("y", "y of the track frame"),
    "T3": ("z", "z of the track frame"),
    "R3": ("yaw", "Yaw of the track frame"),
    "R2": ("pitch", "Pitch of the track frame"),
    "R1": ("roll", "Roll of the track frame"),
}


@register("joint", "track_frame")
class TrackFrameSet(JointSet):
    """Follow the centre line of the track as a function of time; what comes after is beside it.

    x points along the track, y to the left in the plane of the rails, z up; kinks of the design
    are rounded. The coordinates track_x to track_roll are driven.
    """

    position: Scalar = measured("m", "Place along the track, of time", variables="time")

    def coordinates(self, body: str) -> list[Coordinate]:
        """Return its six driven coordinates."""
        return [
            Coordinate(
                full_name(body, f"track_{word}"), kind, "driven", zero(), zero(), description
            )
            for kind, (word, description) in _MEANINGS.items()
        ]


def track_frame_problems(file: SystemFile) -> Iterator[tuple[Place, str]]:
    """Yield track frames that do not begin at the ground, and what else moves their coordinates."""
    for name, body in file.bodies.items():
        for number, joint in enumerate(body.joints):
            if not isinstance(joint, TrackFrameSet):
                continue
            place = ("bodies", name, "joints", number)
            if number > 0:
                yield place, "a track frame must be the first joint; what it carries comes after it"
            elif body.parent != GROUND:
                words = "a track frame begins at the ground; leave the parent out"
                yield ("bodies", name, "parent"), words
            elif body.at != type(body).model_fields["at"].default:
                words = (
                    "a track frame begins on the centre line; leave 'at' out, or place a body on it"
                )
                yield ("bodies", name, "at"), words
            own = {c.name for c in joint.coordinates(name)}
            for drive, item in file.drives.items():
                if item.coordinate in own:
                    words = f"'{item.coordinate}' follows the track already"
                    yield ("drives", drive, "coordinate"), words
            for given in file.initial:
                if given in own or given.removesuffix("_rate") in own:
                    yield (
                        ("initial", given),
                        f"'{given}' follows the track; its position says where",
                    )


def runs_on_rails(file: SystemFile) -> bool:
    """Return whether a system needs a track."""
    joints = (joint for body in file.bodies.values() for joint in body.joints)
    return bool(file.rail_wheels) or any(isinstance(joint, TrackFrameSet) for joint in joints)
