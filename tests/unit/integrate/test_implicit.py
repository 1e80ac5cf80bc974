"""The compiled Jacobian of the stiff methods: exact, coloured, the same for all parameter sets."""

import logging
from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from shared_examples import masses
from solve_examples import Samples, build, double_pendulum, forced, slider_crank, starts, symbols
from table_examples import height, quintic, rider

from vehicledyn.base.registry import find
from vehicledyn.codegen.printers import kernel_source as source
from vehicledyn.codegen.printers.implicit_source import colours_of
from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler
from vehicledyn.integrate import implicit
from vehicledyn.integrate.implicit import implicit_equations
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel


def chain(n=60):
    """Masses between stiff springs and dampers: each rate depends on its neighbours alone."""
    t, k = symbols("t", "stiffness")
    places, rates = symbols(*[f"x{i}" for i in range(n)]), symbols(*[f"v{i}" for i in range(n)])
    force = [
        k * (b - a) + 0.05 * k * (w - v) + 0.3 * k * (b - a) ** 3
        for a, b, v, w in zip([0, *places], [*places, 0], [0, *rates], [*rates, 0], strict=True)
    ]
    return build(
        "chain",
        time=t,
        states=[(x, 0.1 * np.sin(0.7 * i)) for i, x in enumerate(places)] + [(v, 0) for v in rates],
        rates=[*rates, *[b - a for a, b in pairwise(force)]],
        parameters=[(k, 1e5)],
        outputs=[("first", places[0])],
        positions=tuple(range(n)),
        velocities=tuple(range(n, 2 * n)),
    )


def example(name):
    makers = {
        "forced": forced,
        "slider_crank": slider_crank,
        "double_pendulum": double_pendulum,
        "tables": lambda: rider(height(), quintic()),
        "shared": lambda: masses(True),
        "chain": chain,
    }
    return makers[name]()


def slopes_by_casadi(e, time, state, unknowns, parameters):
    """Rates and residuals, and their derivatives by time, states and unknowns, dense."""
    parts = [ca.densify(e.rate), ca.densify(e.residual)]
    columns = [e.time, e.state, e.algebraic]
    slopes = [ca.densify(ca.jacobian(part, column)) for part in parts for column in columns]
    inputs = [*columns, e.parameter]
    found = ca.Function("slopes", inputs, [*parts, *slopes])(time, state, unknowns, parameters)
    return [item.full() for item in found]


@pytest.mark.parametrize(
    "name", ["forced", "slider_crank", "double_pendulum", "tables", "shared", "chain"]
)
def test_values_and_slopes_are_those_of_casadi(needs_compiler, name):
    kernel = compile_kernel(example(name), backend="compiled")
    equations, rng = kernel.equations, np.random.default_rng(3)
    made = implicit_equations(kernel, lambda *_: None)
    assert made.symbols is ca.MX
    jacobian = made.function.jacobian()
    start = starts(equations)
    for _ in range(5):
        parameters = kernel.parameters * rng.uniform(0.9, 1.1, len(equations.parameters))
        state, unknowns = (item + 0.1 * rng.normal(size=len(item)) for item in start)
        wanted = slopes_by_casadi(equations, 0.3, state, unknowns, parameters)
        point = (0.3, state, unknowns, made.constants(parameters))
        values = made.function(*point)
        found = jacobian(*point, *values)
        found = [*values, *found[:3], *found[4:7]]
        for here, right in zip(found, wanted, strict=True):
            scale = np.abs(right).max(initial=1.0)
            assert here.full() == pytest.approx(right, rel=1e-11, abs=1e-12 * scale)


def test_colours_of_a_chain_do_not_grow_with_it(needs_compiler):
    """A rate depends on three places and three speeds, whatever the length of the chain."""
    patterns = [ca.jacobian_sparsity(e.rate, e.state) for e in (chain(10), chain(60))]
    assert [max(colours_of(pattern)) + 1 for pattern in patterns] == [6, 6]


@pytest.mark.parametrize("seed", range(4))
def test_columns_of_a_colour_share_no_row(seed):
    rng = np.random.default_rng(seed)
    dense = rng.random((40, 30)) < 0.08
    dense[:, 7] = True
    colours = np.array(colours_of(ca.sparsify(ca.DM(dense.astype(float))).sparsity()))
    for colour in range(max(colours) + 1):
        assert dense[:, colours == colour].sum(axis=1).max() <= 1
    assert max(colours) + 1 < 20


@pytest.mark.parametrize("solver", ["rosenbrock", "idas"])
def test_compiled_and_interpreted_runs_take_the_same_steps(needs_compiler, solver):
    ends = {}
    for backend in ("compiled", "interpreted"):
        kernel = compile_kernel(rider(height(), quintic()), backend=backend)
        ends[backend] = run(kernel, solver)
    (one, first), (two, second) = ends.values()
    assert first.steps == second.steps
    assert one == pytest.approx(two, rel=1e-9)


def run(kernel, solver, tolerance=1e-6):
    sink, (state, unknowns) = Samples(), starts(kernel.equations)
    statistics = simulate(
        kernel,
        find("solver", solver)(relative_tolerance=tolerance, absolute_tolerance=tolerance),
        start=0.0,
        stop=1.0,
        state=state,
        unknowns=unknowns,
        interval=0.1,
        sink=sink,
    )
    return sink.states, statistics


def test_one_integrator_serves_all_parameter_sets(needs_compiler):
    kernel = compile_kernel(chain(), backend="compiled")
    softer = kernel.with_parameters([2e4])
    alone = run(compile_kernel(chain(), backend="interpreted").with_parameters([2e4]), "cvodes")[0]
    stiff = run(kernel, "cvodes")[0]
    made = dict(kernel.made)
    assert run(softer, "cvodes")[0] == pytest.approx(alone, abs=1e-7)
    assert np.abs(stiff - alone).max() > 1e-3
    assert softer.made is kernel.made and set(made) == set(kernel.made)
    assert all(made[key] is kernel.made[key] for key in made)


NARROW = """\
#!/bin/sh
for word; do shift; [ "$word" = -march=native ] || set -- "$@" "$word"; done
exec {cc} "$@"
"""


@pytest.mark.parametrize("lanes", [1, 4])
def test_processors_without_wide_registers(needs_compiler, monkeypatch, tmp_path, lanes):
    """As on a processor without AVX: instructions and lanes of the oldest x86-64, or others."""
    compiler = tmp_path / "cc"
    compiler.write_text(NARROW.replace("{cc}", " ".join(find_compiler().command)))
    compiler.chmod(0o755)
    wanted = run(compile_kernel(slider_crank(), backend="compiled"), "rosenbrock")[0]
    monkeypatch.setenv("VEHICLEDYN_CC", str(compiler))
    monkeypatch.setattr(source, "suitable_lanes", lambda: 1)
    monkeypatch.setattr(implicit, "suitable_lanes", lambda: lanes)
    kernel = compile_kernel(slider_crank(), backend="compiled")
    assert run(kernel, "rosenbrock")[0] == pytest.approx(wanted, rel=1e-12, abs=1e-14)
    assert kernel.made["implicit"].symbols is ca.MX


def test_a_compiler_that_fails_leaves_an_interpreted_run(needs_compiler, monkeypatch, caplog):
    kernel = compile_kernel(chain(9), backend="compiled")

    def refuse(*_):
        raise CompilationError("gcc failed: no space left")

    monkeypatch.setattr(implicit, "build_library", refuse)
    with caplog.at_level(logging.WARNING, "vehicledyn"):
        states, _ = run(kernel, "rosenbrock")
    assert "no space left; the Jacobian of the run is interpreted, which is slower" in caplog.text
    assert states == pytest.approx(
        run(compile_kernel(chain(9), backend="interpreted"), "rosenbrock")[0], abs=1e-9
    )
