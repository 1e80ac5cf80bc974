"""Events declared by parts of a system: their expressions, names and resets."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.special import ellipk

import vehicledyn.integrate  # noqa: F401
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import find
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import (
    GROUND,
    BasePart,
    Body,
    DrivenMotion,
    Joint,
    Loads,
    ParameterTable,
    PartEvent,
    System,
    UserConstraint,
    derive,
)
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Variable


@dataclass(frozen=True)
class Watcher(BasePart):
    """Declares the events that a function of the situation returns."""

    declare: object = None
    switches: tuple[str, ...] = ()

    def states(self):
        return tuple(Variable(name, "1", name) for name in self.switches)

    def loads(self, situation):
        return Loads(rates={name: ops.scalar(0.0) for name in self.switches})

    def events(self, situation):
        return tuple(self.declare(situation))


def pendulum(*parts, joints=(("R2", "swing", 0.5),)):
    bodies, parent = [], GROUND
    for kind, name, start in joints:
        joint = Joint(kind, name, start=start, role="driven" if name == "lift" else "auto")
        last = name == joints[-1][1]
        mass = {"mass": 1.0, "com": (0.0, 0.0, -1.0)} if last else {}
        inertia = (0.1, 0.1, 0.1) if last else None
        bodies.append(Body(f"{name}.body", parent, joints=(joint,), inertia=inertia, **mass))
        parent = bodies[-1].name
    return derive(System("pendulum", ParameterTable(), tuple(bodies), parts=parts))


def run(equations, stop, *, unknowns=False):
    kernel = compile_kernel(equations, backend="interpreted")
    events, samples = [], []
    simulate(
        kernel,
        find("solver", "dop853")(relative_tolerance=1e-11, absolute_tolerance=1e-11),
        start=0.0,
        stop=stop,
        interval=0.1,
        state=[s.start for s in equations.states],
        unknowns=[u.start for u in equations.unknowns],
        sink=lambda t, x, z, y: samples.extend(zip(t, z if unknowns else x, strict=True)),
        happened=lambda name, time: events.append((name, time)),
    )
    return events, samples


def bottom(situation):
    yield PartEvent("bottom", situation.kinematics.coordinate("swing"), "falling")


def test_pendulum_passes_the_bottom_once_a_period():
    equations = pendulum(Watcher("gate", bottom))
    assert [event.name for event in equations.events] == ["gate.bottom"]
    assert equations.events[0].resets == ()
    events, _ = run(equations, 6.0)
    # The physical pendulum: the length of the equivalent one is I/(m l) = 1.1 m.
    quarter = np.sqrt(1.1 / 9.81) * ellipk(np.sin(0.25) ** 2)
    assert [name for name, _ in events] == ["gate.bottom"] * 3
    assert [time for _, time in events] == pytest.approx(quarter * np.array([1, 5, 9]), abs=1e-9)


def test_resets_by_name():
    """At the bottom the pendulum turns back with half its rate, and a switch counts that."""

    def declare(situation):
        rate = situation.kinematics.rate("swing")
        count = situation.states["count"]
        resets = {"swing_rate": -0.5 * rate, "stop.count": count + 1.0}
        yield PartEvent("hit", situation.kinematics.coordinate("swing"), "falling", resets=resets)

    equations = pendulum(Watcher("stop", declare, ("count",)))
    assert equations.events[0].resets == ((1, 0), (2, 1))
    events, samples = run(equations, 1.2)
    assert len(events) == 1
    assert samples[-1][1][2] == 1.0
    energy = [0.55 * r**2 - 9.81 * np.cos(a) for a, r, _ in (samples[0][1], samples[-1][1])]
    assert energy[1] + 9.81 == pytest.approx(0.25 * (energy[0] + 9.81), rel=1e-8)


@dataclass(frozen=True)
class Lift(BasePart):
    """Drives a coordinate with sin t."""

    def motions(self, clock):
        return {"lift": DrivenMotion(ops.sin(clock.time), ops.cos(clock.time))}

    def loads(self, situation):
        return Loads(accelerations={"lift": -ops.sin(situation.time)})


def test_event_of_a_driven_coordinate():
    """The driven coordinate stands for its law: sin t passes 0.5 at π/6."""

    def declare(situation):
        yield PartEvent("half", situation.kinematics.coordinate("lift") - 0.5, "rising")

    joints = (("T3", "lift", 0.0), ("R2", "swing", 0.5))
    events, _ = run(pendulum(Lift("drive"), Watcher("gate", declare), joints=joints), 2.0)
    assert [time for _, time in events] == pytest.approx([np.pi / 6.0], abs=1e-11)


def test_event_of_an_acceleration():
    """The kinematics of events know the accelerations: the mass at rest starts with g sin α."""

    def declare(situation):
        tangential = situation.kinematics.acceleration("swing.body", (0.0, 0.0, -1.0))
        yield PartEvent("slow", ops.dot(tangential, tangential))

    e = pendulum(Watcher("gate", declare))
    event = ops.numeric([e.time, e.state, e.algebraic, e.parameter], e.event)
    found = event(0.0, [0.3, 0.0], [], [p.value for p in e.parameters])[0, 0]
    assert found == pytest.approx((9.81 * np.sin(0.3) / 1.1) ** 2, rel=1e-12)


@pytest.mark.parametrize(
    ("declare", "message"),
    [
        (
            lambda s: [PartEvent("hit", s.time, resets={"swing_rat": 0.0})],
            "event 'gate.hit' resets no state named 'swing_rat'; did you mean 'swing_rate'",
        ),
        (
            lambda s: [PartEvent("hit", s.time), PartEvent("hit", s.time)],
            "two events are named 'gate.hit'",
        ),
    ],
)
def test_bad_events(declare, message):
    with pytest.raises(InputError, match=message):
        pendulum(Watcher("gate", declare))


def crossing_system(guess):
    """A body that moves along x and a massless point that may be on either side of it."""
    side = UserConstraint(
        "side", lambda g: g.coordinate("place") ** 2 - 1.0 - g.coordinate("x") ** 2
    )
    watcher = Watcher(
        "crossing",
        lambda s: [PartEvent("", s.kinematics.coordinate("x") - 0.5, "rising", guesses=guess)],
    )
    bodies = (
        Body("body", GROUND, joints=(Joint("T1", "x", start_rate=1.0),), mass=1.0),
        Body("point", GROUND, joints=(Joint("T2", "place", 1.0, "dependent"),)),
    )
    return derive(System("sides", ParameterTable(), bodies, parts=(watcher,), constraints=(side,)))


def test_guesses_lead_to_another_solution():
    happened, samples = run(crossing_system({"place": ops.scalar(-1.5)}), 1.0, unknowns=True)
    assert [round(t, 9) for _, t in happened] == [0.5]
    times, place = np.array([(t, z[0]) for t, z in samples]).T
    expected = np.where(times < 0.55, 1.0, -1.0) * np.sqrt(1.0 + times**2)
    assert place == pytest.approx(expected, abs=1e-9)


def test_guesses_are_for_dependent_coordinates():
    with pytest.raises(InputError, match="event 'crossing' guesses no dependent coordinate"):
        crossing_system({"x": ops.scalar(1.0)})
