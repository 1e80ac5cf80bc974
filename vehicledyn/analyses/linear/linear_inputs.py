"""Put inputs into a model: each becomes a part, a moved drive or a lifted road."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from vehicledyn.analyses.linear.input_names import (
    COMPONENTS,
    PROFILE,
    ROAD,
    STEERING,
    WHEEL_ANGLE,
    InputPart,
    ModelInput,
    hint,
    joint_of,
    known_inputs,
    wheels_of,
)
from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.base.argument_names import given
from vehicledyn.base.errors import InputError
from vehicledyn.multibody.elements.coordinate_forces import CoordinateForce
from vehicledyn.multibody.elements.drives import TimeLaw
from vehicledyn.multibody.elements.excitation import HeldDrive, MovedDrive, SmallInput, SmallLoad
from vehicledyn.multibody.elements.external_wrenches import ExternalWrench
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.parts import Clock, Part
from vehicledyn.multibody.model.system import System
from vehicledyn.road.surfaces.raised import raised
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

PREFIX = "input"
THRUST = f"{PREFIX}.thrust"

_ZERO = (0.0, 0.0, 0.0)
_WRENCH = re.compile(
    r"(?P<body>.{1,500})\.(?P<word>force|torque)_(?P<axis>[xyz])(?:@(?P<point>.+))?$"
)


@dataclass
class Excited:
    """A subject that takes up inputs one after the other; drives it moves stand still."""

    subject: Subject
    inputs: list[ModelInput] = field(default_factory=list)

    @property
    def system(self) -> System:
        """The system as it is now."""
        return self.subject.system

    def add(self, name: str) -> None:
        """Take up an input.

        Raises
        ------
        InputError
            If the model has no such input; says which there are.
        """
        kind, colon, rest = name.partition(":")
        makers: dict[str, Callable[[str, str], ModelInput]] = {
            "force": self._force,
            "wrench": self._wrench,
            "parameter": self._parameter,
            "motion": self._motion,
            ROAD: self._road,
        }
        if colon and kind in makers:
            self.inputs.append(makers[kind](name, rest))
        else:
            self.inputs.append(self._plain(name))

    def _plain(self, name: str) -> ModelInput:
        """Return the input of a name that says itself what it is."""
        own = self._of_port(name) or self._of_part(name)
        if own is not None:
            return own
        if name == ROAD:
            return self._road(name, "")
        if _WRENCH.match(name):
            return self._wrench(name, name)
        if any(joint.name == name for joint in self.system.joints()):
            return self._motion(name, name)
        if any(entry.name == name for entry in self.system.table.entries):
            return self._parameter(name, name)
        known = known_inputs(self.subject)
        raise InputError(
            f"{given('inputs', name)}: the model has no such input{hint(name, known)}; "
            "and force:COORDINATE, wrench:BODY.force_x, parameter:NAME"
        )

    def add_thrust(self) -> None:
        """Let a force along the body that runs along a road hold the speed, a parameter."""
        body = self.subject.ports.body
        if not body:
            return
        thrust = self.system.table.add(THRUST, 0.0, "N", "Force that holds the speed")
        load = ExternalWrench(THRUST, body, force=lambda _: (thrust, 0.0, 0.0), axes="body")
        self._change_parts([*self.system.parts, SmallLoad(THRUST, load)])

    def _of_port(self, name: str) -> ModelInput | None:
        """Return an input of the port that steers the model, or of a road it runs over."""
        ports = self.subject.ports
        if name == PROFILE and ports.speed is not None:
            return self._profile(name, ports.speed)
        if name == STEERING and ports.steering:
            return self._motion(name, ports.steering)
        if name == WHEEL_ANGLE and ports.steering:
            part = self._motion(name, ports.steering).parts[0]
            text = "Angle of the front wheels that the rack nominally gives, to the left"
            return ModelInput(name, "rad", text, (replace(part, gain=1.0 / ports.steering_gain),))
        return None

    def _of_part(self, name: str) -> ModelInput | None:
        """Return the input that a drive or a force of this name is."""
        for part in self.system.parts:
            if part.name == name and isinstance(part, TimeLaw | HeldDrive):
                return self._motion(name, part.coordinate)
            if part.name == name and isinstance(part, CoordinateForce):
                return self._force(name, part.coordinate)
        return None

    def _signal(self, unit: str, suffix: str = "") -> SmallInput:
        name = f"{PREFIX}.{len(self.inputs) + 1}{suffix}"
        return SmallInput.enter(self.system.table, name, unit)

    def _motion(self, name: str, coordinate: str) -> ModelInput:
        joint = joint_of(self.system, name, coordinate)
        if joint.role != "driven":
            raise InputError(
                f"{given('inputs', name)}: '{coordinate}' is free, nothing drives it; use "
                f"'force:{coordinate}', or drive it ('role: driven' in its joint)"
            )
        signal = self._signal(joint.unit)
        self._change_parts(self._moved(joint, signal))
        text = f"Motion of {joint.description or coordinate}"
        return ModelInput(name, joint.unit, text, (InputPart(signal.names),))

    def _moved(self, joint: Joint, signal: SmallInput) -> list[Part]:
        """Return the parts with the one that drives a coordinate moved by a signal."""
        time = self.subject.balance_time
        parts: list[Part] = []
        found = False
        for part in self.system.parts:
            states = {v.name: ops.symbol(v.name) for v in part.states()}
            if joint.name not in part.motions(Clock(ops.symbol("time"), states)):
                parts.append(part)
                continue
            found = True
            if isinstance(part, TimeLaw):
                held = part.law(ops.scalar(time))
                parts.append(HeldDrive(part.name, joint.name, held, signal))
            else:
                parts.append(MovedDrive(part, joint.name, signal))
        if not found:
            parts.append(HeldDrive(signal.names[0], joint.name, joint.start, signal))
        return parts

    def _force(self, name: str, coordinate: str) -> ModelInput:
        joint = joint_of(self.system, name, coordinate)
        unit = joint.force_unit
        signal = self._signal(unit)
        force = CoordinateForce(signal.names[0], coordinate, lambda _: signal.value, unit)
        self._change_parts([*self.system.parts, SmallLoad(signal.names[0], force)])
        what = "Torque" if joint.unit == "rad" else "Force"
        text = f"{what} on {joint.description or coordinate}"
        return ModelInput(name, unit, text, (InputPart(signal.names[:1]),))

    def _wrench(self, name: str, text: str) -> ModelInput:
        match = _WRENCH.match(text)
        if match is None:
            raise InputError(
                f"{given('inputs', name)}: write wrench:BODY.COMPONENT, with a point of the "
                "body if it is "
                f"not the origin, such as wrench:chassis.force_y@0.5,0,0; components: "
                f"{', '.join(COMPONENTS)}"
            )
        owner, word, axis = match["body"], match["word"], match["axis"]
        unit = "N" if word == "force" else "N*m"
        signal = self._signal(unit)
        vector = tuple(signal.value if letter == axis else 0.0 for letter in "xyz")
        force, torque = (vector, _ZERO) if word == "force" else (_ZERO, vector)
        load = replace(
            self._wrench_at(name, owner, match["point"]),
            name=signal.names[0],
            force=lambda _: force,
            torque=lambda _: torque,
        )
        self._change_parts([*self.system.parts, SmallLoad(signal.names[0], load)])
        words = f"{word.capitalize()} on {load.body} along {axis}, {load.axes} axes"
        return ModelInput(name, unit, words, (InputPart(signal.names[:1]),))

    def _wrench_at(self, name: str, owner: str, point: str | None) -> ExternalWrench:
        """Return the wrench that a name means: one of the system's own, or one at a body."""
        for part in self.system.parts:
            if part.name == owner and isinstance(part, ExternalWrench):
                return part
        bodies = [body.name for body in self.system.bodies]
        if owner not in bodies:
            raise InputError(
                f"{given('inputs', name)}: there is no body '{owner}'{hint(owner, bodies)}"
            )
        place = (0.0, 0.0, 0.0)
        if point is not None:
            try:
                x, y, z = (float(text) for text in point.split(","))
            except ValueError:
                raise InputError(
                    f"{given('inputs', name)}: '@{point}' is no point; write three numbers in m, "
                    "such as @0.5,0,0"
                ) from None
            place = (x, y, z)
        return ExternalWrench("", owner, place)

    def _parameter(self, name: str, parameter: str) -> ModelInput:
        entries = {entry.name: entry for entry in self.system.table.entries}
        entries = {n: e for n, e in entries.items() if not n.startswith(f"{PREFIX}.")}
        if parameter not in entries:
            words = hint(parameter, list(entries))
            raise InputError(f"{given('inputs', name)}: there is no parameter '{parameter}'{words}")
        entry = entries[parameter]
        for body in self.system.bodies:
            turns = [ops.flat(item.rotation) for item in body.joints if not isinstance(item, Joint)]
            place = ops.column([*(ops.scalar(v) for v in body.at), *turns])
            if ops.depends_on(place, entry.symbol):
                raise InputError(
                    f"{given('inputs', name)}: the parameter moves body '{body.name}', "
                    "whose velocity "
                    "would not follow; put a joint of role 'driven' there and move that"
                )
        part = InputPart((parameter,))
        return ModelInput(name, entry.unit, entry.description, (part,), is_parameter=True)

    def _road(self, name: str, which: str) -> ModelInput:
        chosen = wheels_of(self.subject, name, which)
        signal = self._signal("m")
        self._change_parts(
            [
                _lifted(part, signal) if isinstance(part, RoadWheel) and part in chosen else part
                for part in self.system.parts
            ]
        )
        under = ", ".join(wheel.name for wheel in chosen)
        return ModelInput(
            name, "m", f"Height of the ground under {under}", (InputPart(signal.names),)
        )

    def _profile(self, name: str, speed: Scalar) -> ModelInput:
        """Return the height of a road that the vehicle runs over, wheel after wheel."""
        wheels = wheels_of(self.subject, name, "")
        signals = {wheel.name: self._signal("m", f".{wheel.name}") for wheel in wheels}
        self._change_parts(
            [
                _run_over(part, signals[part.name], speed) if isinstance(part, RoadWheel) else part
                for part in self.system.parts
            ]
        )
        parts = tuple(InputPart(s.names, wheel=wheel) for wheel, s in signals.items())
        text = "Height of a road that is run over, where the foremost wheel is"
        return ModelInput(name, "m", text, parts)

    def _change_parts(self, parts: Sequence[Part]) -> None:
        self.subject = self.subject.with_system(replace(self.system, parts=tuple(parts)))

    def _unknown(self, name: str) -> InputError:
        known = known_inputs(self.subject)
        return InputError(
            f"{given('inputs', name)}: the model has no such input{hint(name, known)} It has "
            f"{', '.join(known)}; any force:COORDINATE, wrench:BODY.force_x, parameter:NAME"
        )


def _lifted(wheel: RoadWheel, signal: SmallInput) -> RoadWheel:
    return replace(
        wheel,
        surface=raised(wheel.surface, signal.value),
        ground_rate=wheel.ground_rate + signal.rate,
    )


def _run_over(wheel: RoadWheel, signal: SmallInput, speed: Scalar) -> RoadWheel:
    """Return a wheel that runs over a signal: the ground slopes, it does not rise."""
    return replace(wheel, surface=raised(wheel.surface, signal.value, signal.rate / speed))
