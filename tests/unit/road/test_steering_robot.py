"""The steering robot: records, lag and largest rate against closed forms, and the towing force."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from vehicledyn.multibody.equations.derivation import derive
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.system import System
from vehicledyn.road.manoeuvres.kinds.recorded.steering_robot import SteeringRobot
from vehicledyn.road.manoeuvres.robot import Robot, Towing
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.parameters import ParameterTable

PER_RACK, FREQUENCY, DAMPING = -50.0, 40.0, 0.8


def equations(*parts):
    """Return names of the states, channels and the functions of a sledge with a rack."""
    joints, inertia = (Joint("T1", "x"), Joint("R3", "yaw")), (1, 1, 1, 0, 0, 0)
    sledge = Body("car", "ground", joints=joints, mass=2.0, inertia=inertia)
    rack = Body("rack", "car", joints=(Joint("T2", "rack", role="driven"),), mass=0.1)
    e = derive(System("robot", ParameterTable(), (sledge, rack), parts=parts))
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    values = [p.value for p in e.parameters]
    rate, output = ops.numeric(inputs, e.rate), ops.numeric(inputs, e.output)
    return (
        [s.name for s in e.states],
        [c.name for c in e.channels],
        lambda t, x: rate(t, x, [], values)[:, 0],
        lambda t, x: output(t, x, [], values)[:, 0],
    )


def robot(wanted, fastest=None):
    return Robot("robot", "rack", PER_RACK, wanted, FREQUENCY, DAMPING, fastest)


def run(rate, state, duration, step=1e-3):
    for k in range(round(duration / step)):
        t = k * step
        a = rate(t, state)
        b = rate(t + 0.5 * step, state + 0.5 * step * a)
        c = rate(t + 0.5 * step, state + 0.5 * step * b)
        d = rate(t + step, state + step * c)
        state = state + step / 6.0 * (a + 2 * b + 2 * c + d)
    return state


def test_a_step_is_followed_as_by_a_damped_second_order_system():
    names, channels, rate, output = equations(robot(lambda time: 0.5 + 0.0 * time))
    end = run(rate, np.zeros(len(names)), 0.05)
    eigen = FREQUENCY * math.sqrt(1.0 - DAMPING**2)
    decay = math.exp(-DAMPING * FREQUENCY * 0.05)
    phase = eigen * 0.05
    lag = math.cos(phase) + DAMPING * FREQUENCY / eigen * math.sin(phase)
    angle = end[names.index("robot.angle")]
    assert angle == pytest.approx(0.5 * (1.0 - decay * lag), rel=1e-6)
    found = dict(zip(channels, output(0.05, end), strict=True))
    assert found["rack"] == pytest.approx(angle / PER_RACK, rel=1e-12)
    assert found["robot.wanted_angle"] == 0.5


def test_the_rate_stays_below_the_fastest():
    names, _, rate, _ = equations(robot(lambda time: 30.0 + 0.0 * time, fastest=2.0))
    end = run(rate, np.zeros(len(names)), 1.0)
    assert end[names.index("robot.angle_rate")] == pytest.approx(2.0, rel=1e-9)


def test_the_record_joins_its_samples_and_is_held_outside():
    test = SteeringRobot(interval="0.1 s", angles=["0 deg", "10 deg", "-5 deg"], begin="1 s")
    angle = test.record()
    at = ops.symbol("t")
    curve = ops.numeric([at], ops.column([angle(at)]))
    found = [math.degrees(float(curve(t)[0, 0])) for t in (0.3, 1.0, 1.05, 1.1, 1.2, 4.0)]
    assert found == pytest.approx([0.0, 0.0, 5.0, 10.0, -5.0, -5.0], abs=1e-9)


def test_the_towing_force_acts_along_the_chassis():
    names, channels, rate, output = equations(
        Towing("tow", "car", lambda _: 5.0, 100.0), robot(lambda t: 0.0 * t)
    )
    state = np.zeros(len(names))
    state[names.index("x_rate")], state[names.index("yaw")] = 4.0, 0.6
    found = dict(zip(channels, output(0.0, state), strict=True))
    force = 100.0 * (5.0 - 4.0 * math.cos(0.6))
    assert found["tow.force"] == pytest.approx(force, rel=1e-12)
    assert rate(0.0, state)[names.index("x_rate")] == pytest.approx(
        force * math.cos(0.6) / 2.1, rel=1e-9
    )


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"angles": [0.1]}, "takes 2 to 100000 samples, not 1"),
        (
            {
                "angles": [0, 1],
                "towing_gain": 1e4,
                "speed_control": {"proportional_gain": 1.0, "integral_gain": 0.0},
            },
            "one of them holds the speed",
        ),
    ],
)
def test_what_is_no_record_is_refused(settings, words):
    with pytest.raises(ValidationError, match=words):
        SteeringRobot(interval=0.1, **settings)
