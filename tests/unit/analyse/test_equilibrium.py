"""Assembly of loops, equilibria, linearisation and eigenmodes."""

import casadi as ca
import numpy as np
import pytest
from solve_examples import (
    build,
    double_pendulum,
    exact_slider_crank,
    oscillator,
    slider_crank,
    starts,
    symbols,
)

from vehicledyn.analyse.equilibrium import assemble, find_equilibrium
from vehicledyn.analyse.linearise import linearise
from vehicledyn.analyse.modes import eigenmodes
from vehicledyn.analyse.newton import settle, solve_damped
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.kernel.make_kernel import compile_kernel


def turned_pendulum(torque):
    """Pendulum with a constant torque: no equilibrium where the torque exceeds m g l = 10."""
    t, angle, rate, load = symbols("t", "angle", "rate", "torque")
    return build(
        "turned_pendulum",
        time=t,
        states=[(angle, 0.2), (rate, 0.0)],
        rates=[rate, load - 10.0 * ca.sin(angle)],
        parameters=[(load, torque)],
        outputs=[("height", -ca.cos(angle))],
    )


def balance(equations, free, balanced, state=None):
    kernel = compile_kernel(equations, backend="interpreted")
    start, unknowns = starts(equations)
    return find_equilibrium(
        equations,
        kernel,
        time=0.0,
        state=start if state is None else state,
        unknowns=unknowns,
        free=free,
        balanced=balanced,
        tolerance=1e-10,
    )


@pytest.mark.parametrize("torque", [0.0, 3.0, 9.9, 9.99999])
def test_equilibrium_of_a_pendulum(torque):
    point = balance(turned_pendulum(torque), [0], [1])
    # near the largest torque the angle is worth the root of the residual
    assert np.sin(point.state[0]) == pytest.approx(torque / 10.0, abs=1e-11)
    assert abs(point.residual) <= 1e-10


def test_equilibrium_that_does_not_exist():
    with pytest.raises(NumericalError, match=r"no equilibrium .*rate \(2 1/s\)"):
        balance(turned_pendulum(12.0), [0], [1])


def test_what_nothing_holds_is_named():
    """Two bodies joined by a spring, one of them drawn along: they move off together."""
    t, x, y, u, v = symbols("t", "x", "y", "u", "v")
    spring = 5.0 * (y - x)
    equations = build(
        "pair",
        time=t,
        states=[(x, 0.0), (y, 0.1), (u, 0.0), (v, 0.0)],
        rates=[u, v, spring + 1e-3, -2.0 * spring],
        parameters=[],
        outputs=[("length", y - x)],
    )
    with pytest.raises(NumericalError, match=r"nothing holds (x, y|y, x): hold them by"):
        balance(equations, [0, 1], [2, 3])


def test_equilibrium_through_loops():
    equations = double_pendulum()
    point = balance(equations, [0, 1], [2, 3])
    assert point.state == pytest.approx([0.0, 0.0, 0.0, 0.0], abs=1e-12)
    assert point.unknowns == pytest.approx([0.0, -1.0, 0.0, -1.8], abs=1e-12)


def test_newton_does_not_leap_to_a_solution_far_off():
    def sine(point):
        return np.sin(point), np.diag(np.cos(point))

    leap = solve_damped(sine, np.array([1.5]), tolerance=1e-12)
    near = solve_damped(sine, np.array([1.5]), tolerance=1e-12, largest_step=0.5)
    assert leap.solved and abs(leap.point[0]) > 6.0
    assert near.solved and near.point == pytest.approx([0.0], abs=1e-12)


def test_compiled_equations_settle_without_exact_slopes(needs_compiler):
    """Through loops, too: differences lead near the equilibrium, and exact slopes onto it."""
    equations, asked = slider_crank(), []
    state, unknowns = starts(equations)

    class Counted(Derivatives):
        def total(self, *point):
            asked.append(point)
            return super().total(*point)

    def found(backend):
        return find_equilibrium(
            equations,
            compile_kernel(equations, backend=backend),
            time=0.0,
            state=state,
            unknowns=unknowns,
            free=[0],
            balanced=[1],
            tolerance=1e-10,
            derivatives=Counted(equations),
            settling=1e-3,
        )

    points = [found("interpreted")]
    needed = len(asked)
    points.append(found("compiled"))
    assert np.abs(points[0].state - points[1].state).max() <= 1e-12
    assert np.abs(points[0].unknowns - points[1].unknowns).max() <= 1e-12
    assert len(asked) - needed < needed // 2


@pytest.mark.parametrize("height", [0.0, 0.05, 0.4])
def test_settling_takes_few_steps_whatever_the_way(height):
    """A weight above a thin layer that carries it: below the layer there is nothing."""
    asked = []

    def evaluate(point):
        asked.append(point)
        depth = height - point[0]
        carries = 0.0 < depth < 0.04
        force = -10.0 + (2000.0 * depth if carries else 0.0)
        return np.array([force]), np.array([[-2000.0 if carries else 0.0]])

    found = settle(evaluate, np.array([height + 0.4]), longest=1e-3)
    assert found[0] == pytest.approx(height - 0.005, abs=1e-7)
    assert len(asked) < 60


def test_what_nothing_moves_is_left_unbalanced_without_warnings():
    found = solve_damped(lambda _: (np.array([5.0]), np.zeros((1, 1))), np.zeros(1), tolerance=1e-9)
    assert not found.solved and found.residual == pytest.approx([5.0])


def test_equilibrium_needs_as_many_rates_as_states():
    with pytest.raises(ValueError, match="1 free states cannot balance 2 rates"):
        balance(turned_pendulum(1.0), [0], [0, 1])


@pytest.mark.parametrize("guess", [(0.0, 0.0), (0.4, -3.0), (-0.9, 10.0)])
def test_assembly_from_a_rough_guess(backend, guess):
    kernel = compile_kernel(slider_crank(), backend=backend)
    unknowns = assemble(kernel, 0.0, [0.9, 0.0], guess)
    assert unknowns == pytest.approx(exact_slider_crank(0.9), abs=1e-12)


def test_assembly_that_is_impossible_says_what_remains(backend):
    """Crank 1 m at 90 degrees and rod 0.5 m: at best the rod's end misses by 0.5 m."""
    kernel = compile_kernel(slider_crank(rod=0.5), backend=backend)
    with pytest.raises(NumericalError, match=r"'crank loop' .* cannot be closed: 0\.5 m remain"):
        assemble(kernel, 0.0, [np.pi / 2, 0.0], [0.8, 0.3])


def test_linearisation_equals_differences_along_the_loops():
    equations = double_pendulum()
    kernel = compile_kernel(equations, backend="interpreted")
    state = np.array([0.4, 0.7, -1.1, 0.3])
    unknowns = assemble(kernel, 0.0, state, starts(equations)[1])
    linear = linearise(equations, kernel.parameters, 0.0, state, unknowns)

    def both(x):
        z = kernel.solve_unknowns(0.0, x, unknowns)
        return np.concatenate([kernel.rates(0.0, x, z), kernel.outputs(0.0, x, z)])

    step = 1e-5
    columns = [(both(state + step * e) - both(state - step * e)) / (2 * step) for e in np.eye(4)]
    differences = np.stack(columns, axis=1)
    exact = np.vstack([linear.matrix, linear.output_matrix])
    assert exact == pytest.approx(differences, abs=1e-8)
    assert linear.names == ("upper.angle", "lower.angle", "upper.rate", "lower.rate")
    assert linear.channels == ("energy", "tip.x", "tip.y")


def test_modes_of_a_damped_oscillator():
    equations = oscillator(stiffness=9.0, damping=0.6)
    parameters = [p.value for p in equations.parameters]
    linear = linearise(equations, parameters, 0.0, [0.0, 0.0], [])
    (mode,) = eigenmodes(linear.matrix, linear.names)
    assert mode.eigenvalue == pytest.approx(complex(-0.3, np.sqrt(9.0 - 0.09)), rel=1e-14)
    assert mode.frequency == pytest.approx(3.0 / (2 * np.pi), rel=1e-14)
    assert mode.damping_ratio == pytest.approx(0.1, rel=1e-13)
    assert mode.shape[1] == pytest.approx(1.0)
    assert mode.shape[0] == pytest.approx(1.0 / mode.eigenvalue, rel=1e-13)
    assert set(mode.dominant) == {"position", "velocity"}
    assert mode.is_oscillation


@pytest.mark.parametrize("noise", [0.0, 1e-14])
def test_free_motions_are_exact_zeros(noise):
    """A car's plane: positions and heading move nothing; rounding must not split their zeros."""
    names = ["x", "y", "heading", "side_speed", "yaw_rate", "held"]
    a = np.zeros((6, 6))
    a[0, 2], a[1, 2], a[1, 3], a[2, 4] = -0.1, 20.0, 1.0, 1.0
    a[3:5, 3:5] = [[-5.0, -19.0], [3.0, -6.0]]
    a[3:5, 5] = [80.0, 50.0]
    a[3:5, :3] = noise * np.array([[1.0, -2.0, 3.0], [-1.0, 0.5, 2.0]])
    modes = eigenmodes(a, names)
    zeros = [mode for mode in modes if mode.is_zero]
    assert {mode.dominant[0] for mode in zeros} == {"x", "y", "heading", "held"}
    (pair,) = [mode for mode in modes if not mode.is_zero]
    exact = np.linalg.eigvals(a[3:5, 3:5])
    assert pair.eigenvalue == pytest.approx(exact[exact.imag > 0][0], rel=1e-12)
    assert np.abs(a @ pair.shape - pair.eigenvalue * pair.shape).max() < 1e-11
    assert set(pair.dominant) == {"side_speed", "yaw_rate"}


def test_modes_are_sorted_and_satisfy_their_definition():
    rng = np.random.default_rng(3)
    a = rng.normal(size=(9, 9))
    modes = eigenmodes(a, [f"s{k}" for k in range(9)])
    assert sum(2 if mode.is_oscillation else 1 for mode in modes) == 9
    assert [mode.frequency for mode in modes] == sorted(mode.frequency for mode in modes)
    for mode in modes:
        assert np.abs(a @ mode.shape - mode.eigenvalue * mode.shape).max() < 1e-12
