"""Bodies whose attitude is a quaternion: tops, loops, small motions, and what is refused."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipj

from vehicledyn.analyse.linearise import linearise
from vehicledyn.analyse.modes import eigenmodes
from vehicledyn.base.errors import InputError
from vehicledyn.base.numbers.quaternions import about, multiplied, rotated
from vehicledyn.multibody import (
    GROUND,
    BallCut,
    BasePart,
    Body,
    Joint,
    ParameterTable,
    PartEvent,
    RodCut,
    System,
    UserConstraint,
    derive,
    quaternion_joint,
)
from vehicledyn.multibody.elements.coordinate_forces import CoordinateForce
from vehicledyn.multibody.equations.equation_terms import derive_ingredients
from vehicledyn.multibody.equations.inverse_dynamics import derive_inverse
from vehicledyn.multibody.loops.position_level import Positions
from vehicledyn.multibody.recursion.numeric_kinematics import raw_skeleton, skeleton_from
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.shared import count_operations

MOMENTS = np.array([1.0, 2.0, 2.5])
AT_REST = (1.0, 0.0, 0.0, 0.0)
ANGLES = (0.4, -0.7, 0.9)
RIGID = {"mass": 2.0, "com": (0.2, -0.1, 0.3), "inertia": (0.6, 0.5, 0.7, 0.05, -0.02, 0.03)}


def attitude(a, b, c):
    """Return the quaternions of yaw, pitch and roll angles, shape (n, 4)."""
    z, y, x = (about(np.eye(3)[k], np.atleast_1d(v)) for k, v in ((2, a), (1, b), (0, c)))
    return multiplied(multiplied(z, y), x)


def angular_velocity(angles, rates):
    """Return ω in body axes of the rates of yaw, pitch and roll."""
    _, b, c = angles
    to_omega = [
        [-np.sin(b), 0.0, 1.0],
        [np.cos(b) * np.sin(c), np.cos(c), 0.0],
        [np.cos(b) * np.cos(c), -np.sin(c), 0.0],
    ]
    return np.array(to_omega) @ rates


OBLIQUE = attitude(*ANGLES)[0]


def function(e, expression):
    """Return a function of the state, all else as at the start."""
    values = [p.value for p in e.parameters]
    evaluate = ops.numeric([e.time, e.state, e.algebraic, e.parameter], expression)
    return lambda x, z=(): evaluate(0.0, x, list(z), values)[:, 0]


def motion(e, duration, *, start=None, times=None):
    start = [s.start for s in e.states] if start is None else start
    rate = function(e, e.rate)
    found = solve_ivp(
        lambda t, x: rate(x), (0.0, duration), start, "DOP853", t_eval=times, rtol=1e-12, atol=1e-13
    )
    return found.y.T


def top(joints, *, moments=MOMENTS, com=(0.0, 0.0, 0.0), gravity=(0.0, 0.0, 0.0), **more):
    body = Body("top", GROUND, joints=joints, mass=1.0, com=com, inertia=tuple(moments))
    return derive(System("top", ParameterTable(), (body,), gravity=gravity), **more)


def test_free_asymmetric_top_moves_as_jacobi_says():
    """ω = (a cn τ, b sn τ, c dn τ) for 2 E I₂ < L² (Landau, Lifshitz I, § 37)."""
    i1, i2, i3 = MOMENTS
    w1, w3 = 0.8, 1.7
    e = top(quaternion_joint("top", OBLIQUE, (w1, 0.0, w3)))
    times = np.linspace(0.0, 6.0, 13)
    found = motion(e, 6.0, times=times)
    energy, momentum = 0.5 * (i1 * w1**2 + i3 * w3**2), (i1 * w1) ** 2 + (i3 * w3) ** 2
    assert momentum > 2.0 * energy * i2
    speed = np.sqrt((i3 - i2) * (momentum - 2.0 * energy * i1) / (i1 * i2 * i3))
    m = (i2 - i1) * (2.0 * energy * i3 - momentum) / ((i3 - i2) * (momentum - 2.0 * energy * i1))
    sn, cn, dn, _ = ellipj(speed * times, m)
    b = np.sqrt((2.0 * energy * i3 - momentum) / (i2 * (i3 - i2)))
    exact = np.stack([w1 * cn, b * sn, w3 * dn], axis=1)
    assert found[:, 4:] == pytest.approx(exact, abs=1e-10)
    held = rotated(found[:, :4], MOMENTS * found[:, 4:])
    assert held == pytest.approx(np.tile(held[0], (13, 1)), abs=1e-10)
    assert np.linalg.norm(found[:, :4], axis=1) == pytest.approx(1.0, abs=1e-11)


def test_top_moves_as_three_turns_do_away_from_their_singularity():
    rates = np.array([0.3, -0.2, 0.5])
    turns = tuple(
        Joint(kind, f"top.{n}", start, start_rate=rate)
        for kind, n, start, rate in zip(("R3", "R2", "R1"), "abc", ANGLES, rates, strict=True)
    )
    heavy = {"com": (0.1, 0.2, 0.3), "gravity": (0.0, 0.0, -9.81)}
    chain = top(turns, **heavy)
    omega = angular_velocity(ANGLES, rates)
    ball = top(quaternion_joint("top", OBLIQUE, omega), **heavy)
    times = np.linspace(0.0, 0.5, 6)
    angles, found = (motion(e, 0.5, times=times) for e in (chain, ball))
    assert np.abs(np.cos(angles[:, 1])).min() > 0.2
    turned = attitude(*angles[:, :3].T)
    for axis in np.eye(3):
        assert rotated(found[:, :4], axis) == pytest.approx(rotated(turned, axis), abs=1e-9)


def test_heavy_symmetric_top_precesses_steadily():
    """(I₃ ω₃ - I₁ Ω cos θ) Ω = m g l, with I₁ about the point of support."""
    arm, tilt, turning = 0.3, 0.6, 0.7
    moments, about_point = (0.05, 0.05, 0.02), 0.05 + arm**2
    spin = (9.81 * arm / turning + about_point * turning * np.cos(tilt)) / 0.02
    omega = (0.0, turning * np.sin(tilt), spin)
    start = (np.cos(tilt / 2.0), np.sin(tilt / 2.0), 0.0, 0.0)
    e = top(
        quaternion_joint("top", start, omega), moments=moments, com=(0.0, 0.0, arm),
        gravity=(0.0, 0.0, -9.81),
    )  # fmt: skip
    times = np.linspace(0.0, 0.5, 4)
    found = motion(e, 0.5, times=times)
    axis = rotated(found[:, :4], np.array([0.0, 0.0, 1.0]))
    phase = turning * times
    exact = np.stack(
        [np.sin(tilt) * np.sin(phase), -np.sin(tilt) * np.cos(phase), np.full(4, np.cos(tilt))],
        axis=1,
    )
    assert axis == pytest.approx(exact, abs=1e-9)


def steps(e, count, duration):
    """Return the state after steps of the classical Runge-Kutta method."""
    rate, x, h = function(e, e.rate), np.array([s.start for s in e.states]), duration / count
    for _ in range(count):
        k1 = rate(x)
        k2 = rate(x + 0.5 * h * k1)
        k3 = rate(x + 0.5 * h * k2)
        k4 = rate(x + h * k3)
        x = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return x


def turned_momentum(x):
    return rotated(x[:4] / np.linalg.norm(x[:4]), MOMENTS * x[4:])


def test_order_of_convergence_and_drift_of_the_norm():
    e = top(quaternion_joint("top", OBLIQUE, (0.8, 0.3, 1.7)))
    exact = motion(e, 2.0)[-1]
    errors, norms = [], []
    for count in (20, 40, 80):
        found = steps(e, count, 2.0)
        errors.append(np.abs(found - exact).max())
        norms.append(abs(np.linalg.norm(found[:4]) - 1.0))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(4.0, abs=0.25)
    assert norms[0] < 1e-5 and norms[0] > 15.0 * norms[1] > 200.0 * norms[2]


def test_tumbling_through_a_quarter_turn_of_pitch_loses_no_accuracy():
    """Three turns are singular on the way; a quaternion does not know of it."""
    spin = (0.05, 1.5, 0.0)
    chain = tuple(
        Joint(kind, f"top.{n}", 0.0, start_rate=rate)
        for kind, n, rate in (("R3", "yaw", 0.0), ("R2", "pitch", 1.5), ("R1", "roll", 0.05))
    )
    found = steps(top(quaternion_joint("top", AT_REST, spin)), 400, 2.0)
    lost = np.abs(turned_momentum(found) - MOMENTS * spin).max()
    assert lost < 1e-8
    e = top(chain)
    *angles, a, b, c = steps(e, 400, 2.0)
    turned, omega = attitude(*angles)[0], angular_velocity(angles, [a, b, c])
    by_turns = np.abs(rotated(turned, MOMENTS * omega) - MOMENTS * spin).max()
    assert by_turns > 1e3 * lost


def carried(attitude, **more):
    """Return a free body with a pendulum on it."""
    slides = tuple(Joint(f"T{k}", f"body.{n}") for k, n in ((1, "x"), (2, "y"), (3, "z")))
    bodies = (
        Body("body", GROUND, joints=(*slides, *attitude), **RIGID),
        Body("arm", "body", (0.5, 0.2, -0.1), (Joint("R2", "arm.angle", 0.3),), **RIGID),
    )
    return derive(System("carried", ParameterTable(), bodies), **more)


@pytest.mark.parametrize("formulation", ["auto", "composite", "articulated"])
def test_free_body_accelerates_as_with_three_turns(formulation):
    rates = np.array([0.3, -0.2, 0.5])
    turns = tuple(Joint(k, f"body.{n}") for k, n in (("R3", "a"), ("R2", "b"), ("R1", "c")))
    by_turns = carried(turns)
    e = carried(quaternion_joint("body"), formulation=formulation)
    names = {s.name: k for k, s in enumerate(e.states)}
    x = np.zeros(len(e.states))
    x[: 2 * len(e.positions)] = [0.1, 0.2, 0.3, 0.4, 1.0, 2.0, 3.0, 4.0]
    x[[names[f"body.quaternion_{n}"] for n in "wxyz"]] = OBLIQUE
    x[[names[f"body.omega_{n}"] for n in "xyz"]] = angular_velocity(ANGLES, rates)
    found = function(e, e.rate)(x)
    chain = [0.1, 0.2, 0.3, *ANGLES, 0.4, 1.0, 2.0, 3.0, *rates, 4.0]
    other = function(by_turns, by_turns.rate)(chain)
    assert found[4:7] == pytest.approx(other[7:10], rel=1e-11)
    assert found[7] == pytest.approx(other[13], rel=1e-11)


def test_quaternion_needs_no_more_operations_than_three_turns():
    turns = tuple(Joint(k, f"body.{n}") for k, n in (("R3", "a"), ("R2", "b"), ("R1", "c")))
    ball, chain = (
        count_operations(carried(joints).rate) for joints in (quaternion_joint("body"), turns)
    )
    assert ball < 1.1 * chain


def tied(attitude, tie, method="auto"):
    """Return a ball-jointed body whose tip carries a sliding weight."""
    weight = Body("weight", GROUND, (0.4, 0.1, 0.0), (Joint("T3", "weight.z", -1.0),), mass=3.0)
    swing = Body("swing", GROUND, joints=attitude, **RIGID)
    point, none = (0.5, 0.2, -0.3), (0.0, 0.0, 0.0)
    system = System("tied", ParameterTable(), (swing, weight))
    if tie == "rod":
        cuts = (RodCut("rod", "swing", point, "weight", none, 1.1),)
        table = ParameterTable()
        return derive(System("tied", table, (swing, weight), cuts, constraint_method=method))

    def gap(geometry):
        between = geometry.position("weight") - geometry.position("swing", point)
        return (ops.dot(between, between) - 1.1**2) / 2.2

    rod = UserConstraint("rod", gap)
    return derive(System(system.name, system.table, system.bodies, constraints=(rod,)))


@pytest.mark.parametrize("tie", ["rod", "constraint"])
def test_loop_through_the_joint_moves_as_with_three_turns(tie):
    rates = np.array([0.3, -0.2, 0.5])
    turns = tuple(
        Joint(k, f"swing.{n}", start, "independent")
        for k, n, start in zip(("R3", "R2", "R1"), "abc", ANGLES, strict=True)
    )
    omega = angular_velocity(ANGLES, rates)
    chain, ball = tied(turns, "rod"), tied(quaternion_joint("swing", OBLIQUE), tie)
    assert ball.structure["dependent"] == ["weight.z"] == chain.structure["dependent"]
    assert ball.structure["degrees_of_freedom"] == 3
    seen = []
    for e, state in ((chain, [*ANGLES, *rates]), (ball, [*OBLIQUE, *omega])):
        z = [u.start for u in e.unknowns]
        assert np.abs(function(e, e.residual)(state, z)).max() < 1e-11
        values = function(e, e.output)(state, z)
        channels = {ch.name: v for ch, v in zip(e.channels, values, strict=True)}
        assert channels["constraints.velocity_error"] < 1e-12
        growth = ops.derivative(_energy(e), e.state, e.rate)
        fall = _weight_acceleration(e)
        growing = function(e, ops.column([growth]))(state, z)
        seen.append([channels["weight.z"], channels["weight.z_rate"], *fall(state, z)])
        assert np.isfinite(growing).all()
    assert seen[1] == pytest.approx(seen[0], rel=1e-10)


def test_multipliers_move_the_joint_as_partitioning_does():
    """States off the constraints are put onto them; then accelerations are the same."""
    omega = angular_velocity(ANGLES, np.array([0.3, -0.2, 0.5]))
    joints = quaternion_joint("swing", OBLIQUE)
    split, whole = tied(joints, "rod"), tied(joints, "rod", "multipliers")
    assert whole.structure["constraint_method"] == "multipliers"
    start = {f"swing.quaternion_{c}": v for c, v in zip("wxyz", OBLIQUE, strict=True)}
    start |= {f"swing.omega_{c}": v for c, v in zip("xyz", omega, strict=True)}
    state = [start[s.name] for s in split.states]
    z = [u.start for u in split.unknowns]
    values = function(split, split.output)(state, z)
    seen = dict(zip([c.name for c in split.channels], values, strict=True))
    start |= {n: seen[n] for n in ("weight.z", "weight.z_rate")}
    names = [s.name for s in whole.states]
    assert set(names) == set(start)
    on = np.array([start[n] for n in names])
    rates = dict(zip(names, function(whole, whole.rate)(on, []), strict=True))
    values = function(split, split.rate)(state, z)
    known = dict(zip([s.name for s in split.states], values, strict=True))
    for name, value in known.items():
        assert rates[name] == pytest.approx(value, rel=1e-10, abs=1e-12)
    assert rates["weight.z_rate"] == pytest.approx(_weight_acceleration(split)(state, z)[0])

    off = on + 1e-3 * np.sin(np.arange(len(on)))
    channels = [c.name for c in whole.channels]
    found = dict(zip(channels, function(whole, whole.output)(off, []), strict=True))
    before = dict(zip(channels, function(whole, whole.output)(on, []), strict=True))
    assert abs(before["constraints.position_error"]) < 1e-12
    # One Newton step: what is left is of second order in the millimetre that was off.
    assert abs(found["constraints.position_error"]) < 1e-5
    assert abs(found["constraints.velocity_error"]) < 1e-12


def _energy(e):
    return sum(
        e.output[k]
        for k, c in enumerate(e.channels)
        if c.name in ("energy.kinetic", "energy.gravity")
    )


def _weight_acceleration(e):
    """Return z̈ of the weight from its rate along the motion of states and unknowns."""
    k = next(k for k, c in enumerate(e.channels) if c.name == "weight.z_rate")
    place = next(k for k, c in enumerate(e.channels) if c.name == "weight.z_rate")
    both = ops.stacked(e.state, e.algebraic)
    rate = ops.derivative(e.output[k], both, ops.stacked(e.rate, e.output[place]))
    return function(e, ops.column([rate]))


def test_small_motions_of_a_hanging_body_are_those_of_a_pendulum():
    """Oblique at rest; √(m g l / I) about either axis, and a free turn about the vertical."""
    joints = quaternion_joint("top", OBLIQUE)
    arm, gravity = 0.3, 9.81
    down = rotated(np.array(OBLIQUE) * [1, -1, -1, -1], np.array([0.0, 0.0, -arm]))
    e = top(joints, moments=(0.2, 0.2, 0.2), com=tuple(down), gravity=(0.0, 0.0, -gravity))
    start = np.array([s.start for s in e.states])
    linear = linearise(e, [], 0.0, start, [])
    assert linear.names[:3] == ("top.turn_x", "top.turn_y", "top.turn_z")
    found = eigenmodes(linear.matrix, linear.names)
    frequency = np.sqrt(gravity * arm / (0.2 + arm**2)) / (2.0 * np.pi)
    assert sorted(m.frequency for m in found) == pytest.approx([0.0, 0.0] + [frequency] * 2)
    assert [m.kind for m in found].count("oscillation") == 2


def test_small_motions_of_a_turning_top_nutate_as_euler_says():
    """About a steady spin about a principal axis ω₃: λ² = -(I₃-I₁)(I₃-I₂)/(I₁I₂) ω₃²."""
    e = top(quaternion_joint("top", AT_REST, (0.0, 0.0, 3.0)))
    linear = linearise(e, [], 0.0, [s.start for s in e.states], [])
    values = np.linalg.eigvals(linear.matrix)
    i1, i2, i3 = MOMENTS
    nutation = 3.0 * np.sqrt((i3 - i1) * (i3 - i2) / (i1 * i2))
    expected = sorted([nutation, -nutation, 3.0, -3.0, 0.0, 0.0])
    assert sorted(values.imag) == pytest.approx(expected, abs=1e-7)
    assert np.abs(values.real).max() < 1e-7


def test_pictures_show_the_attitude():
    system = System(
        "top", ParameterTable(),
        (Body("top", GROUND, (1.0, 0.0, 0.0), quaternion_joint("top", OBLIQUE), **RIGID),),
    )  # fmt: skip
    skeleton = skeleton_from(raw_skeleton(system))
    values = {n: np.array([2.0 * q, q]) for n, q in zip(skeleton.coordinates, OBLIQUE, strict=True)}
    found = skeleton.poses(values)
    assert np.abs(found.quaternion[:, 0] @ OBLIQUE) == pytest.approx(1.0, abs=1e-14)
    assert skeleton.poses({n: np.zeros(0) for n in values}).quaternion.shape == (0, 1, 4)


def test_force_on_a_speed_is_a_torque_about_that_axis():
    body = Body(
        "top", GROUND, joints=quaternion_joint("top", OBLIQUE), mass=1.0, inertia=(1, 2, 2.5)
    )
    push = CoordinateForce("push", "top.omega_y", lambda s: 3.0 - s.kinematics.rate("top.omega_y"))
    e = derive(System("top", ParameterTable(), (body,), parts=(push,), gravity=(0.0,) * 3))
    rates = function(e, e.rate)([*OBLIQUE, 0.0, 1.0, 0.0])
    assert rates[4:] == pytest.approx([0.0, 1.0, 0.0])


@pytest.mark.parametrize(
    ("use", "words"),
    [
        (derive_inverse, "inverse dynamics cannot treat 'top.quaternion_w'"),
        (Positions, "kinematics cannot treat"),
        (derive_ingredients, "export of equations cannot treat"),
    ],
)
def test_what_cannot_treat_quaternions_says_so(use, words):
    body = Body("top", GROUND, joints=quaternion_joint("top"), **RIGID)
    with pytest.raises(InputError, match=words):
        use(System("top", ParameterTable(), (body,)))


def test_a_loop_that_leaves_the_joint_no_freedom_is_refused():
    body = Body("top", GROUND, joints=quaternion_joint("top"), **RIGID)
    cut = BallCut("tip", "top", (0.5, 0.0, 0.0), GROUND, (0.5, 0.0, 0.0))
    with pytest.raises(InputError, match="leave it no freedom"):
        derive(System("top", ParameterTable(), (body,), (cut,)))


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0, 0.0), (1.0, np.nan, 0.0, 0.0)])
def test_a_quaternion_without_length_is_refused(start):
    body = Body("top", GROUND, joints=quaternion_joint("top", start), **RIGID)
    with pytest.raises(InputError, match="its quaternion has no length"):
        System("top", ParameterTable(), (body,)).check()


def test_a_force_on_a_component_of_a_quaternion_is_refused():
    body = Body("top", GROUND, joints=quaternion_joint("top"), **RIGID)
    push = CoordinateForce("push", "top.quaternion_x", lambda _: 1.0)
    with pytest.raises(InputError, match="not a coordinate"):
        derive(System("top", ParameterTable(), (body,), parts=(push,)))


@dataclass(frozen=True)
class Floor(BasePart):
    """The ground, from which a corner of a body bounces back without loss."""

    def events(self, situation):
        height = situation.kinematics.position("body", CORNER)[2]
        return (PartEvent("impact", height, "falling", restitution=1.0),)


CORNER = (0.4, 0.3, -0.5)


def test_a_corner_bounces_back_without_loss():
    """A free rigid body that turns: the corner's speed turns round, the energy stays."""
    slides = tuple(Joint(f"T{k}", f"body.{n}") for k, n in ((1, "x"), (2, "y"), (3, "z")))
    joints = (*slides, *quaternion_joint("body"))
    body = Body("body", GROUND, joints=joints, **RIGID)
    e = derive(System("dice", ParameterTable(), (body,), parts=(Floor("floor"),)))
    (event,) = e.events
    names = [s.name for s in e.states]
    before = np.zeros(len(names))
    values = {
        "body.z": 0.4, "body.x_rate": 0.3, "body.z_rate": -2.0, "body.omega_x": 0.7,
        "body.omega_y": -0.4, "body.omega_z": 0.2,
        **{f"body.quaternion_{c}": q for c, q in zip("wxyz", OBLIQUE, strict=True)},
    }  # fmt: skip
    for name, value in values.items():
        before[names.index(name)] = value
    after, reset = before.copy(), function(e, e.reset)(before)
    for state, row in event.resets:
        after[state] = reset[row]
    assert {names[k] for k, _ in event.resets} >= {f"body.omega_{c}" for c in "xyz"}
    speed = ops.derivative(e.event[event.index], e.state, e.rate)
    seen = function(e, ops.stacked(speed, _energy(e)))
    (falls, energy), (rises, kept) = seen(before), seen(after)
    assert falls < -1.0
    assert rises == pytest.approx(-falls, rel=1e-12)
    assert kept == pytest.approx(energy, rel=1e-13)
