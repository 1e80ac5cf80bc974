"""What a wheel on its rail reports: the same channels for every model of contact."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from vehicledyn.multibody.model.parts import Output
from vehicledyn.rail.creep.creep_law import CreepForces
from vehicledyn.rail.creep.creepage import Creepages
from vehicledyn.rail.track.running import LATERAL_SHIFT, TRACK_POSITION, design_rows
from vehicledyn.rail.track.track import Track
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar, Vec

LATERAL_PLACE = "lateral_place"


class ChannelRow(NamedTuple):
    """A channel; ``turns`` if seen from the right side of the track it is the opposite."""

    name: str
    unit: str
    description: str
    value: Scalar
    frame: str = ""
    turns: bool = False


@dataclass(frozen=True)
class ReportedContact:
    """What a model of contact knows of one contact; ``approach`` is none where it is rigid.

    ``place`` is on the wheel's profile and ``lateral_place`` from the middle of the track,
    outwards [m]; ``angle`` is that of the rail, positive where it rises outwards [rad].
    """

    creepages: Creepages
    creep: CreepForces
    normal_force: Scalar
    place: Scalar
    lateral_place: Scalar
    angle: Scalar
    rolling_radius: Scalar
    approach: Scalar | None = None

    @property
    def wear_number(self) -> Scalar:
        """Return |F_x ξ| + |F_y η| + |M φ|, the work of friction a length of way [N]."""
        creep, slips = self.creep, self.creepages
        return (
            ops.absolute(creep.longitudinal * slips.longitudinal)
            + ops.absolute(creep.lateral * slips.lateral)
            + ops.absolute(creep.spin_moment * slips.spin)
        )


def body_rows(
    track: Track, *, position: Scalar, rate: Scalar, place: Vec, axle: Vec, nominal: Scalar
) -> list[ChannelRow]:
    """Return the channels of a body with wheels.

    Parameters
    ----------
    track
        What it runs on.
    position, rate
        Arc coordinate beside it [m] and its rate [m/s].
    place, axle
        Its origin [m] and the unit vector along its axle, to the left, in the axes of the track.
    nominal
        Lateral place of its origin from which its shift counts, to the left [m].
    """
    attack = ops.atan2(-axle[0], axle[1])
    return [
        ChannelRow("lateral_shift", "m", LATERAL_SHIFT, place[1] - nominal, "track"),
        ChannelRow("angle_of_attack", "rad", "Yaw angle of the axle to the track", attack, "track"),
        ChannelRow(TRACK_POSITION, "m", "Place along the track", position),
        ChannelRow("track_speed", "m/s", "Rate of the place along the track", rate),
        *(ChannelRow(*row) for row in design_rows(track, position)),
    ]


def outputs_of(name: str, rows: Sequence[ChannelRow]) -> tuple[Output, ...]:
    """Return the outputs of a part from its channels."""
    return tuple(
        Output(Channel(f"{name}.{row.name}", row.unit, row.description, row.frame), row.value)
        for row in rows
    )


def wheel_rows(force: Vec, contacts: Sequence[ReportedContact]) -> Iterator[ChannelRow]:
    """Yield the channels of a wheel, given the whole force on it in the axes of the track [N]."""
    worn = sum((contact.wear_number for contact in contacts), ops.scalar(0.0))
    yield ChannelRow(
        "Y", "N", "Force of the wheel on the rail to the left", -force[1], "track", True
    )
    yield ChannelRow("Q", "N", "Wheel load, downwards on the rail", force[2], "track")
    yield ChannelRow("X", "N", "Force of the wheel on the rail forwards", -force[0], "track")
    yield ChannelRow("wear_number", "N", "Creep forces times creepages", worn)
    for number, contact in enumerate(contacts, 1):
        for row in _contact_rows(contact):
            yield row._replace(name=f"contact_{number}.{row.name}")


def _contact_rows(at: ReportedContact) -> Iterator[ChannelRow]:
    force, creep = at.creep, at.creepages
    rows: list[tuple[str, str, str, Scalar, bool]] = [
        ("normal_force", "N", "Normal force", at.normal_force, False),
        ("longitudinal_force", "N", "Creep force on the wheel forwards", force.longitudinal, False),
        ("lateral_force", "N", "Creep force on the wheel to the left", force.lateral, True),
        ("spin_moment", "N*m", "Creep moment on the wheel", force.spin_moment, True),
        ("longitudinal_creepage", "1", "Longitudinal creepage", creep.longitudinal, False),
        ("lateral_creepage", "1", "Lateral creepage to the left", creep.lateral, True),
        ("spin_creepage", "1/m", "Spin creepage", creep.spin, True),
        ("place", "m", "Place on the wheel's profile, outwards", at.place, False),
        (LATERAL_PLACE, "m", "Place left of the track's middle", at.lateral_place, True),
        ("angle", "rad", "Contact angle, positive where the rail rises outwards", at.angle, False),
        ("rolling_radius", "m", "Radius at the contact", at.rolling_radius, False),
    ]
    if at.approach is not None:
        rows.append(("approach", "m", "Approach of wheel and rail", at.approach, False))
    for name, unit, text, value, turns in rows:
        yield ChannelRow(name, unit, text, value, "contact", turns)
