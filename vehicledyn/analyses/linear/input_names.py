"""Inputs of a linearised model: what they are, and the names that a model has for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.base.argument_names import given
from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.multibody.elements.coordinate_forces import CoordinateForce
from vehicledyn.multibody.elements.external_wrenches import ExternalWrench
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.system import System
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.symbolic.ops import Scalar

STEERING, WHEEL_ANGLE, ROAD, PROFILE = "steering", "road_wheel_angle", "road", "profile"
MOST_TOLD = 40
COMPONENTS = tuple(f"{word}_{axis}" for word in ("force", "torque") for axis in "xyz")


@dataclass(frozen=True)
class InputPart:
    """One way by which an input enters: parameters for u, u̇, ü; a wheel feels it later.

    ``gain`` multiplies it, an expression of parameters; ``wheel`` is the one whose distance
    behind the first delays it.
    """

    parameters: tuple[str, ...]
    gain: Scalar = 1.0
    wheel: str = ""


@dataclass(frozen=True)
class ModelInput:
    """An input by the name it was asked by."""

    name: str
    unit: str
    description: str
    parts: tuple[InputPart, ...]
    is_parameter: bool = False


def known_inputs(subject: Subject) -> list[str]:
    """Return the inputs that have names of their own: driven coordinates, drives, roads."""
    system = subject.system
    known = [joint.name for joint in system.joints() if joint.role == "driven"]
    known += [part.name for part in system.parts if isinstance(part, CoordinateForce)]
    known += [
        f"{part.name}.{component}"
        for part in system.parts
        if isinstance(part, ExternalWrench)
        for component in COMPONENTS
    ]
    if subject.ports.steering:
        known += [STEERING, WHEEL_ANGLE, PROFILE]
    wheels = [part.name for part in system.parts if isinstance(part, RoadWheel)]
    return known + ([ROAD, *(f"{ROAD}:{wheel}" for wheel in wheels)] if wheels else [])


def wheels_of(subject: Subject, name: str, which: str) -> list[RoadWheel]:
    """Return the wheels that an input means: all, a group such as "front", or one by name.

    Raises
    ------
    InputError
        If there are no such wheels.
    """
    wheels = [part for part in subject.system.parts if isinstance(part, RoadWheel)]
    if not wheels:
        raise InputError(f"{given('inputs', name)}: the model has no wheels on a road")
    corners = subject.ports.wheels
    groups = {
        "": {w.name for w in wheels},
        "front": {c.name for c in corners if c.is_front},
        "rear": {c.name for c in corners if not c.is_front},
        "left": {c.name for c in corners if c.is_left},
        "right": {c.name for c in corners if not c.is_left},
        **{w.name: {w.name} for w in wheels},
    }
    if which not in groups or not groups[which]:
        known = [group for group, names in groups.items() if group and names]
        raise InputError(
            f"{given('inputs', name)}: there is no wheel '{which}'{hint(which, known)}"
        )
    return [wheel for wheel in wheels if wheel.name in groups[which]]


def joint_of(system: System, name: str, coordinate: str) -> Joint:
    """Return the joint of the coordinate that an input means.

    Raises
    ------
    InputError
        If there is no such coordinate.
    """
    joints = {joint.name: joint for joint in system.joints()}
    if coordinate not in joints:
        words = hint(coordinate, list(joints))
        raise InputError(f"{given('inputs', name)}: there is no coordinate '{coordinate}'{words}")
    return joints[coordinate]


def hint(name: str, known: Sequence[str]) -> str:
    """Return the end of a message on an unknown name: the nearest one, and all of them."""
    guess = nearest_name(name, known)
    near = f"; did you mean '{guess}'?" if guess else "."
    if len(known) > MOST_TOLD:
        return f"{near} It has {len(known)} of them; 'vehicledyn models show' lists them"
    return f"{near} Known: {', '.join(known)}"
