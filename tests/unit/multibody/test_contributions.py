"""Parts bring bodies, coordinates that couple in the mass matrix, constraints, states, events."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.base.errors import InputError
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import (
    GROUND,
    BallCut,
    BasePart,
    Body,
    Joint,
    Loads,
    Output,
    ParameterTable,
    PartEvent,
    System,
    UserConstraint,
    derive,
)
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable


class Seen:
    """Rates and channels of a system at a state."""

    def __init__(self, *bodies, parts=(), gravity=(0.0, 0.0, 0.0), cuts=()):
        made = System("s", ParameterTable(), bodies, parts=parts, gravity=gravity, cuts=cuts)
        self.equations = derive(made)
        self.kernel = compile_kernel(self.equations, backend="interpreted")

    def at(self, **states):
        e = self.equations
        named = {name.replace("__", "."): value for name, value in states.items()}
        assert set(named) <= {s.name for s in e.states}
        x = np.array([named.get(s.name, s.start) for s in e.states])
        z = assemble(self.kernel, 0.0, x, np.array([u.start for u in e.unknowns]))
        rates = dict(zip([s.name for s in e.states], self.kernel.rates(0.0, x, z), strict=True))
        channels = [c.name for c in e.channels]
        return rates, dict(zip(channels, self.kernel.outputs(0.0, x, z), strict=True))


def slide(name, axis=1, mass=2.0, parent=GROUND):
    joint = Joint(f"T{axis}", f"{name}.x")
    return Body(name, parent, joints=(joint,), mass=mass, inertia=(0.1, 0.1, 0.1))


@dataclass(frozen=True)
class ContactPatch(BasePart):
    """A mass that slides on a wheel against a spring: its coordinate couples with the wheel's."""

    wheel: str
    mass: float
    stiffness: float

    def added_bodies(self):
        joint = Joint("T1", f"{self.name}.slip", role="independent", description="Slip")
        return (Body(f"{self.name}.patch", self.wheel, joints=(joint,), mass=self.mass),)

    def loads(self, situation):
        place = situation.kinematics.coordinate(f"{self.name}.slip")
        return Loads(joint_forces={f"{self.name}.slip": -self.stiffness * place})


def test_a_brought_body_couples_in_the_mass_matrix():
    """Hub (m) and patch (p) on one line: p (x'' + s'') = -k s, (m + p) x'' + p s'' = 0."""
    hub, patch, k, s = 2.0, 0.5, 300.0, 0.01
    rates, _ = Seen(slide("hub"), parts=(ContactPatch("tyre", "hub", patch, k),)).at(tyre__slip=s)
    assert rates["hub.x_rate"] == pytest.approx(k * s / hub, rel=1e-12)
    expected = -k * s / patch - k * s / hub
    assert rates["tyre.slip_rate"] == pytest.approx(expected, rel=1e-12)


@dataclass(frozen=True)
class Cam(BasePart):
    """A follower rides on an eccentric, z = a cos φ, as long as the cam pushes it."""

    cam: str
    follower: str
    lift: float

    def added_constraints(self):
        def law(geometry):
            lifted = self.lift * ops.cos(geometry.coordinate(self.cam))
            return geometry.coordinate(self.follower) - lifted

        return (UserConstraint(f"{self.name}.contact", law),)

    def outputs(self, situation):
        push = situation.forces.multiplier(f"{self.name}.contact", "multiplier")
        return (Output(Channel(f"{self.name}.push", "N", "Force of the cam"), push),)

    def events(self, situation):
        height = situation.kinematics.coordinate(self.follower)
        return (PartEvent("low", height, "falling"),)


def test_a_brought_constraint_moves_a_follower():
    """J φ'' = λ a sin φ, m z'' = λ - m g, z = a cos φ."""
    a, angle, rate, inertia, mass, g = 0.02, 0.7, 30.0, 0.004, 0.3, 9.81
    shaft = Body(
        "shaft", GROUND, joints=(Joint("R1", "cam", role="independent"),), mass=1.0,
        inertia=(inertia,) * 3,
    )  # fmt: skip
    follower = Body("f", GROUND, joints=(Joint("T3", "z", role="dependent"),), mass=mass)
    seen = Seen(shaft, follower, parts=(Cam("cams", "cam", "z", a),), gravity=(0, 0, -g))
    rates, channels = seen.at(cam=angle, cam_rate=rate)
    push = np.array([[inertia, -a * np.sin(angle)], [-mass * a * np.sin(angle), -1.0]])
    right = np.array([0.0, mass * (a * np.cos(angle) * rate**2 - g)])
    turning, force = np.linalg.solve(push, right)
    assert rates["cam_rate"] == pytest.approx(turning, rel=1e-11)
    assert channels["cams.push"] == pytest.approx(force, rel=1e-11)
    assert channels["z"] == pytest.approx(a * np.cos(angle), rel=1e-12)
    assert [e.name for e in seen.equations.events] == ["cams.low"]


@dataclass(frozen=True)
class Actuator(BasePart):
    """A motor with a current of its own, L i' = U - R i - k v, F = k i."""

    coordinate: str

    def states(self):
        return (Variable("current", "A", "Current of the coil", 1.5),)

    def loads(self, situation):
        current = situation.states["current"]
        rate = (12.0 - 2.0 * current - 4.0 * situation.kinematics.rate(self.coordinate)) / 0.1
        return Loads(joint_forces={self.coordinate: 4.0 * current}, rates={"current": rate})


def test_an_actuator_has_a_state_of_its_own():
    rates, _ = Seen(slide("rod", mass=3.0), parts=(Actuator("motor", "rod.x"),)).at(rod__x_rate=0.5)
    assert rates["motor.current"] == pytest.approx((12.0 - 3.0 - 2.0) / 0.1, rel=1e-13)
    assert rates["rod.x_rate"] == pytest.approx(2.0, rel=1e-13)


@dataclass(frozen=True)
class Strut(BasePart):
    """A pendulum that a ball joint closes to the ground: a body, and a cut of its own."""

    def added_bodies(self):
        joints = tuple(Joint(f"T{k}", f"{self.name}.{c}") for k, c in ((1, "x"), (3, "z")))
        bob = Body(f"{self.name}.bob", GROUND, joints=joints, mass=1.0)
        arm = Joint("R2", f"{self.name}.angle", start=0.4, role="independent")
        return (bob, Body(f"{self.name}.arm", GROUND, joints=(arm,)))

    def added_cuts(self):
        ends = f"{self.name}.arm", (0.0, 0.0, -2.0), f"{self.name}.bob", (0.0, 0.0, 0.0)
        return (BallCut(f"{self.name}.pin", *ends),)


def test_a_brought_cut_closes_a_loop():
    rates, _ = Seen(parts=(Strut("s"),), gravity=(0, 0, -9.81)).at(s__angle=0.4)
    assert rates["s.angle_rate"] == pytest.approx(-9.81 / 2.0 * np.sin(0.4), rel=1e-11)


def test_what_is_brought_keeps_its_start_and_leaves_with_its_part():
    made = System("s", ParameterTable(), (slide("hub"),), parts=(ContactPatch("t", "hub", 1, 2),))
    assert [b.name for b in made.bodies] == ["hub", "t.patch"]
    again = made.with_starts({"t.slip": 0.3}).with_parts()
    assert [j.start for j in again.joints()] == [0.0, 0.3]
    assert [b.name for b in replace(again, parts=()).bodies] == ["hub"]
    load = slide("load", parent="t.patch")
    assert [b.name for b in replace(made, bodies=(load, *made.bodies)).bodies][-1] == "load"


def test_names_that_are_taken_are_refused():
    patch = ContactPatch("t", "hub", 1.0, 2.0)
    with pytest.raises(InputError, match=r"two parts bring a body 't\.patch'"):
        System("s", ParameterTable(), (slide("hub"),), parts=(patch, patch))
    with pytest.raises(InputError, match=r"brings a body 't\.patch', a name that is taken"):
        System("s", ParameterTable(), (slide("hub"), slide("t.patch")), parts=(patch,))
