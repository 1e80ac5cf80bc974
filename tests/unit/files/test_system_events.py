"""Events, impacts and switches of system files, with every method and with mistakes."""

import numpy as np
import pytest
from system_texts import equations, problems

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.registry import find
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel

pytestmark = pytest.mark.long

G = 9.81
FINE = {"relative_tolerance": 1e-11, "absolute_tolerance": 1e-11}
METHODS = {
    "rk4": ({"step": 5e-3}, 1e-9),
    "dop853": (FINE, 1e-9),
    "rk45": (FINE, 1e-9),
    "rosenbrock": (FINE, 1e-9),
    "cvodes": (FINE, 1e-7),
    "idas": (FINE, 1e-7),
    # Of order one: a fall of a second is wrong by half a step.
    "symplectic_euler": ({"step": 1e-4}, 2e-3),
}
BALL = """
title: A bouncing ball
parameters: {restitution: 0.8}
bodies:
  ball: {joints: [{kind: T3, name: z, start: 1 m}], mass: 1 kg}
events:
  floor: {when: ball.z, direction: falling, restitution: restitution}
  top: {when: ball.z_rate, direction: falling}
"""


def run(folder, text, stop, method="dop853", interval=0.05, **settings):
    """Events, the last state by name and all samples of a run."""
    e = equations(folder, text)
    events, samples = [], []
    options = settings or METHODS[method][0]
    simulate(
        compile_kernel(e, backend="interpreted"),
        find("solver", method)(**options),
        start=0.0,
        stop=stop,
        interval=interval,
        state=[s.start for s in e.states],
        unknowns=[u.start for u in e.unknowns],
        sink=lambda t, x, z, y: samples.extend(zip(t, x, y, strict=True)),
        happened=lambda name, time: events.append((name, time)),
    )
    names = [s.name for s in e.states]
    return events, dict(zip(names, samples[-1][1], strict=True)), samples


def bounces(count, restitution=0.8):
    """Times of the impacts and of the tops after them, and the heights of these."""
    time, speed = np.sqrt(2.0 / G), np.sqrt(2.0 * G)
    impacts, tops, heights = [], [], []
    for _ in range(count):
        impacts.append(time)
        speed *= restitution
        tops.append(time + speed / G)
        heights.append(speed**2 / (2.0 * G))
        time += 2.0 * speed / G
    return impacts, tops, heights


@pytest.mark.parametrize("method", METHODS)
def test_bouncing_ball(method, tmp_path):
    events, last, _ = run(tmp_path, BALL, 2.4, method)
    impacts, tops, heights = bounces(4)
    tolerance = METHODS[method][1]
    told = [[t for name, t in events if name == wanted] for wanted in ("floor", "top")]
    assert told[0] == pytest.approx(impacts, abs=tolerance)
    assert told[1] == pytest.approx([t for t in tops if t < 2.4], abs=tolerance)
    fall = 2.4 - tops[3]
    assert last["ball.z"] == pytest.approx(heights[3] - 0.5 * G * fall**2, abs=tolerance)


@pytest.mark.parametrize("method", ["rk4", "dop853", "rosenbrock"])
def test_infinitely_many_bounces_end_with_a_message(method, tmp_path):
    """The bounces accumulate at (1 + 2 e/(1 - e)) √(2 h/g) = 4.06 s."""
    with pytest.raises(NumericalError, match=r"'floor' fires for the third time.*t = 4.063.*rest"):
        run(tmp_path, BALL, 5.0, method)


def test_two_walls_that_close_in_end_with_a_message_too(tmp_path):
    text = """
title: A ball between walls that meet after a second
gravity: [0, 0, 0]
bodies: {ball: {joints: [{kind: T1, name: x, start: 0.1 m, start_rate: 3 m/s}], mass: 1 kg}}
events:
  left: {when: ball.x + 1 m - time * 1 m/s, direction: falling, restitution: 1}
  right: {when: 1 m - ball.x - time * 1 m/s, direction: falling, restitution: 1}
"""
    with pytest.raises(NumericalError, match="fires for the third time"):
        run(tmp_path, text, 2.0)


CRADLE = """
title: Balls in a row, the first comes in
gravity: [0, 0, 0]
parameters: {diameter: 50 mm, gap: 0.1 mm}
repeat:
  - for: {i: {from: 1, to: 5}}
    bodies:
      ball_{i}: {joints: [{kind: T1, name: x, start: "{i} * (diameter + gap)"}], mass: 0.2 kg}
  - for: {i: {from: 1, to: 4}}
    events:
      pair_{i}:
        when: "ball_{i + 1}.x - ball_{i}.x - diameter"
        direction: falling
        restitution: 1
initial: {ball_1.x: 0 m, ball_1.x_rate: 1.3 m/s}
"""


def test_newtons_cradle_hands_the_momentum_to_the_last_ball(tmp_path):
    events, last, _ = run(tmp_path, CRADLE, 0.2)
    assert [name for name, _ in events] == [f"pair_{k}" for k in (1, 2, 3, 4)]
    rates = [last[f"ball_{k}.x_rate"] for k in range(1, 6)]
    assert rates == pytest.approx([0.0, 0.0, 0.0, 0.0, 1.3], abs=1e-12)


STOP = """
title: A cart with a pendulum runs against a stop
parameters: {cart: 2 kg, bob: 1 kg, length: 0.4 m}
bodies:
  cart: {joints: [{kind: T1, name: x, start: -0.1 m, start_rate: 1 m/s}], mass: cart}
  rod: {parent: cart, joints: [{kind: R2, name: a, start: 0.5 rad, start_rate: 0.4 rad/s}],
        mass: bob,
        com: [0, 0, -length]}
events:
  stop: {when: cart.x, direction: rising, reset: {cart.x_rate: -0.5 * cart.x_rate}}
"""


def test_a_reset_rate_takes_its_neighbours_along(tmp_path):
    """The impulse acts on the cart alone: the bob's momentum along its swing is kept."""
    events, _, _ = run(tmp_path, STOP, 0.2)
    assert len(events) == 1
    e = equations(tmp_path, STOP)
    kernel = compile_kernel(e, backend="interpreted")
    state = np.array([0.0, 0.3, 0.9, -0.7])
    values = kernel.reset_values(0.0, state, [])
    after = state.copy()
    for index, row in e.events[0].resets:
        after[index] = values[row]
    assert after[2] == pytest.approx(-0.45, rel=1e-14)

    def along_swing(x):
        # The bob is at x - l sin a; its velocity along the tangent (cos a, sin a).
        return x[2] * np.cos(x[1]) - 0.4 * x[3]

    assert along_swing(after) == pytest.approx(along_swing(state), rel=1e-12)


def test_simultaneous_events_happen_in_the_order_of_the_file(tmp_path):
    text = """
title: Two events at one second
switches: {first: 1, second: 0}
bodies: {ball: {joints: [T1 x], mass: 1 kg}}
events:
  one: {when: time - 1 s, reset: {first: 2 * first}}
  two: {when: 2 * time - 2 s, reset: {second: first + 0.5}}
"""
    events, last, _ = run(tmp_path, text, 1.5)
    assert [name for name, _ in events] == ["one", "two"]
    assert (last["first.value"], last["second.value"]) == (2.0, 2.5)


def test_a_switch_changes_a_force_and_a_terminal_event_ends_the_run(tmp_path):
    text = """
title: A force that comes on at half a second
gravity: [0, 0, 0]
switches: {on: 0}
bodies: {ball: {joints: [{kind: T1, name: x, start_rate: 1 m/s}], mass: 2 kg}}
forces: {push: {coordinate: ball.x, force: "where(on > 0, 4 N, 0)"}}
events:
  start: {when: ball.x - 0.5 m, direction: rising, reset: {on: 1}}
  end: {when: ball.x - 2 m, direction: rising, terminal: true}
sensors: {seen: {kind: expression, value: on, unit: "1"}}
"""
    events, last, samples = run(tmp_path, text, 9.0)
    # 0.5 + t + t² = 2 after the force came on.
    end = 0.5 + (np.sqrt(7.0) - 1.0) / 2.0
    assert events == [
        ("start", pytest.approx(0.5, abs=1e-10)),
        ("end", pytest.approx(end, abs=1e-9)),
    ]
    assert last["ball.x_rate"] == pytest.approx(np.sqrt(7.0), abs=1e-9)
    assert samples[-1][0] == pytest.approx(end, abs=1e-9)
    assert samples[-1][2][-1] == 1.0


def test_an_event_and_its_mirror_image(tmp_path):
    text = """
title: Two balls bounce off two walls
gravity: [0, 0, 0]
mirror:
  - plane: y
    names: {left: right}
    bodies:
      left: {joints: [{kind: T2, name: y, start: 0.1 m, start_rate: 1 m/s}, T1 x], mass: 1 kg}
    switches: {left_hits: 0}
    events:
      left_wall:
        when: tip.y - 0.5 m
        points: {tip: left}
        direction: rising
        restitution: 0.5
        reset: {left_hits: left_hits + 1, left.x_rate: 0.3 * tip_velocity.y}
"""
    events, last, _ = run(tmp_path, text, 1.0)
    assert [t for _, t in events] == pytest.approx([0.4, 0.4], abs=1e-10)
    assert {name for name, _ in events} == {"left_wall", "right_wall"}
    assert last["left.y_rate"] == pytest.approx(-0.5, abs=1e-12)
    assert last["right.y_rate"] == pytest.approx(0.5, abs=1e-12)
    assert last["right.x_rate"] == pytest.approx(last["left.x_rate"], abs=1e-12)
    assert last["left.x_rate"] == pytest.approx(0.3, abs=1e-12)
    assert last["left_hits.value"] == last["right_hits.value"] == 1.0


LOOP = """
title: A four-bar whose crank runs against a stop
bodies:
  crank: {joints: [{kind: R3, name: a, start: 1.3 rad, role: independent, start_rate: 2 rad/s}],
        mass: 1 kg,
          com: [0.25 m, 0, 0], inertia: [0.01 kg*m^2, 0.02 kg*m^2, 0.02 kg*m^2]}
  rod: {parent: crank, at: [0.5 m, 0, 0], joints: [{kind: R3, name: b, start: -1.0 rad}],
        mass: 2 kg,
        com: [0.4 m, 0, 0], inertia: [0.01 kg*m^2, 0.1 kg*m^2, 0.1 kg*m^2]}
  rocker: {at: [0.9 m, 0.1 m, 0], joints: [{kind: R3, name: c, start: 1.7 rad}], mass: 1 kg,
           com: [0.3 m, 0, 0], inertia: [0.01 kg*m^2, 0.05 kg*m^2, 0.05 kg*m^2]}
cuts:
  pin: {kind: ball, a: {body: rod, point: [0.8 m, 0, 0]}, b: {body: rocker, point: [0.6 m, 0, 0]}}
events:
  stop: {when: crank.a - 1.5 rad, direction: rising, restitution: 0.4}
"""


def test_a_closed_loop_stays_closed_through_an_impact(tmp_path):
    events, _, samples = run(tmp_path, LOOP, 0.3, "rk4", 0.01, step=1e-3)
    e = equations(tmp_path, LOOP)
    names = [c.name for c in e.channels]
    outputs = np.array([y for _, _, y in samples])
    assert len(events) >= 1
    assert outputs[:, names.index("constraints.position_error")].max() < 1e-12
    assert outputs[:, names.index("constraints.velocity_error")].max() < 1e-12
    rates = outputs[:, names.index("crank.a_rate")]
    assert rates.max() > 0.0 > rates.min()


@pytest.mark.parametrize(
    ("event", "message"),
    [
        ("{when: ball.q}", "no quantity named 'ball.q'"),
        ("{when: ball.z, direction: up}", "direction"),
        ("{direction: rising}", "when: "),
        ("{when: ball.z, restitution: -1}", "must be at least 0, is -1"),
        ("{when: ball.z, restitution: 1.2}", "must be at most 1, is 1.2"),
        ("{when: ball.z, restitution: 1 m}", "a pure number is needed here"),
        ("{when: ball.z_rate, restitution: 1}", "not of 'ball.z_rate'"),
        ("{when: ball.z, reset: {ball.z_rat: 0}}", "did you mean 'ball.z_rate'"),
        ("{when: ball.z, reset: {ball.z_rate: 1 kg}}", "a quantity in m/s is needed here"),
        ("{when: ball.z, reset: {pin.x_rate: 0}}", "'pin.x' is driven"),
        ("{when: ball.z, reset: {on: 3 m}}", "a pure number is needed here"),
        ("{when: hook.z, points: {hook: bal}}", "did you mean 'ball'"),
        ("{when: __import__('os')}", "no function named '__import__'"),
    ],
)
def test_mistakes_are_told_with_their_place(event, message, tmp_path):
    text = (
        "title: t\nswitches: {on: 0}\nbodies:\n"
        "  pin: {joints: [T1 x], mass: 1 kg}\n"
        "  ball: {joints: [T3 z], mass: 1 kg}\n"
        "drives: {d: {coordinate: pin.x, law: {kind: constant_rate, rate: 1 m/s}}}\n"
        f"events:\n  hit: {event}\n"
    )
    found = problems(tmp_path, text)
    assert len(found) == 1
    assert found[0].startswith("8:")
    assert message in found[0]
