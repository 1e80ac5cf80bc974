"""Shared functions in compiled code: called once printed, equal to the written form."""

import numpy as np
import pytest
from shared_examples import masses, pull
from solve_examples import build, symbols

from vehicledyn.codegen.passes.kernel_functions import count_operations, derive_functions
from vehicledyn.codegen.printers.kernel_source import kernel_source
from vehicledyn.codegen.toolchain.compiler import suitable_lanes
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.shared import shared

pytestmark = pytest.mark.long


def long_pull(values):
    """The same, of so many operations that it is printed in pieces."""
    place, rate, _ = values
    total = 0.0
    for k in range(400):
        total = 0.97 * total + ops.sin(place + 0.01 * k) * rate
    force, lost, inner = pull(values)
    return [force + 1e-3 * total, lost, inner]


def coupled():
    """Four masses, each with its own place in two shared functions of two and three arguments."""
    t, k = symbols("t", "stiffness")
    places, rates = (symbols(*[f"{n}{i}" for i in range(4)]) for n in "xv")
    forces = []
    for x, v in zip(places, rates, strict=True):
        height = ops.sin(k * x) + 0.3 * x * x
        (one,) = shared("one", [height, v], lambda a: [ops.tanh(a[0]) * a[1]])
        (two,) = shared("two", [height, v, x], lambda a: [ops.atan(a[0] * a[2]) - a[1]])
        forces.append(one + two * height)
    return build(
        "coupled",
        time=t,
        states=[(x, 0.1 * i) for i, x in enumerate(places)] + [(v, 0.4) for v in rates],
        rates=[*rates, *forces],
        parameters=[(k, 4.0)],
        outputs=[],
        positions=tuple(range(4)),
        velocities=tuple(range(4, 8)),
    )


def test_alike_places_in_functions_of_other_arguments(needs_compiler):
    equations, state = coupled(), np.linspace(-0.7, 0.9, 8)
    compiled, interpreted = (
        compile_kernel(equations, backend=name).rates(0.0, state, np.zeros(0))
        for name in ("compiled", "interpreted")
    )
    assert compiled == pytest.approx(interpreted, rel=1e-13)


@pytest.mark.parametrize("law", [pull, long_pull])
@pytest.mark.parametrize("backend", ["compiled", "interpreted"])
def test_kernel_equals_the_written_form(backend, law, request):
    if backend == "compiled":
        request.getfixturevalue("needs_compiler")
    rng = np.random.default_rng(5)
    one, two = (compile_kernel(masses(share, law), backend=backend) for share in (True, False))
    none = np.zeros(0)
    for _ in range(20):
        x = rng.normal(size=12)
        assert one.rates(0.0, x, none) == pytest.approx(two.rates(0.0, x, none), rel=1e-13)
        assert one.outputs(0.0, x, none) == pytest.approx(two.outputs(0.0, x, none), rel=1e-12)


def test_the_function_is_printed_once_and_only_what_is_needed():
    equations = masses(True)
    text = kernel_source(equations, derive_functions(equations))
    assert text.count("static void rates_shared_0(") == 1
    calls = -(-6 // suitable_lanes())
    assert text.count("  rates_shared_0_wide(a" if calls < 6 else "  rates_shared_0(a") == calls
    assert "exp" not in text[text.index("static void rates_shared_0(") :].split("\n}\n")[0]
    counts, written = count_operations(equations), count_operations(masses(False))
    assert counts["rates"] == pytest.approx(written["rates"], rel=0.25)


def test_lanes_change_nothing(needs_compiler):
    kernel = compile_kernel(masses(True), backend="compiled")
    rng = np.random.default_rng(1)
    cases = Cases(
        parameters=4.0 + rng.random((9, 1)),
        states=rng.normal(size=(9, 12)),
        unknowns=np.zeros((9, 0)),
    )
    span = {"start": 0.0, "stop": 1.0, "interval": 0.1, "channels": [0, 3]}
    found = [
        run_batch(make_batch(kernel, lanes=n), RungeKutta4(step=0.01), cases, **span).samples
        for n in (1, 4)
    ]
    assert np.array_equal(*found)
