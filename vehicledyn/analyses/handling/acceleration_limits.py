"""g-g diagram: the largest lateral acceleration of steady turns at longitudinal accelerations.

For each longitudinal acceleration lateral acceleration grows to its limit; drive and brake torques
are those of the car's drive and of brakes with its distribution. A braked inner wheel comes to its
largest force and locks; the diagram goes on with it locked, as the car does, or with it rolling
where a car that turns first and brakes then gets further. With much drive a
driven wheel spins up, or the turns go over to power slides without a limit: the driver steers
against the turn at side-slip angles that grow. There the diagram ends. Each point names its end.
"""

from __future__ import annotations

import itertools
import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.standing_wheel import with_wheel_standing
from vehicledyn.analyses.handling.steady_turn import (
    FULL_THROTTLE,
    POWER_SLIDE,
    WHEEL_SPIN,
    SteadyTurn,
)
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import TurnDemand, TurnOf
from vehicledyn.analyses.handling.turn_limit import limit_value
from vehicledyn.analyses.handling.turn_paths import TurnPath, followed
from vehicledyn.base.errors import NumericalError

Vector = NDArray[np.float64]

FRONT_GRIP, REAR_GRIP, LARGEST_FORCE = "front grip", "rear grip", "largest force"
"""Limits of turns: the front or the rear wheels have their largest force across, or one wheel that
along, behind which it locks or spins."""

ENDS = {
    FRONT_GRIP: "the grip of the front wheels across ends the turns",
    REAR_GRIP: "the grip of the rear wheels across ends the turns",
    LARGEST_FORCE: "one wheel reaches its largest force along and then locks or spins",
    POWER_SLIDE: "a power slide with opposite lock begins",
    WHEEL_SPIN: "a driven wheel turns twice as fast as the ground",
    FULL_THROTTLE: "the drive reaches full throttle",
}
"""What ends turns, in words."""

_FIRST_STEP, SMALLEST_STEP = 0.5, 0.03
_SMALLEST_ALONG, _SMALLEST_LATER = 0.05, 0.2

_EVEN = 1e-9
"""Part of a step by which a size may miss one of the even ones [1]."""

_LOCKED, _BACKWARDS = -0.9, -1.1
"""Longitudinal slip of a wheel that counts as locked, and of one that turns backwards [1]."""

_NEARLY_FULL = 0.95
"""Throttle from which on a limit is that of the drive [1]."""

_OTHER_TRIES = 6
"""About how many turns of another braking are tried."""

_ASIDE = 0.1
"""Most that the side-slip angle leaps by where a wheel locks [rad]; further off is another turn."""

_RUNS_AWAY = 0.1
"""Least slip along that grows at a limit and may lock a wheel, as a part of what grows most [1]."""


@dataclass(frozen=True)
class AccelerationLimits:
    """Limits at a speed [m/s]: accelerations along and across the path, shape (n,) [m/s²].

    ``ends`` (n,) says what ends each path of turns: the grip of an axle, a wheel's largest force
    along, power slide, wheel spin or full throttle; "" where no limit showed, and in straight
    running, where all wheels are alike. ``wheels`` (n,) names the wheel of that largest force, else
    "", and ``locked`` (n,) those that are locked. ``lost`` says what was left off.
    """

    speed: float
    longitudinal: Vector
    lateral: Vector
    ends: tuple[str, ...]
    wheels: tuple[str, ...]
    locked: tuple[tuple[str, ...], ...]
    lost: tuple[str, ...] = ()

    def notes(self) -> list[str]:
        """Return a sentence for each reason that ends turns, and for each set of locked wheels."""
        pairs = list(zip(self.ends, self.wheels, strict=True))
        ended = {
            (end, wheel): f"{ENDS[end]}{f' ({wheel})' if wheel else ''}"
            for end, wheel in pairs
            if end
        }
        at = self.longitudinal
        lines = [
            f"{words}: at {_listed(at[[pair == key for pair in pairs]])}"
            for key, words in ended.items()
        ]
        for wheels in dict.fromkeys(self.locked):
            if wheels:
                there = _listed(at[[locked == wheels for locked in self.locked]])
                lines.append(f"locked at the limit ({', '.join(wheels)}): at {there}")
        return lines


_Limit = tuple[float, float, str, str, tuple[str, ...]]
"""Accelerations along and across [m/s²], what ends the turns, its wheel, and the locked ones."""


def _listed(values: Vector) -> str:
    return f"{', '.join(f'{value:.3g}' for value in values)} m/s^2 along the path"


def acceleration_limits(
    solver: SteadyTurn, speed: float, *, step: float = 1.0
) -> AccelerationLimits:
    """Return the limits for braking and driving in steps of longitudinal acceleration [m/s²].

    The first and the last one are those of straight running.

    Raises
    ------
    NumericalError
        If the car does not run straight.
    """
    found: list[_Limit] = []
    lost = []
    for direction, words in ((-1.0, "braking"), (1.0, "driving")):
        turns, path = turns_to_limits(solver, speed, direction, step=step)
        size = path.values[-1]
        for braked, across in turns.items():
            found.append(_limit(solver, across, direction * braked, speed))
            if across.is_lost:
                further = _FURTHER % across.values[-1]
                lost.append(f"{words} at {braked:g} m/s^2: {further} across the path")
        most = limit_value(solver, _along(speed, direction), path, smallest=_SMALLEST_ALONG)
        found.append((direction * most, 0.0, _reason(solver, path), "", ()))
        if path.is_lost:
            lost.append(f"{words}: {_FURTHER % size} along the path")
    found.sort(key=lambda row: row[0])
    longitudinal, lateral, ends, wheels, locked = zip(*found, strict=True)
    return AccelerationLimits(
        speed, np.array(longitudinal), np.array(lateral), ends, wheels, locked, tuple(lost)
    )


_FURTHER = "no balance was found beyond %.3g m/s^2"


def turns_to_limits(
    solver: SteadyTurn,
    speed: float,
    direction: float,
    *,
    step: float = 1.0,
    also: Sequence[float] = (),
    last: float = np.inf,
) -> tuple[dict[float, TurnPath], TurnPath]:
    """Return the turns to the limit of each size of acceleration along, and those straight ahead.

    Parameters
    ----------
    solver, speed
        Of the car.
    direction
        1 for driving, which also has the size 0, -1 for braking.
    step
        Distance of sizes [m/s²].
    also
        Further sizes between them [m/s²].
    last
        Size to end at, of driving [m/s²].

    Raises
    ------
    NumericalError
        If the car does not run straight.
    """
    size, point = 0.0, solver.straight(speed)
    turns: dict[float, TurnPath] = {}
    while True:
        if size or direction > 0.0:
            turns[size] = _across(solver, speed, direction * size, point)
        following = (np.floor(size / step + _EVEN) + 1.0) * step
        wanted = min([float(following), *(other for other in also if other > size)])
        path = _straight(solver, speed, direction, (size, point), wanted - size)
        size, point = path.values[-1], path.points[-1]
        if path.end != "found" or (direction > 0.0 and size > last):
            break
    return (_further_braked(solver, speed, turns) if direction < 0.0 else turns), path


def _straight(
    solver: SteadyTurn, speed: float, direction: float, start: tuple[float, CarPoint], step: float
) -> TurnPath:
    return followed(
        solver,
        _along(speed, direction),
        start,
        start[0] + step,
        step=step,
        smallest=_SMALLEST_ALONG,
        unwanted=solver.beyond_grip_or_drive,
    )


def _along(speed: float, direction: float) -> TurnOf:
    """Return straight running at an acceleration along the path, or a deceleration."""
    return lambda size: _turn(speed, 0.0, direction * size)


def _limit(solver: SteadyTurn, path: TurnPath, along: float, speed: float) -> _Limit:
    """Return both accelerations, what ends the turns, the wheel that does, and the locked ones."""
    last, point = path.values[-1], path.points[-1]
    reason, wheel = _reason(solver, path), ""
    if path.is_limit and not reason:
        locked = _locked(solver, point)
        growth = solver.slip_growth(_turn(speed, last, along), point)
        wheel = max(growth, key=lambda name: 0.0 if name in locked else abs(growth[name]))
        reason = {"front": FRONT_GRIP, "rear": REAR_GRIP}.get(wheel, LARGEST_FORCE)
    is_named = reason == LARGEST_FORCE
    most = limit_value(solver, lambda a: _turn(speed, a, along), path, smallest=SMALLEST_STEP)
    return along, most, reason, wheel if is_named else "", _locked(solver, point)


def _reason(solver: SteadyTurn, path: TurnPath) -> str:
    """Return what else than a tyre ends a path, else ""; an engine at its largest torque does."""
    pedal = solver.states.pedal
    is_full = path.is_limit and pedal is not None and path.points[-1].state[pedal] > _NEARLY_FULL
    return FULL_THROTTLE if is_full else path.reason


def _turn(speed: float, lateral: float, along: float) -> TurnDemand:
    return TurnDemand(speed, "lateral_acceleration", lateral, along)


def _braking(speed: float, lateral: float, first: float, sign: float) -> TurnOf:
    """Return turns of a value that grows from a first braking, which grows or falls from it."""
    return lambda value: _turn(speed, lateral, -(first + sign * (value - first)))


def _across(solver: SteadyTurn, speed: float, along: float, straight: CarPoint) -> TurnPath:
    """Follow the turns to their limit, with each wheel locked that locks on the way.

    The path that is returned begins where the last wheel has locked.
    """
    return _on(solver, speed, along, 0.0, straight)


def _on(
    solver: SteadyTurn, speed: float, along: float, lateral: float, point: CarPoint
) -> TurnPath:
    """Follow the turns from one of a lateral acceleration, see :func:`_across`."""

    def path_from(value: float, point: CarPoint) -> TurnPath:
        return followed(
            solver,
            lambda lateral: _turn(speed, lateral, along),
            (value, point),
            np.inf,
            step=_FIRST_STEP,
            smallest=SMALLEST_STEP,
            unwanted=solver.beyond_grip_or_drive,
        )

    path, further = path_from(lateral, point), None
    while along < 0.0 and path.is_limit:
        turn = _turn(speed, path.values[-1], along)
        further = _with_one_locked(solver, turn, path.points[-1], path_from)
        if further is None:
            break
        path = further
    return path


def _further_braked(
    solver: SteadyTurn, speed: float, turns: dict[float, TurnPath]
) -> dict[float, TurnPath]:
    """Return the turns that go furthest across, of braking sizes that grow [m/s²].

    A car that turns first and then brakes locks no wheel where loads and slips of the turn keep it
    from that; one that has braked harder has it locked already. So each size is also reached from
    the turns of less braking, and then of more.
    """
    turns = dict(turns)
    for sizes in (list(turns), list(turns)[::-1]):
        for known, wanted in itertools.pairwise(sizes):
            turns[wanted] = _braked_from(solver, speed, (known, wanted), turns)
    return turns


def _braked_from(
    solver: SteadyTurn, speed: float, sizes: tuple[float, float], turns: dict[float, TurnPath]
) -> TurnPath:
    """Return the turns of a braking acceleration that go furthest across.

    They are those known, or such as are reached from the furthest turns of another braking, held at
    their lateral acceleration: from turns that go further across, or have more wheels locked, with
    which the car may turn on; also where no limit showed.
    """
    known, wanted = sizes
    across, last = turns[wanted], known + abs(wanted - known)
    ends = (set(_locked(solver, turns[size].points[-1])) for size in (known, wanted))
    is_more_locked = operator.gt(*ends)
    others = list(zip(turns[known].values, turns[known].points, strict=True))[::-1]
    for lateral, point in others[:: max(1, len(others) // _OTHER_TRIES)]:
        if lateral <= across.values[-1] and not (is_more_locked or across.is_lost):
            break
        braked = followed(
            solver,
            _braking(speed, lateral, known, 1.0 if wanted > known else -1.0),
            (known, point),
            last,
            step=last - known,
            smallest=_SMALLEST_LATER,
        )
        if braked.end == "found":
            further = _on(solver, speed, -wanted, lateral, braked.points[-1])
            gained = further.values[-1] - across.values[-1]
            shows_more = across.is_lost and not further.is_lost and gained > -SMALLEST_STEP
            return further if gained > 0.0 or shows_more else across
    return across


def _with_one_locked(
    solver: SteadyTurn,
    turn: TurnDemand,
    point: CarPoint,
    path_from: Callable[[float, CarPoint], TurnPath],
) -> TurnPath | None:
    """Return the path that goes on from a limit with one more wheel locked, None if none does.

    A wheel behind its largest force stops under its brake, and the turn is balanced anew.
    """
    car, before = solver.car, _locked(solver, point)
    growth = solver.slip_growth(turn, point)
    least = _RUNS_AWAY * max(abs(value) for value in growth.values())
    for corner in sorted(car.vehicle.corners, key=lambda corner: growth[corner.name]):
        if growth[corner.name] > -least or corner.name in before:
            continue
        try:
            locked = with_wheel_standing(solver, turn, point, corner)
        except NumericalError:
            continue
        if set(_locked(solver, locked)) != {*before, corner.name}:
            continue
        aside = [solver.car.outputs(p)["body.sideslip_angle"] for p in (point, locked)]
        if abs(aside[1] - aside[0]) > _ASIDE:
            continue
        path = path_from(turn.value, locked)
        if path.values[-1] > turn.value:
            return path
    return None


def _locked(solver: SteadyTurn, point: CarPoint) -> tuple[str, ...]:
    """Return the wheels that are locked in a turn."""
    outputs = solver.car.outputs(point)
    slips = {
        c.name: outputs[f"{c.name}.tyre.longitudinal_slip"] for c in solver.car.vehicle.corners
    }
    return tuple(name for name, slip in slips.items() if _BACKWARDS < slip < _LOCKED)
