"""Instant axes of wheel carriers: about what a wheel turns while a drive moves.

A carrier whose point at the contact point P moves with v while it turns with ω does so about
the screw axis through P + (ω × v) / ω² along ω. Of a steering drive with the strut held it is
the virtual steering axis. It pierces the planes across x and y through the wheel centre in the
instant centres of front and side view.

Where two drives move the carrier, two of all motions between them are pure turns, ω · v = 0: one
about the steering axis, and one about the swing axis, which is the line that the planes of two
wishbones share.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.symbolic.equations import Channel

Array = NDArray[Any]
"""Numbers, complex ones where steps into the complex plane differentiate what they give."""
_AXES = ("x", "y", "z")
_PARALLEL = 1e-9
"""Share of an axis's direction below which it is parallel to a plane [1]."""

STEERING = (
    ("caster", "rad", "Caster of the instant axis"),
    ("kingpin_inclination", "rad", "Inclination of the instant axis"),
    ("mechanical_trail", "m", "Instant axis before the contact point, along the heading"),
    ("lateral_offset", "m", "Instant axis inside the contact point, across the heading"),
    ("scrub_radius", "m", "Instant axis from the contact point, on its level"),
)
CENTRES = (
    ("front_centre_y", "m", "Instant centre of the front view, y"),
    ("front_centre_z", "m", "Instant centre of the front view, z"),
    ("side_centre_x", "m", "Instant centre of the side view, x"),
    ("side_centre_z", "m", "Instant centre of the side view, z"),
    ("roll_centre_z", "m", "Roll centre of an axle of two such wheels, z"),
)


@dataclass(frozen=True)
class WheelColumns:
    """Where the channels of a wheel sensor lie among values and velocity ratios."""

    name: str
    is_left: bool
    centre: tuple[int, ...]
    contact: tuple[int, ...]
    steer: int
    turning: tuple[int, ...]
    moving: tuple[int, ...]


def wheel_columns(
    name: str, is_left: bool, channels: Sequence[str], speeds: Sequence[str]
) -> WheelColumns | None:
    """Return the columns of the wheel sensor of this name, None if some do not move."""
    centre = [f"{name}.{axis}" for axis in _AXES]
    places = [f"{name}.contact_{axis}" for axis in _AXES]
    turning = [f"{name}.turning_{axis}" for axis in _AXES]
    moving = [f"{name}.contact_velocity_{axis}" for axis in _AXES]
    known = {*channels, *speeds}
    if not {f"{name}.steer_angle", *centre, *places, *turning, *moving} <= known:
        return None
    first = len(channels)
    return WheelColumns(
        name,
        is_left,
        tuple(channels.index(n) for n in centre),
        tuple(channels.index(n) for n in places),
        channels.index(f"{name}.steer_angle"),
        tuple(first + speeds.index(n) for n in turning),
        tuple(first + speeds.index(n) for n in moving),
    )


def axis_channels(drive: str, wheel: WheelColumns) -> Iterator[Channel]:
    """Yield the channels of the instant axis of a wheel while a drive moves."""
    for name, unit, text in (*STEERING, *CENTRES):
        words = f"{text} of {wheel.name} while {drive} moves"
        yield Channel(f"instant.{drive}.{wheel.name}.{name}", unit, words)


def swing_channels(wheel: WheelColumns) -> Iterator[Channel]:
    """Yield the channels of the swing axis of a wheel."""
    for name, unit, text in CENTRES:
        words = f"{text} of {wheel.name}, swing axis"
        yield Channel(f"swing.{wheel.name}.{name}", unit, words)


def axis_values(wheel: WheelColumns, values: Array, ratios: Array) -> list[Any]:
    """Return the quantities of the instant axis, not numbers where there is none.

    A carrier that steers while it rises moves along a screw, which no line through the contact
    point meets: its roll centre follows from the contact point's velocity.

    Parameters
    ----------
    wheel
        Columns of the wheel.
    values
        Channels at a place, shape (n_channels,).
    ratios
        Velocity ratios by the drive, shape (n_channels + n_speeds,).
    """
    axis, speed = ratios[list(wheel.turning)], ratios[list(wheel.moving)]
    line = _line(values[list(wheel.contact)], axis, speed)
    if line is None:
        return [float("nan")] * len((*STEERING, *CENTRES))
    contact = values[list(wheel.contact)]
    with np.errstate(divide="ignore", invalid="ignore"):
        height = contact[2] + contact[1] * speed[1] / speed[2]
    return [*_steering(wheel, values, *line), *_centres(wheel, values, *line)[:-1], height]


def swing_values(wheel: WheelColumns, values: Array, first: Array, second: Array) -> list[Any]:
    """Return the quantities of the swing axis, not numbers where there is none.

    ``first`` and ``second`` are the velocity ratios by the two drives, as for ``axis_values``.
    """
    turns = [ratios[list(wheel.turning)] for ratios in (first, second)]
    moves = [ratios[list(wheel.moving)] for ratios in (first, second)]
    nothing = [float("nan")] * len(CENTRES)
    # (a ω₁ + b ω₂) · (a v₁ + b v₂) = 0 with (a, b) on the unit circle.
    squares = [w @ v for w, v in zip(turns, moves, strict=True)]
    mixed = turns[0] @ moves[1] + turns[1] @ moves[0]
    mean, half = 0.5 * (squares[0] + squares[1]), 0.5 * (squares[0] - squares[1])
    size = np.sqrt(half * half + 0.25 * mixed * mixed)
    if not size.real > 0.0 or abs(mean.real) > size.real:
        return nothing
    middle = _angle(0.5 * mixed, half)
    spread = _angle(np.sqrt(size * size - mean * mean), -mean)
    lines = []
    for angle in (0.5 * (middle + spread), 0.5 * (middle - spread)):
        a, b = np.cos(angle), np.sin(angle)
        parts = (a * turns[0] + b * turns[1], a * moves[0] + b * moves[1])
        line = _line(values[list(wheel.contact)], *parts)
        if line is not None:
            lines.append(line)
    if not lines:
        return nothing
    return _centres(wheel, values, *min(lines, key=lambda line: float(line[1][2].real)))


def _angle(across: Any, along: Any) -> Any:
    """Return the angle of a direction, also of one a small step into the complex plane [rad]."""
    y, x = np.real(across), np.real(along)
    angle = np.arctan2(y, x)
    if not (np.iscomplexobj(across) or np.iscomplexobj(along)):
        return angle
    return angle + 1j * (x * np.imag(across) - y * np.imag(along)) / (x * x + y * y)


def _line(contact: Array, axis: Array, speed: Array) -> tuple[Array, Array] | None:
    """Return a point of the axis and its direction upwards, None where nothing turns."""
    size = np.sqrt(axis @ axis)
    if not size.real > 0.0 or not np.isfinite(size):
        return None
    up = axis / size * (1.0 if axis[2].real >= 0.0 else -1.0)
    return contact + np.cross(axis, speed) / size**2, up


def _steering(wheel: WheelColumns, values: Array, point: Array, up: Array) -> list[Any]:
    contact, steer = values[list(wheel.contact)], values[wheel.steer]
    side = 1.0 if wheel.is_left else -1.0
    ground = _pierced(point, up, 2, contact[2]) - contact
    trail = ground[0] * np.cos(steer) + ground[1] * np.sin(steer)
    offset = side * (ground[0] * np.sin(steer) - ground[1] * np.cos(steer))
    with np.errstate(divide="ignore"):
        lean = [np.arctan(-up[0] / up[2]), np.arctan(-side * up[1] / up[2])]
    return [*lean, trail, offset, np.sqrt(trail * trail + offset * offset)]


def _centres(wheel: WheelColumns, values: Array, point: Array, up: Array) -> list[Any]:
    contact, centre = values[list(wheel.contact)], values[list(wheel.centre)]
    front = _pierced(point, up, 0, centre[0])
    side = _pierced(point, up, 1, centre[1])
    slope = (front[2] - contact[2]) / (front[1] - contact[1])
    height = contact[2] - slope * contact[1]
    return [front[1], front[2], side[0], side[2], height]


def _pierced(point: Array, direction: Array, axis: int, level: float) -> Array:
    """Return where a line meets the plane across an axis, not numbers where it never does."""
    if abs(direction[axis]) < _PARALLEL:
        return np.full(3, np.nan)
    return np.asarray(point + direction * ((level - point[axis]) / direction[axis]))
