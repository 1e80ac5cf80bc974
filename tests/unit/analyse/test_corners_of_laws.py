"""Derivatives of motions that pass corners and jumps of laws, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from solve_examples import build, symbols
from test_motion_gradients import followed

from vehicledyn.analyse.gradients.adjoint import figure_adjoint
from vehicledyn.analyse.gradients.corner_functions import CornerFunctions
from vehicledyn.analyse.gradients.corner_passages import CornerMissedError, corner_passages
from vehicledyn.analyse.gradients.curvature import CurvatureCode
from vehicledyn.analyse.gradients.key_figures import figure_slope
from vehicledyn.analyses.sensitivity.curvature import undivided
from vehicledyn.codegen.passes.branch_functions import BranchFunctions
from vehicledyn.kernel.branch_watch import BranchWatch
from vehicledyn.kernel.engine import Method
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.kernel.tangent_code import StepRow, TangentCode
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Block, Event, with_tables
from vehicledyn.symbolic.tables import CurveTable

pytestmark = pytest.mark.usefixtures("needs_compiler")

STEPS = StepRow(Method.RK4, 0.0, 0.01, 40)


def pushed(*, tick=None):
    """A mass: pushed from a time on, kicked from a place on and stopped from another on.

    Both places are compared with an unknown that is the mass's. A tick is an event at a time, which
    changes nothing.
    """
    t, x, v, w = symbols("t", "x", "v", "w")
    names = "mass", "push", "on", "kick", "edge", "stop", "gap"
    mass, push, on, kick, edge, stop, gap = parameters = symbols(*names)
    force = ops.where(t > on, push, 0.0) + ops.where(w > edge, kick, 0.0)
    equations = build(
        "pushed",
        time=t,
        states=[(x, 0.0), (v, 1.0)],
        rates=[v, (force - stop * ops.maximum(w - gap, 0.0)) / mass],
        parameters=list(
            zip(parameters, (1.3, 8.0, 0.0337, -5.0, 0.071, 900.0, 0.118), strict=True)
        ),
        outputs=[("x", x), ("v", v)],
        unknowns=[(w, 0.0)],
        residuals=[w + 0.1 * w**3 - x - 0.1 * x**3],
        blocks=(Block("w", 0, 1, 1e-12),),
        positions=(0,),
        velocities=(1,),
    )
    if tick is None:
        return equations
    event = Event("tick", 0, "rising", resets=((1, 0),))
    return replace(equations, event=ops.stacked(t - tick), reset=ops.stacked(v), events=(event,))


def pushed_to(time, mass, push, on, kick, edge, stop, gap):
    """Return place and speed of the mass in the stop, in closed form."""
    x, v, begin = on, 1.0, on
    for force, place in ((push, edge), (push + kick, gap)):
        later = np.sqrt(v**2 + 2.0 * force / mass * (place - x))
        begin, x, v = begin + (later - v) * mass / force, place, later
    frequency, rest = np.sqrt(stop / mass), gap + (push + kick) / stop
    phase = frequency * (time - begin)
    turned = (x - rest) * np.cos(phase) + v / frequency * np.sin(phase)
    return rest + turned, v * np.cos(phase) - (x - rest) * frequency * np.sin(phase)


def complex_steps(function, values):
    """Return the derivatives of two numbers by all values."""
    columns = []
    for k in range(len(values)):
        moved = np.array(values, dtype=complex)
        moved[k] += 1e-40j
        columns.append([item.imag / 1e-40 for item in function(*moved)])
    return np.array(columns).T


def test_derivatives_behind_corners_and_jumps_are_those_of_the_motion():
    """Whole steps over them miss these by some per cent."""
    equations = pushed()
    motion = followed(equations, STEPS, 16)
    values = [p.value for p in equations.parameters]
    assert motion.values[-1] == pytest.approx(pushed_to(0.16, *values), rel=1e-9)
    exact = complex_steps(lambda *p: pushed_to(0.16, *p), values)
    assert motion.slopes[-1] == pytest.approx(exact, rel=1e-8)
    assert [corner.time for corner in motion.corners] == pytest.approx(
        [0.0335, 0.06725, 0.105], abs=1e-9
    )
    assert max(corner.missed for corner in motion.corners) > 1e-6


@pytest.mark.parametrize("tick", [0.0201, 0.03365, 0.03374, 0.0674])
def test_corners_in_steps_with_events_and_behind_are_passed_as_well(tick):
    """The event lies steps before the first corner, or in a step with one, on either side."""
    equations = pushed(tick=tick)
    motion = followed(equations, STEPS, 16)
    values = [p.value for p in equations.parameters]
    exact = complex_steps(lambda *p: pushed_to(0.16, *p), values)
    assert motion.slopes[-1] == pytest.approx(exact, rel=1e-8)
    assert (len(motion.events), len(motion.corners)) == (1, 3)


def lined(third):
    """A mass on a spring of straight lines, by a table; the first line has a slope of 40."""
    t, x, v, m = symbols("t", "x", "v", "m")
    rows = np.array([[0.0, 4.0], [4.0, 9.0], [13.0, third]])
    table = CurveTable("lines", 0.0, 0.1, rows)
    equations = build(
        "lined",
        time=t,
        states=[(x, 0.05), (v, 1.5)],
        rates=[v, -table.value(x) / m],
        parameters=[(m, 0.8)],
        outputs=[("x", x), ("v", v)],
        positions=(0,),
        velocities=(1,),
    )
    return with_tables(equations), table


def lined_to(time, m, x, v):
    """Return place and speed on the second line."""
    for slope, rest, end in ((40.0, 0.0, 0.1), (90.0, 0.1 - 4.0 / 90.0, None)):
        frequency = np.sqrt(slope / m)
        size = np.sqrt((x - rest) ** 2 + (v / frequency) ** 2)
        begin = np.arcsin((x - rest) / size)
        if end is None:
            phase = begin + frequency * time
            return rest + size * np.sin(phase), size * frequency * np.cos(phase)
        phase = np.arcsin((end - rest) / size)
        time, x, v = time - (phase - begin) / frequency, end, size * frequency * np.cos(phase)
    return None


def test_tables_of_straight_lines_have_corners():
    """Where the slope changes; splines have none."""
    equations, _ = lined(9.0)
    motion = followed(equations, STEPS, 8, by_state=[0, 1])
    exact = complex_steps(lambda *p: lined_to(0.08, *p), (0.8, 0.05, 1.5))
    assert motion.slopes[-1] == pytest.approx(exact, rel=1e-8)
    assert len(motion.corners) == 1
    functions = CornerFunctions(BranchFunctions.of(equations))
    assert list(functions.is_table) == [True]
    states = np.array([[0.05, 0.0], [0.1, 0.0], [9.0, 0.0]])
    places = [functions.at(0.0, state, np.zeros(0), np.ones(1)) for state in states]
    assert np.ravel(places) == pytest.approx([1.5, 2.0, 4.0])
    watch = BranchWatch(TangentCode(equations, [0]), np.ones(1))
    assert np.array_equal(watch.values(np.zeros(3), states, np.zeros((3, 0))), places)
    smooth = CurveTable.through("smooth", 0.0, 0.1, [0.0, 1.0, 0.0, 2.0])
    x = ops.symbol("x")
    equations = build(
        "s",
        time=ops.symbol("t"),
        states=[(x, 0.0)],
        rates=[smooth.value(x)],
        parameters=[],
        outputs=[],
    )
    assert BranchFunctions.of(with_tables(equations)).count == 0


def test_a_motion_that_is_smooth_across_a_corner_of_its_laws_is_not_divided():
    """That of |x| x, whose slope does not jump; its steps stay as they are."""
    t, x, v, k = symbols("t", "x", "v", "k")
    equations = build(
        "bent",
        time=t,
        states=[(x, -0.1), (v, 1.0)],
        rates=[v, -k * ops.absolute(x) * x],
        parameters=[(k, 30.0)],
        outputs=[("x", x)],
        positions=(0,),
        velocities=(1,),
    )
    motion = followed(equations, STEPS, 20)
    assert motion.corners == []


def runs_over(n_stops, distance):
    """A mass that runs over soft stops, one by one."""
    t, x, v, m = symbols("t", "x", "v", "m")
    force = sum(ops.maximum(x - (k + 0.3) * distance, 0.0) for k in range(n_stops))
    return build(
        "stops",
        time=t,
        states=[(x, 0.0), (v, 1.0)],
        rates=[v, -force / m],
        parameters=[(m, 0.8)],
        outputs=[("x", x)],
        positions=(0,),
        velocities=(1,),
    )


def test_a_motion_whose_laws_change_their_branches_all_the_time_is_not_divided():
    """However seldom each of them does: its steps stay whole, as cheap as they were."""
    step = STEPS.interval / STEPS.per_interval
    assert len(followed(runs_over(12, 4.0 * step), STEPS, 2).corners) == 12
    assert followed(runs_over(20, 4.0 * step), STEPS, 2).corners == []


def test_a_motion_that_begins_at_a_corner_up_to_rounding_does_not_pass_it():
    """Nor does it find one there when it passes another in its first step."""
    t, x, v, m = symbols("t", "x", "v", "m")
    edge = 0.4 * STEPS.interval / STEPS.per_interval

    def found(start):
        force = 9.0 * ops.absolute(x) + 70.0 * ops.maximum(x - edge, 0.0)
        equations = build(
            "begun",
            time=t,
            states=[(x, start), (v, 1.0)],
            rates=[v, -force / m],
            parameters=[(m, 0.8)],
            outputs=[("x", x)],
            positions=(0,),
            velocities=(1,),
        )
        return followed(equations, STEPS, 2)

    exact, rounded = found(0.0), found(-1e-15)
    assert len(exact.corners) == 1
    assert [item.missed for item in rounded.corners] == pytest.approx(
        [item.missed for item in exact.corners], rel=1e-6
    )


@pytest.mark.parametrize("kept", [64_000_000, 1])
def test_adjoints_pass_corners_as_tangents_do(kept, monkeypatch):
    """With the derivatives of the divided steps, by all parameters and start values."""
    monkeypatch.setattr("vehicledyn.kernel.back_code._MOST_BYTES", kept)
    equations = pushed()
    ahead = followed(equations, STEPS, 16, by_state=[0, 1])
    kernel, code = compile_kernel(equations), TangentCode(equations, [0], back=True)
    start = np.array([0.0, 1.0]), np.array([0.0])

    def figure(times, values):
        found = figure_slope("rms", times, values[:, 0], np.eye(len(times)))
        return found, found.slope[:, None]

    passages = corner_passages(kernel, code, STEPS, start, ahead.corners)
    back = figure_adjoint(
        code,
        kernel.parameters,
        STEPS,
        n_intervals=16,
        start=start,
        figure=figure,
        passages=passages,
    )
    expected = figure_slope("rms", ahead.times, ahead.values[:, 0], ahead.slopes[:, 0])
    found = [*back.by_parameter, *back.by_state]
    assert found == pytest.approx(expected.slope, rel=1e-11)
    with pytest.raises(CornerMissedError, match="no adjoint over the corner at t = 0 s"):
        passages.taken(0, *start)


def test_second_derivatives_behind_a_corner_are_those_of_the_motion():
    """Those of whole steps miss a bump stop's place altogether."""
    t, x, v, *parameters = symbols("t", "x", "v", "mass", "stop", "gap")
    mass, stop, gap = parameters
    values, along = np.array([1.3, 900.0, 0.118, 1.0]), np.array([0.2, 100.0, 0.01, 0.3])
    equations = build(
        "stopped",
        time=t,
        states=[(x, 0.0), (v, 1.0)],
        rates=[v, -stop * ops.maximum(x - gap, 0.0) / mass],
        parameters=list(zip(parameters, values, strict=False)),
        outputs=[("x", x)],
        positions=(0,),
        velocities=(1,),
    )

    def place(mass, stop, gap, begin):
        frequency = np.sqrt(stop / mass)
        return (gap + begin / frequency * np.sin(frequency * (0.16 - gap / begin)),)

    def gradient(part):
        return complex_steps(place, values + part * along)[0]

    wide, narrow = (gradient(h) - gradient(-h) for h in (2e-4, 1e-4))
    expected = (8.0 * narrow - wide) / 12e-4
    found = CurvatureCode(equations, [0]).along(
        (values[:3], along[:3]),
        STEPS,
        n_intervals=16,
        start=(np.array([0.0, 1.0]), np.zeros(0), np.array([0.0, 0.3])),
        figure=("final", 0),
        divides=True,
    )
    slopes, curvatures = (np.delete(np.concatenate(x), 3) for x in (found.slope, found.curvature))
    assert slopes == pytest.approx(gradient(0.0), rel=1e-9)
    assert curvatures == pytest.approx(expected, rel=1e-8)


def test_second_derivatives_of_rattling_motions_are_reported_as_those_of_whole_steps():
    """As are those behind jumps."""
    followed_whole = followed(runs_over(20, 4.0 * STEPS.interval / STEPS.per_interval), STEPS, 2)
    assert followed_whole.left_whole
    assert "all the time" in undivided(followed_whole)
    assert "at which rates jump" in undivided(followed(pushed(), STEPS, 16))
    assert undivided(followed(lined(9.0)[0], STEPS, 8)) == ""
