"""Tables in compiled code: as the virtual machine has them, in lanes, with other numbers."""

import ctypes
import json
import platform
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from table_examples import height, quintic, rider

from vehicledyn.codegen.ir.table_rows import TableRows
from vehicledyn.codegen.toolchain.compiler import build_library, find_compiler, suitable_lanes
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.integrate.implicit import implicit_equations
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.kernel.make_kernel import compile_kernel, known_kernel
from vehicledyn.symbolic.cached_equations import equations_from, facts_of
from vehicledyn.symbolic.tables import CurveTable

POINTS = np.random.default_rng(7).uniform(-6.0, 9.0, (30, 3))


def test_rates_outputs_and_slopes_of_unknowns(backend):
    """Against floats: inside, beyond the ends, and the Jacobian by differences."""
    ground, other = height(), quintic()
    kernel = compile_kernel(rider(ground, other), backend=backend)
    k, m = 0.7, 1.3
    for x, v, w in POINTS:
        force = -ground.slope(x) - (k + ground.value(k)) * x - 0.1 * other.value(w) * v
        assert kernel.rates(0.0, [x, v], [w]) == pytest.approx([v, force / m], rel=1e-12)
        expected = [ground.value(x), ground.curvature(x), w]
        assert kernel.outputs(0.0, [x, v], [w]) == pytest.approx(expected, rel=1e-12, abs=1e-12)
        residual, jacobian = kernel.block(0, 0.0, [x, v], [w])
        expected = w + 0.2 * w**3 - other.value(x + 0.5 * w)
        assert residual == pytest.approx([expected], rel=1e-12, abs=1e-12)
        slope = 1.0 + 0.6 * w**2 - 0.5 * other.slope(x + 0.5 * w)
        assert jacobian[0] == pytest.approx([slope], rel=1e-12, abs=1e-12)


def test_motion_follows_the_curve(needs_compiler):
    ground, other = height(), quintic()
    kernel = compile_kernel(rider(ground, other), backend="compiled")
    z = kernel.solve_unknowns(0.0, [0.4, 1.0], [0.0])
    batch = run_batch(
        make_batch(kernel, lanes=1),
        RungeKutta4(step=2e-4),
        Cases(kernel.parameters[None], np.array([[0.4, 1.0]]), z[None]),
        start=0.0,
        stop=4.0,
        interval=0.5,
        channels=[0],
    )

    def rate(_, state):
        x, v = state
        w = kernel.solve_unknowns(0.0, state, [0.0])[0]
        force = -ground.slope(x) - (0.7 + ground.value(0.7)) * x - 0.1 * other.value(w) * v
        return [v, force / 1.3]

    exact = solve_ivp(rate, (0.0, 4.0), [0.4, 1.0], rtol=1e-9, atol=1e-11, t_eval=batch.times)
    assert batch.samples[0, :, 0] == pytest.approx(ground.value(exact.y[0]), abs=1e-7)


def test_other_numbers_use_the_same_machine_code(needs_compiler):
    first = compile_kernel(rider(height(), quintic()), backend="compiled")
    second = compile_kernel(
        rider(height(5, 60, -4.0, 0.2), quintic(0.2, 45, -2.1)), backend="compiled"
    )
    assert second.key == first.key
    assert second.report.cached
    x = 0.3
    for kernel, ground in ((first, height()), (second, height(5, 60, -4.0, 0.2))):
        found = kernel.outputs(0.0, [x, 0.0], [0.0])[0]
        assert found == pytest.approx(ground.value(x), rel=1e-12)
    line = CurveTable("quintic", 0.0, 1.0, [[0.0, 1.0]])
    assert compile_kernel(rider(height(), line), backend="compiled").key != first.key


def test_other_parameters_keep_the_tables(needs_compiler):
    kernel = compile_kernel(rider(height(), quintic()), backend="compiled")
    other = kernel.with_parameters([0.9, 1.3])
    force = -height().slope(0.2) - (0.9 + height().value(0.9)) * 0.2
    assert other.rates(0.0, [0.2, 0.0], [0.0])[1] == pytest.approx(force / 1.3, rel=1e-12)


@pytest.mark.parametrize("lanes", [4, 8])
def test_lanes_give_the_numbers_of_one_case(needs_compiler, lanes):
    """Bit for bit, with places inside and outside; one case has a place that is no number."""
    if suitable_lanes() < lanes:
        pytest.skip(f"this processor has no {lanes} lanes")
    kernel = compile_kernel(rider(height(), quintic()), backend="compiled")
    rng = np.random.default_rng(3)
    n = 11
    parameters = rng.uniform(0.5, 2.0, (n, 2))
    states = rng.uniform(-5.0, 8.0, (n, 2))
    states[4] = 1e300, 1e300
    cases = Cases(parameters, states, np.zeros((n, 1)))
    plan = {"start": 0.0, "stop": 0.5, "interval": 0.1, "channels": [0, 1, 2]}
    found = [
        run_batch(make_batch(kernel, lanes=count), RungeKutta4(step=0.01), cases, **plan)
        for count in (1, lanes)
    ]
    assert make_batch(kernel, lanes=lanes).lanes == lanes
    assert np.isfinite(found[0].samples[np.arange(n) != 4]).all()
    assert np.array_equal(found[0].samples, found[1].samples, equal_nan=True)
    assert found[0].ends[4].failed
    assert [end.message for end in found[0].ends] == [end.message for end in found[1].ends]


def test_missing_tables_are_named(needs_compiler):
    equations = replace(rider(height(), quintic()), tables=())
    with pytest.raises(ValueError, match="table 'height' is not among the tables"):
        compile_kernel(equations, backend="compiled")


def test_places_that_are_no_numbers_stay_inside_the_table(backend):
    kernel = compile_kernel(rider(height(), quintic()), backend=backend)
    for place in (np.nan, np.inf, -np.inf):
        assert np.isnan(kernel.outputs(0.0, [place, 0.0], [0.0])[:2]).all()
    for place in (1e300, -1e300):
        expected = [height().value(place), 0.0, 0.0]
        assert kernel.outputs(0.0, [place, 0.0], [0.0]) == pytest.approx(expected, rel=1e-12)


def test_remembered_equations_bring_their_tables(needs_compiler):
    """By way of a file, to the machine code that was made for other tables."""
    made = compile_kernel(rider(height(5, 60, -4.0, 0.2), quintic()), backend="compiled")
    equations = rider(height(), quintic())
    known = equations_from(json.loads(json.dumps(facts_of(equations))), lambda: equations)
    kernel = known_kernel(known, made.key)
    assert kernel.outputs(0.0, [0.3, 0.0], [0.0]) == pytest.approx(
        [height().value(0.3), height().curvature(0.3), 0.0], rel=1e-12
    )
    assert [t.identity for t in known.tables] == [t.identity for t in equations.tables]


FLUSHING = """
#include <xmmintrin.h>
__attribute__((visibility("default")))
unsigned set_control(unsigned word) { unsigned old = _mm_getcsr(); _mm_setcsr(word); return old; }
"""
FLUSH_TO_ZERO, DENORMALS_ARE_ZERO = 0x8000, 0x0040


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="x86-64 only")
def test_tables_are_found_where_small_numbers_are_flushed_to_zero(needs_compiler, tmp_path):
    """Addresses of tables travel as doubles, which sums may pass on and CasADi's calls do."""
    control = ctypes.CDLL(str(build_library(find_compiler(), FLUSHING, tmp_path)))
    kernel = compile_kernel(rider(height(), quintic()), backend="compiled")
    made = implicit_equations(kernel, lambda *_: None)
    state, unknown = np.array([0.4, 1.0]), np.array([0.2])

    def all_ways():
        lanes = make_batch(kernel, lanes=suitable_lanes())
        cases = Cases(kernel.parameters[None], state[None], unknown[None])
        settings = {"start": 0.0, "stop": 0.1, "interval": 0.05, "channels": [0]}
        samples = run_batch(lanes, RungeKutta4(step=0.01), cases, **settings).samples
        point = (0.0, state, unknown, made.constants(kernel.parameters))
        slope = made.function.jacobian()(*point, *made.function(*point))[1].full()
        return [*kernel.rates(0.0, state, unknown), *samples.ravel(), *slope.ravel()]

    wanted, rows = all_ways(), TableRows(kernel.equations.tables).numbers
    old = control.set_control(0x1F80 | FLUSH_TO_ZERO | DENORMALS_ARE_ZERO)
    try:
        passed = [np.array([5e-324]) + 0.0, rows + 0.0]
        found = all_ways()
    finally:
        control.set_control(old)
    assert found == wanted
    assert passed[0] == 0.0
    assert passed[1].view(np.uint64).tolist() == rows.view(np.uint64).tolist()
