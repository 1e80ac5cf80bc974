"""Second derivatives of motions along a direction, against closed forms and differences."""

from dataclasses import replace

import numpy as np
import pytest
from solve_examples import build, slider_crank, symbols

import vehicledyn as vd
from vehicledyn.analyse.gradients.adjoint import EventPassedError, figure_adjoint
from vehicledyn.analyse.gradients.curvature import CurvatureCode
from vehicledyn.analyse.gradients.key_figures import figure_slope
from vehicledyn.base.errors import InputError
from vehicledyn.kernel.engine import Method
from vehicledyn.kernel.tangent_code import StepRow, TangentCode
from vehicledyn.symbolic.equations import Event

pytestmark = pytest.mark.usefixtures("needs_compiler")


def fading():
    """A state x that fades, x' = -p x, from two."""
    t, x, p = symbols("t", "position", "rate")
    return build(
        "fading", time=t, states=[(x, 2.0)], rates=[-p * x], parameters=[(p, 0.7)],
        outputs=[("position", x)],
    )  # fmt: skip


def ending_below(limit):
    """The same, ending where the state falls below a limit."""
    equations = fading()
    end = Event("end", 0, "falling", terminal=True)
    return replace(equations, event=equations.state - limit, events=(end,))


def gradient(equations, grid, n_intervals, kind, point, channel=0):
    """Return the derivatives of a figure by parameters and start states, by adjoints."""
    parameters, state = point
    guess = np.array([u.start for u in equations.unknowns])

    def figure(times, values):
        found = figure_slope(kind, times, values[:, 0], np.eye(len(times)))
        return found, found.slope[:, None]

    code = TangentCode(equations, [channel], back=True)
    found = figure_adjoint(
        code, parameters, grid, n_intervals=n_intervals, start=(state, guess), figure=figure
    )
    return np.concatenate([found.by_parameter, found.by_state])


def test_second_derivatives_of_steps_in_closed_form():
    """A step of rk4 multiplies by R(h p) = 1 - z + z²/2 - z³/6 + z⁴/24, so the end is R⁶ x."""
    equations, grid, h, n = fading(), StepRow(Method.RK4, 0.0, 0.5, 2), 0.25, 6
    p, x, z = 0.7, 2.0, 0.7 * 0.25
    r = 1 - z + z**2 / 2 - z**3 / 6 + z**4 / 24
    slope, bend = h * (-1 + z - z**2 / 2 + z**3 / 6), h * h * (1 - z + z**2 / 2)
    by_p = n * r ** (n - 1) * slope
    by_pp = n * (n - 1) * r ** (n - 2) * slope**2 + n * r ** (n - 1) * bend
    found = CurvatureCode(equations, [0]).along(
        (np.array([p]), np.array([0.3])),
        grid,
        n_intervals=3,
        start=(np.array([x]), np.zeros(0), np.array([-1.1])),
        figure=("final", 0),
    )
    assert found.figure.value == pytest.approx(r**n * x, rel=1e-14)
    assert found.figure.slope == pytest.approx([0.3 * by_p * x - 1.1 * r**n], rel=1e-13)
    assert np.concatenate(found.slope) == pytest.approx([by_p * x, r**n], rel=1e-13)
    expected = [0.3 * by_pp * x - 1.1 * by_p, 0.3 * by_p]
    assert np.concatenate(found.curvature) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("kind", ["rms", "mean_square", "mean", "integral", "max", "initial"])
def test_second_derivatives_are_those_of_the_gradient(kind):
    """A slider-crank with its loop, every kind of figure, against Richardson's differences."""
    equations, grid = slider_crank(), StepRow(Method.RK4, 0.0, 0.1, 10)
    p, x = (np.array([i.value for i in equations.parameters]), np.array([0.3, 5.0]))
    rng = np.random.default_rng(3)
    by_p, by_x = rng.normal(size=p.size), rng.normal(size=x.size)
    found = CurvatureCode(equations, [1]).along(
        (p, by_p), grid, n_intervals=5, start=(x, np.array([u.start for u in equations.unknowns]),
        by_x), figure=(kind, 0),
    )  # fmt: skip

    def difference(h):
        sides = (
            gradient(equations, grid, 5, kind, (p + s * by_p, x + s * by_x), 1) for s in (h, -h)
        )
        return np.subtract(*sides) / (2.0 * h)

    wide, middle, narrow = map(difference, (2e-3, 1e-3, 5e-4))
    richardson = (16 * (4 * narrow - middle) / 3 - (4 * middle - wide) / 3) / 15
    size = max(np.abs(richardson).max(), 1e-6)
    assert np.concatenate(found.curvature) == pytest.approx(richardson, abs=1e-9 * size)
    assert np.concatenate(found.slope) == pytest.approx(
        gradient(equations, grid, 5, kind, (p, x), 1), rel=1e-11, abs=1e-12
    )


def test_adjoints_pass_by_events_that_do_not_happen():
    """Events that end a run, such as turning over, change nothing unless they happen."""
    given = StepRow(Method.RK4, 0.0, 0.5, 2), 3, "rms", (np.array([0.7]), np.array([2.0]))
    found = gradient(ending_below(0.01), *given)
    assert found == pytest.approx(gradient(fading(), *given), rel=1e-14)
    with pytest.raises(EventPassedError, match=r"'end' happens before t = 1 s"):
        gradient(ending_below(1.0), *given)


def test_a_start_in_balance_bends_with_the_parameters():
    """The height of a quarter car at rest falls by its weight over its stiffness."""
    settings = {"start": "static", "duration": "0.1 s", "solver": {"kind": "rk4", "step": "2 ms"}}
    names = ["body.stiffness", "body.mass"]
    found = vd.sensitivity(
        "quarter_car",
        "initial(body.height)",
        names,
        along={"body.stiffness": "2 N/m"},
        set=settings,
    )
    stiffness, mass = found["parameter_value"].values
    expected = 2.0 * np.array([-2.0 * mass * 9.81 / stiffness**3, 9.81 / stiffness**2])
    assert found["figure_curvature"].values[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("of", "along", "match"),
    [
        ("upper.angle", {"mass": 1.0}, r"such as rms\(upper\.angle\)"),
        ("rms(upper.angle)", {"mass": "1 m"}, "along.mass: "),
        ("rms(upper.angle)", {"mess": 1.0}, "did you mean 'mass'"),
        ("eigenvalues", {"mass": 1.0}, "along: second derivatives are those of"),
    ],
)
def test_directions_without_second_derivatives_are_refused(of, along, match):
    """What they are of, and along which directions, is checked before anything runs."""
    with pytest.raises(InputError, match=match):
        vd.sensitivity("double_pendulum", of, along=along, duration="0.5 s")
