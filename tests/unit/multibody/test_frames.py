"""Vectors of different axes do not join silently while parts write their equations."""

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
from vehicledyn.multibody.model.constraints import UserConstraint
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import labels, ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.frames import WORLD, FrameError, axes_label, axes_of
from vehicledyn.symbolic.labels import in_axes, turning

UP = ops.vector(0.0, 0.0, 1.0)


@dataclass(frozen=True)
class OwnElement(BasePart):
    """An element as a user writes it; ``write`` is what is wrong with it."""

    body: str
    write: object

    def loads(self, situation: Situation) -> Loads:
        force = self.write(situation.kinematics, self.body)
        return Loads(wrenches=(Wrench(self.body, force, ops.vector(0.0, 0.0, 0.0)),))


@dataclass(frozen=True)
class OwnSensor(BasePart):
    body: str

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        kinematics = situation.kinematics
        wrong = kinematics.velocity(self.body) + kinematics.angular_velocity(self.body)
        return (Output(Channel(f"{self.name}.sum", "1", "Nonsense"), wrong[0]),)


def system(*parts):
    joints = (Joint("T1", "x"), Joint("R3", "yaw"))
    body = Body("car", GROUND, joints=joints, mass=2.0, inertia=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
    rod = Body(
        "rod", "car", joints=(Joint("R2", "pitch"),), mass=1.0, inertia=(1.0,) * 3 + (0.0,) * 3
    )
    return System("car and rod", ParameterTable(), (body, rod), parts=parts)


def forward(kinematics, body):
    return kinematics.rotation(body).T @ kinematics.velocity(body)


WRONG = {
    "world force on a body": (
        lambda k, b: -5.0 * k.velocity(b),
        "part 'own': the force on body 'car' is given in the axes of the world, but belongs into "
        "those of body 'car'; turn it there first",
    ),
    "sum of velocity and turning": (
        lambda k, b: k.velocity(b) - k.angular_velocity(b),
        "part 'own': a vector in the axes of the world and one in the axes of body 'car' are "
        "subtracted from each other; turn one of them first",
    ),
    "turned the wrong way": (
        lambda k, b: k.rotation(b) @ k.velocity(b),
        "part 'own': a rotation from the axes of body 'car' to those of the world is applied to "
        "what is given in the axes of the world",
    ),
    "another body's axes": (
        lambda k, b: k.rotation("rod").T @ k.velocity(b),
        "given in the axes of body 'rod', but belongs into those of body 'car'",
    ),
    "cross product": (
        lambda k, b: ops.cross(k.angular_velocity(b), k.velocity(b)),
        "are multiplied by a cross product",
    ),
    "scalar product": (
        lambda k, b: UP * ops.dot(k.angular_velocity(b), k.position(b)),
        "are multiplied; turn",
    ),
    "a point in the world": (
        lambda k, b: forward(k, b) + k.rotation(b).T @ k.velocity(b, k.position("rod")),
        "a point of body 'car' is given in the axes of the world",
    ),
}


@pytest.mark.parametrize("write, words", WRONG.values(), ids=WRONG)
def test_a_mismatch_in_an_own_element_names_the_element_and_the_axes(write, words):
    with pytest.raises(InputError) as caught:
        derive(system(OwnElement("own", "car", write)))
    text = str(caught.value)
    assert words in text
    assert text.startswith("part 'own': ")
    assert "\n" not in text
    assert caught.value.about == ("own",)


def test_a_mismatch_in_a_channel_names_the_element():
    with pytest.raises(InputError, match=r"part 'meter': a vector in the axes of the world and"):
        derive(system(OwnSensor("meter", "car")))


def test_what_is_right_gives_the_same_equations_as_without_labels(monkeypatch):
    """And labels are gone from them."""

    def drag(kinematics, body):
        ahead = kinematics.rotation(body).T @ kinematics.velocity(body)
        swing = ops.cross(kinematics.angular_velocity(body), ops.vector(0.3, 0.0, 0.0))
        tip = kinematics.position(body) + kinematics.rotation(body) @ ops.vector(0.5, 0.0, 0.0)
        lever = kinematics.rotation(body).T @ (tip - kinematics.position("rod"))
        return -(2.0 * ahead + swing) / 3.0 - lever * 0.5

    labelled = derive(system(OwnElement("own", "car", drag)))
    monkeypatch.setattr(labels, "in_axes", lambda vector, axes: vector)
    monkeypatch.setattr(labels, "turning", lambda rotation, to, of: rotation)
    bare = derive(system(OwnElement("own", "car", drag)))
    assert type(labelled.rate) is ca.SX
    values = []
    for equations in (labelled, bare):
        given = [equations.time, equations.state, equations.algebraic, equations.parameter]
        function = ca.Function("rates", given, [equations.rate])
        values.append(
            np.array(function(0.0, np.linspace(0.1, 0.7, equations.state.numel()), 0, []))
        )
        values.append(function.n_instructions())
    assert np.array_equal(values[0], values[2])
    assert values[1] == values[3]


def test_labels_follow_operations():
    rotation = turning(ca.SX.sym("r", 3, 3), to=WORLD, of="body 'a'")
    own, world = in_axes(ca.SX.sym("v", 3), "body 'a'"), in_axes(ca.SX.sym("w", 3), WORLD)
    scale = ca.SX.sym("s")
    assert axes_label(rotation @ own) == axes_label(rotation[:, 1]) == WORLD
    assert axes_label(rotation.T @ world) == "body 'a'"
    sums = [UP + world, world - UP, UP - world, ops.cross(UP, world), ops.cross(world, world)]
    for kept in (2.0 * world, world * scale, scale * world, world / scale, -world, *sums):
        assert axes_label(kept) == WORLD
    between = turning(ca.SX.sym("q", 3, 3), to=WORLD, of="body 'b'").T @ rotation
    assert (between.to, between.of) == ("body 'b'", "body 'a'")
    assert axes_label(UP) is axes_label(world[0]) is None
    for wrong in (
        lambda: own + world,
        lambda: world - own,
        lambda: rotation @ world,
        lambda: rotation @ rotation,
        lambda: ops.dot(own, world),
    ):
        with pytest.raises(FrameError):
            wrong()


@dataclass(frozen=True)
class Listener(BasePart):
    """Notes the axes of all vectors that a part may ask for."""

    heard: dict

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        kinematics, forces = situation.kinematics, situation.forces
        for name in ("position", "velocity", "acceleration"):
            self.heard[name] = getattr(kinematics, name)("rod")
        for name in ("angular_velocity", "angular_acceleration"):
            self.heard[f"own {name}"] = getattr(kinematics, name)("rod")
        if forces is not None:
            self.heard["gravity"] = forces.gravity
            for name, wrench in (("reaction", forces.reaction("rod")),
                                 ("exerted", forces.exerted("held", "rod"))):  # fmt: skip
                self.heard[f"own {name} force"] = wrench.force
                self.heard[f"own {name} torque"] = wrench.torque
        return ()


def test_every_vector_that_a_part_is_given_knows_its_axes():
    heard = {}
    held = UserConstraint("held", lambda geometry: geometry.position("rod", (1.0, 0.0, 0.0))[2])
    derive(replace(system(Listener("listener", heard)), constraints=(held,)))
    assert len(heard) == 10
    for name, vector in heard.items():
        assert axes_label(vector) == (axes_of("rod") if name.startswith("own") else WORLD), name
