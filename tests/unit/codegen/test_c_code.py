"""The printed C computes what CasADi computes, operation by operation."""

from functools import partial

import casadi as ca
import numpy as np
import pytest
from solve_examples import build, double_pendulum, slider_crank, starts, symbols
from table_examples import height, quintic, rider

from vehicledyn.base.errors import MissingPartError
from vehicledyn.codegen.passes.kernel_functions import (
    count_operations,
    derive_functions,
    wave_starts,
)
from vehicledyn.codegen.printers import kernel_source as source
from vehicledyn.codegen.printers.c_printer import print_function
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.symbolic.equations import Block

UNARY = {
    **{
        name: getattr(ca, name)
        for name in (
            *("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh"),
            *("acosh", "atanh", "exp", "log", "sqrt", "fabs", "sign", "floor", "ceil"),
            *("erf", "expm1", "log1p", "logic_not"),
        )
    },
    "neg": lambda x: -x,
    "sq": lambda x: x * x,
    "cube": lambda x: x**3,
    "twice": lambda x: x + x,
    "inv": lambda x: 1 / x,
    "constpow": lambda x: x**2.3,
}
BINARY = {
    **{
        name: getattr(ca, name)
        for name in (
            *("atan2", "fmin", "fmax", "fmod", "remainder", "copysign", "hypot"),
            *("logic_and", "logic_or"),
        )
    },
    "add": lambda x, y: x + y,
    "sub": lambda x, y: x - y,
    "mul": lambda x, y: x * y,
    "div": lambda x, y: x / y,
    "pow": lambda x, y: ca.fabs(x) ** y,
    "lt": lambda x, y: x < y,
    "le": lambda x, y: x <= y,
    "eq": lambda x, y: x == y,
    "ne": lambda x, y: x != y,
    "if_else": lambda x, y: ca.if_else(x < y, x * 2, ca.if_else(y < 0.1, -1.0, y)),
    "special": lambda x, y: ca.if_else(x < y, ca.inf, -x) + 1e-320 * y,
}


def one_state(expressions, parameters=()):
    t, x, y = symbols("t", "x", "y")
    return build(
        "operations",
        time=t,
        states=[(x, 0.0), (y, 0.0)],
        rates=[x, y],
        parameters=[(symbol, value) for symbol, value in parameters],
        outputs=[(name, law(x, y)) for name, law in expressions.items()],
    )


@pytest.mark.parametrize("point", [(0.3, 0.7), (-0.4, 0.2), (0.5, 0.5), (1.7, -0.6), (0.0, 0.0)])
def test_every_operation(needs_compiler, point):
    laws = {name: lambda x, y, law=law: law(x) for name, law in UNARY.items()} | BINARY
    equations = one_state(laws)
    kernel = compile_kernel(equations, backend="compiled")
    with np.errstate(all="ignore"):
        expected = np.array([float(law(ca.DM(point[0]), ca.DM(point[1]))) for law in laws.values()])
    result = kernel.outputs(0.0, point, [])
    for name, value, wanted in zip(laws, result, expected, strict=True):
        assert value == pytest.approx(wanted, rel=1e-15, abs=0.0, nan_ok=True), name


def test_unknown_operation_is_named(needs_compiler):
    equations = one_state({"inverse": lambda x, y: ca.erfinv(x)})
    with pytest.raises(MissingPartError, match="ERFINV"):
        compile_kernel(equations, backend="compiled")
    kernel = compile_kernel(equations)
    assert kernel.backend == "interpreted"
    assert "ERFINV" in kernel.report.remark


@pytest.mark.parametrize("make", [double_pendulum, lambda: rider(height(), quintic())])
@pytest.mark.parametrize("piece", [1, 7, 20])
def test_pieces_change_nothing(needs_compiler, monkeypatch, tmp_path, make, piece):
    monkeypatch.setenv("VEHICLEDYN_CACHE", str(tmp_path / "cache"))
    equations = make()
    state, unknowns = starts(equations)
    whole = compile_kernel(equations, backend="compiled")
    cut = partial(print_function, piece=piece)
    monkeypatch.setattr(source, "print_function", cut)
    monkeypatch.setattr(
        "vehicledyn.kernel.make_kernel.generator_fingerprint", lambda: f"pieces {piece}"
    )
    parts = compile_kernel(equations, backend="compiled")
    assert not parts.report.cached
    assert np.array_equal(parts.rates(0, state, unknowns), whole.rates(0, state, unknowns))
    assert np.array_equal(parts.outputs(0, state, unknowns), whole.outputs(0, state, unknowns))


def test_parameter_work_is_moved_to_prepare():
    a, b = symbols("a", "b")
    equations = one_state(
        {"y": lambda x, y: x * ca.sin(a) / ca.cosh(b) + ca.sqrt(a * b)},
        parameters=[(a, 1.0), (b, 2.0)],
    )
    # sin, cosh, its reciprocal, a b, sqrt; at run time two products and a sum are left
    assert count_operations(equations) == {"prepare": 5, "rates": 0, "outputs": 3, "blocks": 0}


def test_shared_divisors_become_one_reciprocal():
    equations = one_state({"u": lambda x, y: 1.5 / (x + y), "v": lambda x, y: x / (x + y)})
    functions = derive_functions(equations)
    codes = [functions.outputs.instruction_id(k) for k in range(functions.outputs.n_instructions())]
    assert codes.count(ca.OP_DIV) + codes.count(ca.OP_INV) == 1
    assert codes.count(ca.OP_MUL) == 2


def test_operations_are_counted_alike(backend):
    equations = slider_crank()
    kernel = compile_kernel(equations, backend=backend)
    assert kernel.report.operations == count_operations(equations)
    assert all(kernel.report.operations[key] > 0 for key in ("rates", "outputs", "blocks"))


def test_blocks_that_wait_for_each_other_are_solved_in_turn():
    assert wave_starts(double_pendulum()) == (0, 1)
    assert wave_starts(slider_crank()) == (0,)
    assert wave_starts(one_state({})) == ()
    a, b, x = symbols("a", "b", "x")
    apart = build(
        "apart",
        time=symbols("t")[0],
        states=[(x, 0.0)],
        rates=[x],
        parameters=[],
        unknowns=[(a, 0.0), (b, 0.0)],
        residuals=[a - x, b - 2.0 * x],
        outputs=[],
        blocks=(Block("a", 0, 1, 1e-9), Block("b", 1, 2, 1e-9)),
    )
    assert wave_starts(apart) == (0,)


def test_products_are_fused_where_they_are_not_needed_themselves():
    laws = {
        "fused": lambda x, y: x * y + x,
        "kept": lambda x, y: x * x - y,
        "x2": lambda x, y: x * x,
    }
    text = print_function(
        derive_functions(one_state(laws)).outputs, "outputs", ["t", "x", "z", "c"]
    )
    assert text.count("vd_fma(") == 1
    assert text.count("vd_fms(") == 0


def test_functions_are_called_in_packs():
    laws = {
        "angles": lambda x, y: ca.sin(x) + ca.cos(x) * ca.sin(y),
        "later": lambda x, y: ca.sin(ca.atan(x) + ca.tan(y)),
    }
    text = print_function(
        derive_functions(one_state(laws)).outputs, "outputs", ["t", "x", "z", "c"]
    )
    assert text.count("vd_sincos(2 * VD_LANES") == 1  # of x and of y, which has a tangent
    assert text.count("vd_sincos(") == 1
    assert text.count("vd_sin(1 * VD_LANES") == 1
    assert text.count("vd_atan(1 * VD_LANES") == 1
