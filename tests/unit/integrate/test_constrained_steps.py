"""Steps on residuals with multipliers: published digits, orders, condition, constraints."""

import math

import casadi as ca
import numpy as np
import pytest
from chain_examples import chain, damped_pendulum
from scipy.integrate import solve_ivp
from solve_examples import Samples, build, oscillator, starts, symbols

from vehicledyn.analyses.preparation.projection import projected
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.registry import find
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.integrate.newmark.constrained_steps import ConstrainedSteps
from vehicledyn.integrate.newmark.residual_functions import residual_functions
from vehicledyn.integrate.newmark.weights import Weights
from vehicledyn.integrate.simulate import make_task, simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive
from vehicledyn.symbolic.constrained_equations import ConstrainedEquations

GRAVITY = 9.81
METHODS = {
    "genalpha r=0.9": Weights.generalised_alpha(0.9),
    "genalpha r=0.8": Weights.generalised_alpha(0.8),
    "genalpha r=0.5": Weights.generalised_alpha(0.5),
    "hht a=-0.1": Weights.hht(0.9 / 1.1),
    "hht a=-1/3": Weights.hht(0.5),
    "newmark g=0.6 b=0.3025": Weights.newmark(0.3025, 0.6),
    "newmark g=1/2 b=1/4": Weights.newmark(0.25, 0.5),
}

PUBLISHED = [
    (
        "genalpha r=0.9",
        0.02,
        -0.9858967455536,
        -0.16735473434243,
        -0.30143960080037,
        1.786332726893,
        4.8976507065845,
    ),
    (
        "genalpha r=0.9",
        0.005,
        -0.98626727562863,
        -0.16515707984848,
        -0.29718742030817,
        1.7753763835049,
        4.8593547612428,
    ),
    (
        "genalpha r=0.8",
        0.01,
        -0.98618935326209,
        -0.16562173623201,
        -0.29808934982823,
        1.7776932294505,
        4.8691472038727,
    ),
    (
        "genalpha r=0.5",
        0.02,
        -0.98567115376425,
        -0.16867832296135,
        -0.30415657167572,
        1.7913113696272,
        4.9302708201895,
    ),
    (
        "genalpha r=0.5",
        0.005,
        -0.98625496069184,
        -0.16523060403791,
        -0.29734409213058,
        1.7757153703632,
        4.8608505192118,
    ),
    (
        "hht a=-0.1",
        0.01,
        -0.98616786503362,
        -0.16574963642506,
        -0.29841553441439,
        1.7782054435513,
        4.8716197100175,
    ),
    (
        "hht a=-1/3",
        0.02,
        -0.98567115376425,
        -0.16867832296135,
        -0.30415657167572,
        1.7913113696272,
        4.9302708201895,
    ),
    (
        "hht a=-1/3",
        0.005,
        -0.98625496069184,
        -0.16523060403791,
        -0.29734409213058,
        1.7757153703632,
        4.8608505192118,
    ),
    (
        "newmark g=0.6 b=0.3025",
        0.01,
        -0.9831943380662,
        -0.18256202670482,
        -0.3228307982415,
        1.7410278275494,
        4.9734109139732,
    ),
    (
        "newmark g=1/2 b=1/4",
        0.02,
        -0.98590178809022,
        -0.16732502574485,
        -0.30131463723046,
        1.786169782038,
        5.0843442449086,
    ),
    (
        "newmark g=1/2 b=1/4",
        0.005,
        -0.986267579197,
        -0.16515526702136,
        -0.29718327448216,
        1.7753674511475,
        4.8706049929352,
    ),
]
"""Method, step [s], position, velocity and multiplier after 1 s."""


def pendulum():
    """Mass at (x, y) on a rod of length one, as residuals and, for the outputs, as rates."""
    t, x, y, u, v, a, b, m = symbols("t", "x", "y", "u", "v", "a", "b", "m")
    tension = (u**2 + v**2 - GRAVITY * y) / (x**2 + y**2)
    q, qd = ca.vertcat(x, y), ca.vertcat(u, v)
    form = ConstrainedEquations(
        time=t, position=q, velocity=qd, acceleration=ca.vertcat(a, b), multiplier=m,
        other=ca.SX(0, 1), parameter=ca.SX(0, 1),
        force=ca.vertcat(a + x * m, b + GRAVITY + y * m), gap=(x**2 + y**2 - 1.0) / 2.0,
        opening=x * u + y * v, quadratic=u**2 + v**2, jacobian=q.T, other_rate=ca.SX(0, 1),
        labels=("rod",), positions=(0, 1), velocities=(2, 3), others=(),
    )  # fmt: skip
    return build(
        "pendulum",
        time=t,
        states=[(x, 1.0), (y, 0.0), (u, 0.0), (v, 0.0)],
        rates=[u, v, -x * tension, -y * tension - GRAVITY],
        parameters=[],
        outputs=[("energy", 0.5 * (u**2 + v**2) + GRAVITY * y)],
        positions=(0, 1),
        velocities=(2, 3),
        constrained=lambda: form,
    )


@pytest.fixture(scope="module")
def kernel():
    return compile_kernel(pendulum(), backend="interpreted")


def march(kernel, weights, step, count, constraints="index3", state=None, sizes=(1.0,)):
    """Yield the steps and the places from the first on; each twelfth of them has another size."""
    usual, unknowns = starts(kernel.equations)
    state = usual if state is None else state
    span = {"start": 0.0, "stop": step * count, "interval": step}
    task = make_task(kernel, state=state, unknowns=unknowns, sink=Samples(), **span)
    steps = ConstrainedSteps(task, weights, constraints)
    place = steps.start(ConsistentPoint(0.0, task.state, task.unknowns))
    for k in range(count):
        place = steps.step(place, place.point.time + sizes[12 * k // count % len(sizes)] * step)
        yield steps, place


@pytest.mark.parametrize("row", PUBLISHED)
def test_published_steps(kernel, row):
    """Position, velocity and multiplier after 1 s, by an independent program."""
    method, step, *state, multiplier = row
    *_, (_, last) = march(kernel, METHODS[method], step, round(1.0 / step))
    found = [*last.instant.position, *last.instant.velocity]
    assert found == pytest.approx(state, abs=1e-10)
    assert last.instant.multiplier == pytest.approx([multiplier], abs=1e-6)


@pytest.mark.parametrize("constraints", ["index3", "stabilised_index2"])
@pytest.mark.parametrize(
    ("weights", "sizes"),
    [
        (Weights.newmark(0.25, 0.5), (1.0,)),
        (Weights.generalised_alpha(0.6), (1.0,)),
        (Weights.generalised_alpha(0.6), (1.0, 0.5, 2.0, 0.25)),
    ],
)
def test_order_two_from_a_start_in_motion_on(kernel, weights, sizes, constraints):
    """The largest errors of all steps; from velocities on the constraints they are of order 0 or 1.

    The start has an opening speed, which is taken away. Where the size of steps changes, velocities
    of index 3 must miss the constraints by another part, or multipliers miss by O(1).
    """
    stop, fastest, errors = 0.5, 3.0, []
    exact = solve_ivp(
        lambda t, y: [y[1], -GRAVITY * math.cos(y[0])], (0.0, stop), [0.0, -fastest],
        rtol=1e-12, atol=1e-12, method="DOP853", dense_output=True,
    ).sol  # fmt: skip
    for count in (100, 200):
        state = [1.0, 0.0, 0.1, -fastest]
        rows = march(kernel, weights, stop / count, count, constraints, state, sizes)
        row = []
        for _, place in rows:
            angle, rate = exact(place.instant.time)
            x, y = math.cos(angle), math.sin(angle)
            pairs = [
                (place.instant.velocity, [-y * rate, x * rate]),
                (place.instant.multiplier, [rate**2 - GRAVITY * y]),
            ]
            row.append([np.abs(a - np.array(b)).max() for a, b in pairs])
        errors.append(np.max(row, axis=0))
    assert np.log2(np.divide(*errors)) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("step", [0.02, 0.005, 1e-6])
@pytest.mark.parametrize("constraints", ["index3", "stabilised_index2"])
def test_condition_does_not_grow_as_the_step_shrinks(kernel, step, constraints):
    """Unscaled it grows by the fourth power: 2.3e10 at 5 ms; scaled it is the golden ratio's."""
    steps, _ = next(march(kernel, METHODS["genalpha r=0.9"], step, 1, constraints))
    condition = steps.factors.condition()
    if constraints == "index3":
        assert condition == pytest.approx(((1.0 + math.sqrt(5.0)) / 2.0) ** 2, rel=1e-5)
    assert condition < 20.0


def four_bar_state(equations, angle, rate):
    bars = {"upright": (angle, rate), "coupler": (-angle, -rate)}
    names = [s.name for s in equations.states]
    return np.array([bars[n.split("_")[0]][n.endswith("_rate")] for n in names])


@pytest.fixture(scope="module")
def four_bar():
    return compile_kernel(derive(chain(1)), backend="interpreted")


def swing(angle, rate, stop):
    """All uprights turn as one: a pendulum of inertia 5/3 and moment of weight 2 g."""
    found = solve_ivp(
        lambda t, y: [y[1], 1.2 * GRAVITY * math.cos(y[0])], (0.0, stop), [angle, rate],
        rtol=1e-12, atol=1e-12, method="DOP853",
    )  # fmt: skip
    return found.y[:, -1]


def task_of(kernel, angle, rate):
    state = four_bar_state(kernel.equations, angle, rate)
    span = {"start": 0.0, "stop": 1.0, "interval": 0.5}
    return make_task(kernel, state=state, unknowns=[], sink=Samples(), **span)


def test_channels_of_steps_are_those_of_the_equations_on_the_constraints(four_bar):
    task = task_of(four_bar, 1.2, 3.0)
    steps = ConstrainedSteps(task, Weights.hht(0.8), "index3")
    place = steps.start(ConsistentPoint(0.0, task.state, task.unknowns))
    expected = four_bar.outputs(0.0, task.state, task.unknowns)
    assert steps.outputs(place) == pytest.approx(expected, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("constraints", ["index3", "stabilised_index2"])
@pytest.mark.parametrize(
    "weights", [Weights.newmark(0.25, 0.5), Weights.hht(0.8), Weights.generalised_alpha(0.8)]
)
def test_order_two_in_positions_velocities_and_multipliers(four_bar, weights, constraints):
    """Against the pendulum that the four-bar is, through whose forces the multipliers follow."""
    begin, stop = (1.2, 3.0), 0.5
    task = task_of(four_bar, *begin)
    steps = ConstrainedSteps(task, weights, constraints)
    exact = four_bar_state(four_bar.equations, *swing(*begin, stop))
    exact = steps.start(ConsistentPoint(stop, exact, task.unknowns)).instant
    errors = []
    for count in (40, 80):
        place = steps.start(ConsistentPoint(0.0, task.state, task.unknowns))
        for k in range(1, count + 1):
            place = steps.step(place, stop * k / count)
        fields = ("position", "velocity", "multiplier")
        pairs = [(getattr(place.instant, f), getattr(exact, f)) for f in fields]
        errors.append([np.abs(a - b).max() for a, b in pairs])
    slopes = np.log2(np.divide(*errors))
    assert slopes == pytest.approx(2.0, abs=0.05)


def test_stabilised_steps_keep_positions_and_velocities_on_the_constraints(four_bar):
    steps = ConstrainedSteps(
        task_of(four_bar, 1.2, 3.0), Weights.generalised_alpha(0.8), "stabilised_index2"
    )
    place = steps.start(
        ConsistentPoint(0.0, four_bar_state(four_bar.equations, 1.2, 3.0), np.zeros(0))
    )
    for k in range(1, 51):
        place = steps.step(place, 0.01 * k)
    left = residual_functions(four_bar).residuals(place.instant, four_bar.parameters)
    assert np.abs(left.gap).max() < 1e-12
    assert np.abs(left.opening).max() < 1e-9


@pytest.mark.long
@pytest.mark.parametrize("constraints", ["index3", "stabilised_index2"])
def test_undamped_newmark_keeps_the_energy_of_a_four_bar(four_bar, constraints):
    """It swings about its lowest place for 30 s; the energy stays in a band and does not drift."""
    task = task_of(four_bar, 0.5 * math.pi, 3.0)
    steps = ConstrainedSteps(task, Weights.newmark(0.25, 0.5), constraints)
    place = steps.start(ConsistentPoint(0.0, task.state, task.unknowns))
    names = [s.name for s in four_bar.equations.states]
    columns = [names.index(f"upright_0.{n}") for n in ("angle", "angle_rate")]
    energies = []
    for k in range(1, 1501):
        place = steps.step(place, 0.02 * k)
        angle, rate = place.point.state[columns]
        energies.append(0.5 * 5.0 / 3.0 * rate**2 - 2.0 * GRAVITY * math.sin(angle))
    bands = np.array(energies).reshape(5, -1)
    width = np.ptp(bands)
    assert width < 2e-3 * 7.5
    assert np.ptp(bands.max(axis=1)) < 0.02 * width
    assert np.ptp(bands.min(axis=1)) < 0.02 * width


def test_first_order_states_and_events_belong_to_the_steps():
    """The motion on residuals is that on rates, for a system that needs no multipliers."""
    system = damped_pendulum()
    kernel = compile_kernel(derive(system), backend="interpreted")
    ends = []
    for constraints in ("reduced", "index3"):
        samples = Samples()
        solver = find("solver", "generalised_alpha")(step=0.01, constraints=constraints)
        state, unknowns = starts(kernel.equations)
        span = {"start": 0.0, "stop": 0.5, "interval": 0.1}
        simulate(kernel, solver, state=state, unknowns=unknowns, sink=samples, **span)
        ends.append(samples.states[-1])
    assert ends[0] == pytest.approx(ends[1], abs=1e-10)
    assert abs(ends[0][0] - 0.5) > 0.1


def test_equations_without_residuals_are_refused():
    kernel = compile_kernel(oscillator(), backend="interpreted")
    solver = find("solver", "hht")(step=0.1, constraints="index3")
    span = {"start": 0.0, "stop": 1.0, "interval": 0.1}
    with pytest.raises(InputError, match="must be 'reduced'"):
        simulate(kernel, solver, state=[1.0, 0.0], unknowns=[], sink=Samples(), **span)


def test_loops_closed_by_partitioning_are_refused():
    kernel = compile_kernel(derive(chain(1, method="partitioning")), backend="interpreted")
    state, unknowns = starts(kernel.equations)
    solver = find("solver", "hht")(step=0.1, constraints="index3")
    span = {"start": 0.0, "stop": 1.0, "interval": 0.1}
    with pytest.raises(InputError, match="constraint_method: multipliers"):
        simulate(kernel, solver, state=state, unknowns=unknowns, sink=Samples(), **span)


@pytest.mark.parametrize("constraints", ["reduced", "index3", "stabilised_index2"])
def test_tolerance_controls_the_error(constraints):
    """Against the pendulum that the four-bar is; local errors are of order three."""
    method = "partitioning" if constraints == "reduced" else "multipliers"
    kernel = compile_kernel(derive(chain(1, method=method)), backend="interpreted")
    names = [s.name for s in kernel.equations.states]
    exact = swing(1.2, 3.0, 1.0)
    found = []
    for tolerance in (1e-5, 1e-7):
        samples = Samples()
        solver = find("solver", "generalised_alpha")(
            step=0.5, tolerance=tolerance, constraints=constraints
        )
        state = four_bar_state(kernel.equations, 1.2, 3.0)
        unknowns = [-1.2 if "coupler" in u.name else 1.2 for u in kernel.equations.unknowns]
        span = {"start": 0.0, "stop": 1.0, "interval": 0.5}
        took = simulate(kernel, solver, state=state, unknowns=unknowns, sink=samples, **span)
        end = samples.states[-1]
        angle, rate = (end[names.index(f"upright_0.{n}")] for n in ("angle", "angle_rate"))
        error = max(abs(angle - exact[0]), abs(rate - exact[1]) / (1.0 + abs(exact[1])))
        found.append((error / tolerance ** (2.0 / 3.0), took.steps))
    assert all(0.05 < error < 2.0 for error, _ in found)
    assert 3.0 < found[1][1] / found[0][1] < 7.0


@pytest.mark.parametrize("constraints", ["index3", "stabilised_index2"])
def test_steps_that_change_size_do_not_shrink_to_nothing(constraints):
    """Velocities of index 3 miss the constraints, which shows in a where the step changes."""
    kernel = compile_kernel(derive(chain(1, last=0.8)), backend="interpreted")
    e = kernel.equations
    state = np.array(starts(e)[0])
    state[e.velocities[0]] = 6.0
    state = projected(kernel, state, kernel.outputs(0.0, state, np.zeros(0)))
    samples = Samples()
    solver = find("solver", "generalised_alpha")(step=0.05, tolerance=1e-6, constraints=constraints)
    span = {"start": 0.0, "stop": 1.1, "interval": 0.05}
    took = simulate(kernel, solver, state=state, unknowns=[], sink=samples, **span)
    names = [c.name for c in e.channels]
    columns = [names.index(f"energy.{kind}") for kind in ("kinetic", "gravity")]
    energy = samples.outputs[:, columns].sum(axis=1)
    assert np.ptp(samples.outputs[:, columns[0]]) > 0.5
    assert energy == pytest.approx(energy[0], abs=0.05)
    assert took.steps < 1500


def test_error_that_no_step_meets_is_reported():
    """A force that grows beyond all bounds in finite time."""
    t, x, v = symbols("t", "x", "v")
    rates = [v, ca.fabs(0.53 - t) ** -1.5]
    states = [(x, 1.0), (v, 0.0)]
    places = {"positions": (0,), "velocities": (1,)}
    equations = build(
        "grows", time=t, states=states, rates=rates, parameters=[], outputs=[("x", x)], **places
    )
    kernel = compile_kernel(equations, backend="interpreted")
    solver = find("solver", "generalised_alpha")(step=0.1, tolerance=1e-4)
    span = {"start": 0.0, "stop": 1.0, "interval": 0.1}
    with pytest.raises(NumericalError, match=r"t = 0\.5299.*error stays too large"):
        simulate(kernel, solver, state=[1.0, 0.0], unknowns=[], sink=Samples(), **span)


def test_stabilised_steps_of_fast_motions_converge(four_bar):
    """Links turn by half a radian in a step, so that the Jacobians of its ends differ much."""
    steps = ConstrainedSteps(
        task_of(four_bar, 1.2, 60.0), Weights.newmark(0.25, 0.5), "stabilised_index2"
    )
    place = steps.start(
        ConsistentPoint(0.0, four_bar_state(four_bar.equations, 1.2, 60.0), np.zeros(0))
    )
    for k in range(1, 101):
        place = steps.step(place, 0.008 * k)
        assert place is not None, k
