"""A system without manoeuvre as a thing to run."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

from vehicledyn.analyse.periodic.invariance import mattering_states
from vehicledyn.analyses.preparation.energy_figures import (
    ENERGIES,
    POWER,
    energy_error,
    ranges,
)
from vehicledyn.analyses.preparation.ports import Ports
from vehicledyn.analyses.preparation.runnable import Vector, start_values
from vehicledyn.analyses.preparation.seat_figures import seat_channels, seat_figures
from vehicledyn.analyses.preparation.time_jumps import time_jumps
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.parts import Part
from vehicledyn.multibody.model.system import System
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.symbolic.equations import Attitude, Channel, Equations

if TYPE_CHECKING:
    from vehicledyn.base.shapes import Shape
    from vehicledyn.results.store.layout import SceneItem, SummaryEntry
    from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre

ROLLING = ("T1", "R2")
"""Joints along which wheels on rails move when they run steadily."""

SETTLING = 2e-5
"""Step in which wheels are let down on their rails, a part of their approach [m or rad]."""

MOST_COORDINATES = 12
"""Coordinates whose ranges the summary gives."""

_MOST_PATHS = 3
_FORCE_UNITS = ("N", "N*m")
_SHOWN_IN = {"rad": "deg", "rad/s": "deg/s"}
_GAP, _OPENING = "constraints.position_error", "constraints.velocity_error"


@dataclass(frozen=True)
class SystemSubject:
    """A system that starts where its own start values assemble to."""

    system: System
    usual_start: str = "nominal"
    balance_time: float = 0.0

    @property
    def ports(self) -> Ports:
        """None of the ports of a vehicle in a manoeuvre."""
        return Ports()

    def with_system(self, system: System) -> Self:
        """Return the same with another system."""
        return replace(self, system=system)

    def in_manoeuvre(self, _: RoadManoeuvre) -> Self:
        """Return the same; it drives none."""
        return self

    @property
    def settling(self) -> float | None:
        """Step in which wheels on rails are let down until their contacts carry [m or rad]."""
        return SETTLING if self._any("settles_on_rails") else None

    @property
    def given_rates(self) -> dict[str, float]:
        """Rates other than zero that joints start with."""
        return {j.name: j.start_rate for j in self.system.joints() if j.start_rate != 0.0}

    def parameters_at(self, speed: float) -> dict[str, float]:
        """Return the speed where wheels are prescribed by it."""
        known = any(entry.name == "speed" for entry in self.system.table.entries)
        return {"speed": speed} if known and speed > 0.0 else {}

    def start_state(self, equations: Equations, speed: float) -> Vector:
        """Return the start values of the system."""
        return start_values(equations)

    def still_state(self, equations: Equations) -> Vector:
        """Return the start values with all velocities zero; on rails rolling along goes on."""
        state = start_values(equations)
        kinds = {j.name: j.kind for j in self.system.joints()}
        for position, velocity in zip(equations.positions, equations.velocities, strict=True):
            if not (self._rolls and kinds[equations.states[position].name] in ROLLING):
                state[velocity] = 0.0
        for attitude in equations.attitudes:
            state[list(attitude.velocity)] = 0.0
        return state

    def balance_pairs(self, equations: Equations, speed: float) -> tuple[list[int], list[int]]:
        """Return all coordinates with their accelerations, and all further states.

        Coordinates whose rates follow from others, as those of a rolling wheel, are held. Of a
        turn that makes no difference to what rolls on rails the rate takes its place, of a way
        nothing does. A quaternion is turned by the components but the largest at its start.
        """
        e = equations
        taken = {*e.positions, *e.velocities}
        held = {joint.name for joint in self.system.joints()}
        further = [
            k for k, state in enumerate(e.states) if k not in taken and state.name not in held
        ]
        pairs = list(zip(e.positions, e.velocities, strict=True))
        if self._rolls:
            matter = set(mattering_states(e))
            pairs = [
                (position if position in matter else velocity, velocity)
                for position, velocity in pairs
                if position in matter or e.states[position].unit == "rad"
            ]
            further = [k for k in further if k in matter]
        pairs += [
            pair
            for attitude in e.attitudes
            for pair in zip(_turning(e, attitude), attitude.velocity, strict=True)
        ]
        return [*(free for free, _ in pairs), *further], [*(rate for _, rate in pairs), *further]

    @property
    def _rolls(self) -> bool:
        return self._any("rolls_on_rails")

    def _any(self, quality: str) -> bool:
        return any(getattr(part, quality, False) for part in self.system.parts)

    def scene(self) -> dict[str, SceneItem]:
        """Return nothing."""
        return {}

    def shapes(self) -> tuple[Shape, ...]:
        """Return nothing."""
        return ()

    def plots(self, channels: Sequence[Channel]) -> list[dict[str, Any]]:
        """Return paths over the ground, coordinates, rates, forces and energies against time.

        Those of a vehicle on rails begin with its wheel forces and how its axles run.
        """
        names = [j.name for j in self.system.joints()]
        by_name = {c.name: c for c in channels}
        rails: list[dict[str, Any]] = []
        if self._rolls:
            from vehicledyn.analyses.preparation.rail_figures import is_of_rails, rail_figures

            rails = list(rail_figures({name: c.unit for name, c in by_name.items()}))
            drawn = {n for figure in rails for panel in figure["panels"] for n in panel["channels"]}
            by_name = {n: c for n, c in by_name.items() if n not in drawn and not is_of_rails(n)}
        coordinates = [by_name[n] for n in names if n in by_name]
        rates = [by_name[f"{n}_rate"] for n in names if f"{n}_rate" in by_name]
        energies = [by_name[n] for n in ENERGIES if n in by_name]
        forces = [c for c in by_name.values() if c.unit in _FORCE_UNITS]
        figures = [
            _figure("coordinates", "Coordinates", "Coordinate", coordinates),
            _figure("rates", "Rates of the coordinates", "Rate", rates),
            _figure("forces", "Forces", "Force", forces),
            _figure("energy", "Energy", "Energy", energies),
        ]
        known = {channel.name for channel in channels}
        return [*rails, *self._paths(known), *(figure for figure in figures if figure["panels"])]

    def _paths(self, known: set[str]) -> Iterator[dict[str, Any]]:
        """Yield the paths of bodies that slide along x and y of the ground."""
        found = []
        for body in self.system.bodies:
            sliding = [j.name for j in body.joints[:2] if isinstance(j, Joint)]
            kinds = [j.kind for j in body.joints[:2] if isinstance(j, Joint)]
            if body.parent == GROUND and kinds == ["T1", "T2"] and known.issuperset(sliding):
                found.append((body.name, *sliding))
        for name, x, y in found[:_MOST_PATHS]:
            title = f"Path of {name}, seen from above"
            yield {"name": f"path_{name}", "title": title, "kind": "path", "x": x, "y": y}

    def channels(self, equations: Equations) -> list[str]:
        """Return the channels that the summary is made from."""
        units = {c.name: c.unit for c in equations.channels}
        wanted = [*self._coordinates(set(units)), _GAP, _OPENING, *ENERGIES, POWER]
        wanted += [f"{part.name}.angle_of_attack" for part in self._elastic_wheels()]
        wanted += seat_channels(self.system)
        return [*(name for name in wanted if name in units), *_assessed(units, wanted)]

    def summarise(self, recording: Recording) -> list[SummaryEntry]:
        """Return ranges of coordinates, errors of loops and energy, the assessments."""
        return [
            *self._general(recording),
            *_assessment(recording),
            *self._contact(recording),
            *seat_figures(self.system, recording),
        ]

    def _elastic_wheels(self) -> list[Part]:
        return [part for part in self.system.parts if getattr(part, "settles_on_rails", False)]

    def _contact(self, recording: Recording) -> Iterator[SummaryEntry]:
        """Yield what is to be said of contacts of elastic wheels."""
        wheels = self._elastic_wheels()
        if not wheels:
            return
        from vehicledyn.rail.contact.attack_remarks import attack_remarks
        from vehicledyn.results.store.layout import SummaryEntry

        names = [f"{part.name}.angle_of_attack" for part in wheels]
        lows, highs = ranges(recording, [name for name in names if name in recording.channels])
        extremes = {name: [lows[name], highs[name]] for name in lows}
        remarks = "; ".join(attack_remarks(wheels, extremes))
        if remarks:
            yield SummaryEntry("contact_remarks", remarks, "", "")

    def _general(self, recording: Recording) -> list[SummaryEntry]:
        from vehicledyn.results.store.layout import SummaryEntry

        known = set(recording.channels)
        units = {j.name: j.unit for j in self.system.joints()}
        coordinates = self._coordinates(known)
        lows, highs = ranges(recording, [*coordinates, *known.intersection((_GAP, _OPENING))])
        entries = []
        for name in coordinates:
            low, high, text = lows[name], highs[name], f"value of {name}"
            entries.append(SummaryEntry(f"{name}.smallest", low, units[name], f"Smallest {text}"))
            entries.append(SummaryEntry(f"{name}.largest", high, units[name], f"Largest {text}"))
        for name, key, unit, text in (
            (_GAP, "largest_loop_gap", "m", "Largest position error of a constraint"),
            (_OPENING, "largest_loop_speed", "m/s", "Largest velocity error of a constraint"),
        ):
            if name in known:
                entries.append(SummaryEntry(key, highs[name], unit, text))
        if any(getattr(part, "changes_motion", False) for part in self.system.parts):
            return entries  # Impacts take energy that no force is seen to take.
        ends = [recording.rows((), k, k + 1).time[0] for k in (0, recording.count - 1)]
        jumps = time_jumps(self.system, *map(float, ends))
        return [*entries, *energy_error(recording, jumps)]

    def _coordinates(self, known: set[str]) -> list[str]:
        names = [j.name for j in self.system.joints()]
        return [n for n in names if n in known] if len(names) <= MOST_COORDINATES else []


def _turning(equations: Equations, attitude: Attitude) -> list[int]:
    """Return the three components of a quaternion whose changes turn it in every direction."""
    largest = max(attitude.quaternion, key=lambda k: abs(equations.states[k].start))
    return [k for k in attitude.quaternion if k != largest]


def _assessed(units: dict[str, str], others: Collection[str]) -> list[str]:
    """Return the further channels that the assessment of a vehicle on rails reads."""
    from vehicledyn.results.assessment.subjects import find_subjects

    subjects = find_subjects(units)
    names = subjects.channels(units) if subjects.axles else []
    return [name for name in names if name not in others]


def _assessment(recording: Recording) -> list[SummaryEntry]:
    """Return the worst figures of running safety, comfort and wear of a vehicle on rails."""
    from vehicledyn.results.assessment.subjects import find_subjects

    if not find_subjects(recording.units).axles or recording.count < 2:
        return []
    from vehicledyn.results.assessment.assess import assess
    from vehicledyn.results.assessment.summary import summarise_assessment

    columns = {name: recording.column(name) for name in recording.channels}
    return summarise_assessment(assess(recording.column("time"), columns, recording.units))


def _figure(name: str, title: str, label: str, channels: list[Channel]) -> dict[str, Any]:
    """Return a figure with one panel a unit, to be arranged when it is drawn."""
    by_unit: dict[str, list[str]] = {}
    for channel in channels:
        by_unit.setdefault(channel.unit, []).append(channel.name)
    panels = [
        {"label": label, "unit": _SHOWN_IN.get(unit, unit), "channels": names}
        for unit, names in by_unit.items()
    ]
    return {"name": name, "title": title, "kind": "time", "arranged": True, "panels": panels}
