"""Build the wheels on a road that a system file describes."""

from __future__ import annotations

from collections.abc import Iterator

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.files.building.values import Values
from vehicledyn.files.system.sets import WheelSet
from vehicledyn.multibody.elements.drives import ConstantRate
from vehicledyn.multibody.model.parts import Part
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.road.tyres.tyre import Tyre
from vehicledyn.road.wheel.contact_tread import Tread
from vehicledyn.road.wheel.road_wheel import RoadWheel


def wheel_parts(values: Values) -> list[Part]:
    """Return the wheels of a system on a road, and what turns them where they are not free.

    Raises
    ------
    InputError
        If neither file nor choice give them tyres and a road.
    """
    wheels = values.model.file.wheels
    if not wheels:
        return []
    surface = surface_numbers(values)
    chosen = {"front": values.choice.front_tyre, "rear": values.choice.rear_tyre}
    _need_road(values, surface, chosen)
    speed = values.table.add("speed", values.choice.speed, "m/s", "Forward speed at the start")
    values.symbols["speed"] = speed
    road = None if surface is None else values.table.add_set("road", surface)
    tyres = {
        axle: None if tyre is None else values.table.add_set(f"tyres.{axle}", tyre)
        for axle, tyre in chosen.items()
    }
    relaxation = values.choice.relaxation
    relaxed = None if relaxation is None else values.table.add_set("relaxation", relaxation)
    parts: list[Part] = []
    for name, wheel in wheels.items():
        own = wheel.tyre
        tyre = tyres[wheel.axle]
        if tyre is None and own is not None:
            placed = own.placed(values.model.path.parent) if isinstance(own, Tyre) else own
            tyre = values.table.add_set(f"{name}.tyre", placed)
        if isinstance(tyre, Tyre):
            tyre = tyre.mounted(wheel.side or "middle")
        part = RoadWheel(
            name,
            body=wheel.body,
            spin=spin_of(values, wheel),
            tyre=tyre,  # type: ignore[arg-type]
            surface=road,  # type: ignore[arg-type]
            radius=values.value(wheel.radius),
            stiffness=values.value(wheel.stiffness),
            damping=values.value(wheel.damping),
            contact=values.choice.contact,
            relaxation=relaxed,  # type: ignore[arg-type]
            slips_at=wheel.slips_at,
            crown=None if wheel.crown is None else values.value(wheel.crown),
            tread=None if wheel.width is None else Tread(values.value(wheel.width), wheel.strips),
        )
        parts.append(part)
        if not values.choice.free_wheels:
            rate = speed / values.value(wheel.radius)
            parts.append(ConstantRate(f"{name}.prescribed_spin", part.spin, rate))
    return parts


def spin_of(values: Values, wheel: WheelSet) -> str:
    """Return the coordinate that a wheel spins by."""
    coordinates = values.model.file.bodies[wheel.body].coordinates(wheel.body)
    if not coordinates or coordinates[-1].type.turns_about is None:
        raise InputError(
            f"{values.model.path}: bodies.{wheel.body}: the last joint of a wheel must be R2"
        )
    return coordinates[-1].name


def surface_numbers(values: Values) -> ParameterSet | None:
    """Return the road with numbers."""
    choice = values.choice
    if choice.surface is not None:
        return choice.laid(choice.surface)
    road = values.model.file.road
    placed = road.placed(values.model.path.parent) if isinstance(road, RoadSurface) else road
    return choice.laid(placed)


def _need_road(
    values: Values, surface: ParameterSet | None, chosen: dict[str, ParameterSet | None]
) -> None:
    wheels = values.model.file.wheels
    problems = []
    if surface is None:
        problems.append("road: missing: the system has wheels, give it a road")
    for name, wheel in wheels.items():
        problems += _tread_problems(values, name, wheel)
        problems += _moment_problems(values, name, wheel, chosen[wheel.axle])
    problems += [
        f"wheels.{name}.tyre: missing: give the wheel a tyre, or the scenario 'tyres'"
        for name, wheel in wheels.items()
        if wheel.tyre is None and chosen[wheel.axle] is None
    ]
    if problems:
        raise InputError("\n".join(f"{values.model.path}: {problem}" for problem in problems))


def _tread_problems(values: Values, name: str, wheel: WheelSet) -> Iterator[str]:
    """Yield what is wrong with the tread of a wheel across it."""
    shapes = [field for field in ("crown", "width") if getattr(wheel, field) is not None]
    if len(shapes) > 1:
        yield f"wheels.{name}.width: a tread is round by its crown or flat; give one of them"
    for field in shapes:
        if values.choice.contact != "disc":
            yield (
                f"wheels.{name}.{field}: the contact '{values.choice.contact}' is that of a thin "
                f"disc; choose contact 'disc', or leave the {field} out"
            )
    if wheel.crown is not None and values.number(wheel.crown) > values.number(wheel.radius):
        yield f"wheels.{name}.crown: a tread's radius across the wheel is at most the wheel's"


def _moment_problems(
    values: Values, name: str, wheel: WheelSet, chosen: ParameterSet | None
) -> Iterator[str]:
    """Yield whether the moment of a load that moves across the tread would count twice."""
    shape = next((f for f in ("crown", "width") if getattr(wheel, f) is not None), None)
    tyre = chosen
    if tyre is None and isinstance(wheel.tyre, Tyre):
        tyre = wheel.tyre.placed(values.model.path.parent)
    if shape is not None and isinstance(tyre, Tyre) and tyre.has_overturning_moment:
        yield (
            f"wheels.{name}.{shape}: the tyre has an overturning moment of its own, that of a load "
            f"that moves across the tread; leave the {shape} out, or give the tyre "
            "'scaling: {LMX: 0}'"
        )
