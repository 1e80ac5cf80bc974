"""Tangents of motions against closed forms and differences."""

from dataclasses import replace

import numpy as np
import pytest
from event_examples import bouncing_ball, crossing_oscillator, with_events
from solve_examples import build, oscillator, slider_crank, symbols

import vehicledyn as vd
from vehicledyn.analyse.gradients.adjoint import figure_adjoint
from vehicledyn.analyse.gradients.equilibrium import BalancedState, rate_slopes, start_slopes
from vehicledyn.analyse.gradients.key_figures import figure_slope
from vehicledyn.analyse.gradients.motion import follow
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Method
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.kernel.tangent_code import StepRow, TangentCode
from vehicledyn.multibody import derive
from vehicledyn.symbolic.equations import Block

pytestmark = pytest.mark.usefixtures("needs_compiler")


def followed(equations, grid, n_intervals, *, parameters=None, by_state=None, state=None):
    """Return the motion and its derivatives by all parameters and the given start states."""
    kernel = compile_kernel(equations)
    if parameters is not None:
        kernel.set_parameters(parameters)
    n_x, n_p = len(equations.states), len(equations.parameters)
    start = np.array([s.start for s in equations.states] if state is None else state, dtype=float)
    guess = np.array([u.start for u in equations.unknowns])
    chosen = list(by_state or [])
    directions = np.zeros((n_p, n_p + len(chosen))), np.zeros((n_x, n_p + len(chosen)))
    directions[0][:, :n_p] = np.eye(n_p)
    for k, index in enumerate(chosen):
        directions[1][index, n_p + k] = 1.0
    code = TangentCode(equations, range(len(equations.channels)))
    unknowns = kernel.solve_unknowns(grid.start, start, guess)
    return follow(
        code,
        kernel,
        grid,
        n_intervals=n_intervals,
        start=(start, unknowns),
        directions=directions,
    )


def ball_at(time, gravity, restitution, height, speed):
    """Return height and speed of a bouncing ball in closed form, also for complex numbers."""
    landing = (speed + np.sqrt(speed**2 + 2.0 * gravity * height)) / gravity
    start, rebound = landing, restitution * np.sqrt(speed**2 + 2.0 * gravity * height)
    if time < landing.real:
        return height + speed * time - 0.5 * gravity * time**2, speed - gravity * time
    while (start + 2.0 * rebound / gravity).real < time:
        start, rebound = start + 2.0 * rebound / gravity, restitution * rebound
    flight = time - start
    return rebound * flight - 0.5 * gravity * flight**2, rebound - gravity * flight


def complex_steps(function, point):
    """Return the derivatives of a function of several numbers, exact to rounding."""
    columns = []
    for k in range(len(point)):
        moved = [complex(item) for item in point]
        moved[k] += 1e-30j
        columns.append(np.imag(function(*moved)) / 1e-30)
    return np.array(columns).T


def test_a_bouncing_ball_has_the_gradient_of_its_closed_form():
    """Position and speed behind three impacts, by gravity, restitution, start height and speed."""
    found = followed(bouncing_ball(), StepRow(Method.RK4, 0.0, 0.1, 7), 15, by_state=[0, 1])
    assert [event.name for event in found.events] == ["impact"] * 2
    exact = complex_steps(lambda *p: np.array(ball_at(1.5, *p)), [9.81, 0.8, 1.0, 0.0])
    assert found.state_slopes == pytest.approx(exact, rel=1e-9, abs=1e-9)
    impact = complex_steps(
        lambda g, e, h, v: np.array([(v + np.sqrt(v**2 + 2 * g * h)) / g]), [9.81, 0.8, 1.0, 0.0]
    )[0]
    assert found.events[0].slope == pytest.approx(impact, rel=1e-9, abs=1e-12)


def test_constraint_solutions_carry_tangents():
    """A slider-crank, whose rod angle and slider follow from a loop, against differences."""
    equations, grid = slider_crank(), StepRow(Method.RK4, 0.0, 0.1, 10)
    values = np.array([p.value for p in equations.parameters])
    found = followed(equations, grid, 5)

    def end(parameters):
        return followed(equations, grid, 5, parameters=parameters).values[-1]

    for k, value in enumerate(values):
        step = 1e-2 * max(abs(value), 0.1)
        wide, middle, narrow = (
            (end(moved(values, k, h)) - end(moved(values, k, -h))) / (2.0 * h)
            for h in (step, step / 2, step / 4)
        )
        first, second = (4 * middle - wide) / 3, (4 * narrow - middle) / 3
        richardson = (16 * second - first) / 15
        error = np.abs(found.slopes[-1][:, k] - richardson)
        assert np.max(error) < 1e-8 * max(np.max(np.abs(richardson)), 1.0)


def test_a_single_unknown_follows_each_parameter():
    """x'' = -k z with z = a x + b: x = (x_0 + b / a) cos((k a)^(1/2) t) - b / a."""
    t, x, v, z, a, b, k = symbols("t", "x", "v", "z", "a", "b", "k")
    equations = build(
        "bound",
        time=t,
        states=[(x, 0.7), (v, 0.0)],
        rates=[v, -k * z],
        parameters=[(a, 1.3), (b, 0.4), (k, 2.0)],
        outputs=[("z", z)],
        unknowns=[(z, 1.0)],
        residuals=[z - a * x - b],
        blocks=(Block("z", 0, 1, 1e-12),),
    )
    found = followed(equations, StepRow(Method.RK4, 0.0, 0.1, 50), 8)

    def end(a, b, k):
        x = (0.7 + b / a) * np.cos(np.sqrt(k * a) * 0.8) - b / a
        return np.array([a * x + b])

    exact = complex_steps(end, [1.3, 0.4, 2.0])
    assert found.slopes[-1] == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("count", [1, 6, 12, 17, 20, 27, 33])
def test_many_directions_are_sums_of_few(count):
    """Any number of directions, in groups of eight: tangents are linear in them."""
    equations, grid = slider_crank(), StepRow(Method.RK4, 0.0, 0.1, 10)
    few = followed(equations, grid, 3, by_state=[0, 1])
    kernel, code = compile_kernel(equations), TangentCode(equations, range(len(equations.channels)))
    n_p, n_x = len(equations.parameters), len(equations.states)
    mixed = np.random.default_rng(count).normal(size=(n_p + n_x, count))
    start = np.array([s.start for s in equations.states])
    guess = np.array([u.start for u in equations.unknowns])
    many = follow(
        code,
        kernel,
        grid,
        n_intervals=3,
        start=(start, kernel.solve_unknowns(0.0, start, guess)),
        directions=(mixed[:n_p], mixed[n_p:]),
    )
    assert many.slopes == pytest.approx(few.slopes @ mixed, rel=1e-12, abs=1e-12)


def moved(values, k, by):
    """Return values with one of them changed."""
    other = values.copy()
    other[k] += by
    return other


@pytest.mark.parametrize("kept", [64_000_000, 1])
def test_adjoints_agree_with_tangents(kept, monkeypatch):
    """One figure by all parameters and start values; also where few steps are kept."""
    monkeypatch.setattr("vehicledyn.kernel.back_code._MOST_BYTES", kept)
    equations, grid = slider_crank(), StepRow(Method.RK4, 0.0, 0.1, 10)
    ahead = followed(equations, grid, 5, by_state=[0, 1])
    kernel, channel = compile_kernel(equations), 1
    code = TangentCode(equations, [channel], back=True)
    start = np.array([s.start for s in equations.states])
    guess = np.array([u.start for u in equations.unknowns])

    def figure(times, values):
        found = figure_slope("rms", times, values[:, 0], np.eye(len(times)))
        return found, found.slope[:, None]

    back = figure_adjoint(
        code, kernel.parameters, grid, n_intervals=5, start=(start, guess), figure=figure
    )
    expected = figure_slope("rms", ahead.times, ahead.values[:, channel], ahead.slopes[:, channel])
    assert back.figure.value == pytest.approx(expected.value, rel=1e-12)
    found = [*back.by_parameter, *back.by_state]
    assert found == pytest.approx(expected.slope, rel=1e-10, abs=1e-12)
    assert back.n_bytes <= (50 * 4 if kept > 1 else 50) * 8 * 4


def four_bar():
    """Return equations of a four-bar linkage with a spring on its rocker."""

    def bar(name, parent, at, angle, length, role="auto", mass=1.0):
        joint = vd.Joint("R3", f"{name}.angle", angle, role, 4.0 if role != "auto" else 0.0)
        return vd.Body(
            name, parent, (*at, 0.0), (joint,), mass=mass, inertia=(0.02, 0.02, 0.02),
            com=(0.5 * length, 0.0, 0.0),
        )  # fmt: skip

    table = vd.ParameterTable()
    mass = table.add("coupler_mass", 1.3, "kg", "Mass of the coupler")
    reach = table.add("reach", 0.9, "m", "Length of the coupler")
    bodies = (
        bar("crank", vd.GROUND, (0.0, 0.0), 1.2, 0.3, "independent"),
        bar("coupler", "crank", (0.3, 0.0), -0.9, 0.9, mass=mass),
        bar("rocker", vd.GROUND, (0.8, 0.0), 1.3, 0.7),
        bar("flap", "rocker", (0.7, 0.0), 0.4, 0.2, "independent"),
    )
    cuts = (vd.BallCut("pin", "coupler", (reach, 0.0, 0.0), "rocker", (0.7, 0.0, 0.0)),)
    return derive(vd.System("four_bar", table, bodies, cuts, gravity=(0.0, -9.81, 0.0)))


def test_tangents_by_way_of_residuals_are_those_through_the_solution():
    """With accelerations that fulfil an equation, or as functions of the states; also back."""
    equations, grid = four_bar(), StepRow(Method.RK4, 0.0, 0.02, 4)
    channel = next(k for k, c in enumerate(equations.channels) if c.name == "rocker.angle_rate")
    found = []
    for own in (equations, replace(equations, motion_residuals=None)):
        code = TangentCode(own, [channel], back=True)
        assert bool(code.stage.accelerated) == (own is equations)
        kernel, n_x = compile_kernel(own), len(own.states)
        start = np.array([s.start for s in own.states])
        unknowns = kernel.solve_unknowns(0.0, start, np.array([u.start for u in own.unknowns]))
        given = {"n_intervals": 6, "start": (start, unknowns)}
        directions = np.eye(2, 2 + n_x), np.eye(n_x, 2 + n_x, 2)
        ahead = follow(code, kernel, grid, directions=directions, **given)

        def last(times, values):
            seeds = np.zeros((len(times), 1))
            seeds[-1] = 1.0
            return None, seeds

        back = figure_adjoint(code, kernel.parameters, grid, figure=last, **given)
        assert [*back.by_parameter, *back.by_state] == pytest.approx(ahead.slopes[-1, 0], rel=1e-10)
        found.append(ahead)
    assert found[0].values == pytest.approx(found[1].values, rel=1e-13)
    assert found[0].state_slopes == pytest.approx(found[1].state_slopes, rel=1e-10, abs=1e-12)


def test_semi_implicit_euler_has_the_tangents_of_its_own_steps():
    """x'' = -w^2 x: the map of a step is linear, its powers are known."""
    equations = oscillator()
    found = followed(equations, StepRow(Method.SYMPLECTIC_EULER, 0.0, 0.1, 2), 3, by_state=[0, 1])
    step, square = 0.05, 4.0
    matrix = np.array([[1.0 - step**2 * square, step], [-step * square, 1.0]])
    n_p = len(equations.parameters)
    expected = np.linalg.matrix_power(matrix, 6)
    assert found.state_slopes[:, n_p:] == pytest.approx(expected, rel=1e-12)


def test_a_grazing_event_has_no_gradient():
    """A crossing at a turning point is reported."""
    t, place = symbols("t", "place")
    (depth,) = symbols("depth")
    equations = build(
        "grazing",
        time=t,
        states=[(place, 1.0)],
        rates=[2.0 * (t - 1.0)],
        parameters=[(depth, 0.0)],
        outputs=[("place", place)],
    )
    equations = with_events(
        equations, ("touch", place - depth - 1e-15, "falling", False, {0: place + 1.0})
    )
    with pytest.raises(NumericalError, match="grazes"):
        followed(equations, StepRow(Method.RK4, 0.0, 0.5, 1), 4)


def test_an_event_without_reset_moves_its_instant_only():
    """x = cos w t reaches zero at pi/(2 w); the motion goes on as if nothing had been."""
    with_event = followed(
        crossing_oscillator(), StepRow(Method.RK4, 0.0, 0.1, 10), 10, by_state=[0]
    )
    assert with_event.events[0].time == pytest.approx(np.pi / 4, abs=1e-6)
    assert with_event.state_slopes[:, -1] == pytest.approx(
        [np.cos(2.0), -2.0 * np.sin(2.0)], abs=1e-5
    )


def test_an_equilibrium_follows_its_parameters():
    """0 = g - k x^3 / m: dx/dk = -x / (3 k)."""
    t, place, speed = symbols("t", "place", "speed")
    k, m = symbols("stiffness", "mass")
    equations = build(
        "hanging",
        time=t,
        states=[(place, 1.0), (speed, 0.0)],
        rates=[speed, 9.81 - k * place**3 / m],
        parameters=[(k, 50.0), (m, 2.0)],
        outputs=[("place", place)],
        positions=(0,),
        velocities=(1,),
    )
    rest = (9.81 * 2.0 / 50.0) ** (1 / 3)
    code = TangentCode(equations, [])
    point = np.array([rest, 0.0]), np.zeros(0)
    values = np.array([50.0, 2.0])
    balance = BalancedState(values, 0.0, point, ([0], [1]))
    found = start_slopes(code, balance, np.eye(2))
    assert found[0] == pytest.approx([-rest / 150.0, rest / 6.0], rel=1e-12)
    by_state, by_parameter = rate_slopes(code, balance, np.eye(2))
    assert by_state[1] == pytest.approx([-3.0 * 25.0 * rest**2, 0.0])
    assert by_parameter[1] == pytest.approx([-(rest**3) / 2.0, 50.0 * rest**3 / 4.0])


def test_motions_that_diverge_are_refused_as_by_runs():
    """Steps far too long for an oscillator of 1000 rad/s, of which mean squares would be 1e98."""
    with pytest.raises(NumericalError, match="the integration diverges with a step of 5 ms"):
        followed(oscillator(1e6), StepRow(Method.RK4, 0.0, 0.05, 10), 10)


def test_the_peak_is_the_largest_magnitude():
    """Its derivative is that of the magnitude."""
    found = figure_slope("peak", np.arange(3.0), np.array([1.0, -3.0, 2.0]), np.eye(3))
    assert (found.value, *found.slope) == (3.0, 0.0, -1.0, 0.0)
