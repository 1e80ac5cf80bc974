"""What of a run can be assessed: wheels on rails, accelerometers, ways along the track."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from vehicledyn.results.assessment.comfort import DIRECTIONS

_WHEEL = re.compile(r"(.+)\.(left|right)\.Q")
_WAYS = ("track_position", "x")
_SPEED = "forward_speed"
_BEND = "curvature"


@dataclass(frozen=True)
class Subjects:
    """Names found among the channels of a run.

    ``axles`` holds the wheels of each body that has any; ``sensors`` the accelerometers, of which
    ``floors`` give the roll rate too; ``worn`` the wheels whose wear number is known; ``ways``
    channels that may give the distance run, in m, and ``speeds`` in m/s; ``bends`` those of the
    curvature of the track, in 1/m, of frames before axles, and ``cants`` of its cant at axles.
    """

    axles: Mapping[str, tuple[str, ...]]
    sensors: tuple[str, ...]
    floors: tuple[str, ...]
    worn: tuple[str, ...]
    ways: tuple[str, ...]
    speeds: tuple[str, ...]
    bends: tuple[str, ...]
    cants: tuple[str, ...]

    @property
    def wheels(self) -> tuple[str, ...]:
        """All wheels."""
        return tuple(wheel for wheels in self.axles.values() for wheel in wheels)

    def channels(self, known: Iterable[str]) -> list[str]:
        """Return the channels that an assessment reads."""
        names = set(known)
        forces = [f"{wheel}.{force}" for wheel in self.wheels for force in ("Y", "Q")]
        wear = [f"{wheel}.wear_number" for wheel in self.worn]
        sensed = [f"{sensor}.{word}" for sensor in self.sensors for word in DIRECTIONS]
        return [
            *forces,
            *wear,
            *(f"{floor}.roll_rate" for floor in self.floors),
            *(name for name in sensed if name in names),
            *self.ways,
            *self.speeds,
            *self.bends,
            *self.cants,
        ]


def find_subjects(units: Mapping[str, str]) -> Subjects:
    """Return what can be assessed in a run with channels of these names and units."""
    axles: dict[str, tuple[str, ...]] = {}
    for name in units:
        match = _WHEEL.fullmatch(name)
        if match is not None and f"{match[1]}.{match[2]}.Y" in units:
            axles[match[1]] = (*axles.get(match[1], ()), f"{match[1]}.{match[2]}")
    wheels = [wheel for both in axles.values() for wheel in both]
    bends = _ending(units, (_BEND,), "1/m")
    sensors = {
        name.rpartition(".")[0]: None
        for name, unit in units.items()
        if name.rpartition(".")[2] in DIRECTIONS and name.count(".") and unit == "m/s^2"
    }
    return Subjects(
        axles=axles,
        sensors=tuple(sensors),
        floors=tuple(
            s for s in sensors if f"{s}.lateral" in units and units.get(f"{s}.roll_rate") == "rad/s"
        ),
        worn=tuple(wheel for wheel in wheels if f"{wheel}.wear_number" in units),
        ways=_ending(units, _WAYS, "m"),
        speeds=_ending(units, (_SPEED,), "m/s"),
        bends=tuple(sorted(bends, key=lambda name: name.removesuffix(f".{_BEND}") in axles)),
        cants=tuple(f"{axle}.cant" for axle in axles if units.get(f"{axle}.cant") == "m"),
    )


def _ending(units: Mapping[str, str], words: Iterable[str], unit: str) -> tuple[str, ...]:
    wanted = set(words)
    return tuple(
        name for name, own in units.items() if own == unit and name.rpartition(".")[2] in wanted
    )
