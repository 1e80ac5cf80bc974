"""Build what a scenario runs, or a model by itself, ready to be derived."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from vehicledyn.analyses.preparation.road_runnable import RoadSubject
from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.analyses.preparation.system_runnable import SystemSubject
from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.files.scenario.sets import Scenario
from vehicledyn.files.scenario.target import Target
from vehicledyn.rail.track.track_set import TrackChoice
from vehicledyn.road.limits import limited, limited_system
from vehicledyn.road.manoeuvres.kinds.straight import Straight
from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre
from vehicledyn.road.patches.patch import FrictionPatch
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.road.tyres.tyre import Tyre
from vehicledyn.road.vehicle import RoadVehicle

if TYPE_CHECKING:
    from vehicledyn.files.building.road_choice import RoadChoice
    from vehicledyn.files.scenario.system_models import WrittenModel


def build_subject(target: Target) -> Subject:
    """Return what a scenario runs, or a model by itself.

    Raises
    ------
    InputError
        If the scenario lacks a part that it needs.
    """
    if target.written.is_vehicle:
        return RoadSubject(build_vehicle(target), manoeuvre_of(target))
    from vehicledyn.files.building.builders import BUILDERS

    return SystemSubject(limited_system(BUILDERS[target.written.kind].system(*_asked(target))))


def manoeuvre_of(target: Target) -> RoadManoeuvre:
    """Return the manoeuvre of a scenario; a model by itself goes straight."""
    chosen = target.choices
    manoeuvre = None if chosen is None else chosen.manoeuvre
    if manoeuvre is None:
        return Straight()
    if not isinstance(manoeuvre, RoadManoeuvre):
        words = f"manoeuvre '{manoeuvre.kind}' is not for a road vehicle"
        raise InputError(f"{target.origin}: {words}")
    return manoeuvre.placed(target.origin.parent)


def build_vehicle(target: Target) -> RoadVehicle:
    """Return the vehicle with its tyres on its road, steered by its manoeuvre, with its limits.

    Raises
    ------
    InputError
        If the scenario lacks a part that the vehicle needs, all missing parts at once.
    """
    from vehicledyn.files.building.builders import BUILDERS

    vehicle: RoadVehicle = BUILDERS[target.written.kind].vehicle(*_asked(target))
    manoeuvre = manoeuvre_of(target)
    return limited(manoeuvre.with_seat(manoeuvre.fit(vehicle)))


def build_tested(
    target: Target, test: RoadManoeuvre, patches: tuple[FrictionPatch, ...] = ()
) -> RoadSubject:
    """Return the vehicle of a target on free wheels in another manoeuvre than its own.

    ``patches`` lie over those of its road.

    Raises
    ------
    InputError
        If the scenario lacks a part that the vehicle needs.
    """
    from vehicledyn.files.building.builders import BUILDERS
    from vehicledyn.files.building.road_choice import RoadChoice

    written, choice = _asked(target)
    if choice is None and patches and written.kind == "system":
        choice = RoadChoice()
    free = None if choice is None else replace(choice, free_wheels=True, patches=patches)
    vehicle: RoadVehicle = BUILDERS[written.kind].vehicle(written, free)
    if not vehicle.free_wheels:
        raise InputError(
            f"{target.origin}: by itself its wheels turn at a given rate; driving tests need "
            "'wheel_spin: free': name a scenario of it that chooses tyres and road"
        )
    return RoadSubject(limited(test.fit(vehicle)), test)


def _asked(target: Target) -> tuple[WrittenModel, RoadChoice | None]:
    """Return the model and what a scenario chooses for it."""
    chosen = target.choices
    return target.written, None if chosen is None else _choice(target, chosen)


def _choice(target: Target, s: Scenario) -> RoadChoice:
    """Return what a scenario chooses for the wheels of a system file."""
    from vehicledyn.files.building.road_choice import RoadChoice

    problems = manoeuvre_of(target).problems(free_wheels=s.wheel_spin != "prescribed")
    if problems:
        raise InputError("\n".join(f"{target.origin}: manoeuvre: {text}" for text in problems))
    return RoadChoice(
        front_tyre=_tyre(target, s, "front"),
        rear_tyre=_tyre(target, s, "rear"),
        surface=_road(target, s),
        patches=manoeuvre_of(target).patches(),
        free_wheels=s.wheel_spin != "prescribed",
        speed=s.speed or 0.0,
        contact=s.contact or "disc",
        relaxation=s.relaxation,
        track=s.track.track(target.origin.parent) if isinstance(s.track, TrackChoice) else None,
        creep=s.creep,
        rail_contact=s.rail_contact,
    )


def _tyre(target: Target, s: Scenario, axle: str) -> ParameterSet | None:
    """Return the tyre of an axle, its file looked for beside the scenario."""
    tyre = None if s.tyres is None else getattr(s.tyres, axle)
    return tyre.placed(target.origin.parent) if isinstance(tyre, Tyre) else tyre


def _road(target: Target, s: Scenario) -> ParameterSet | None:
    return s.road.placed(target.origin.parent) if isinstance(s.road, RoadSurface) else s.road
