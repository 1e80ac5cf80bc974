"""Values computed alike in four places: found, carried side by side, the same to the last bit."""

import ctypes

import casadi as ca
import numpy as np
import pytest

from vehicledyn.codegen.ir.instructions import read_function
from vehicledyn.codegen.passes.lowering import lower
from vehicledyn.codegen.passes.slp_rows import PLACES, PackedRow
from vehicledyn.codegen.printers.c_printer import print_function
from vehicledyn.codegen.printers.kernel_source import shared_source
from vehicledyn.codegen.printers.row_printer import Copies
from vehicledyn.codegen.toolchain.compiler import build_library, find_compiler, suitable_lanes
from vehicledyn.symbolic import ops

N_INPUT = 24


def corner(own, common, sign):
    """Forces of a place: sums with signs of their own, choices, roots and called functions."""
    a, b, c, d = own
    angle = ops.atan(a * common + sign * b)
    lever = sign * c + common * ops.sin(angle) - d * ops.cos(angle)
    load = ops.maximum(lever * a - sign * d, 0.0)
    bent = ops.where(load > b, ops.minimum(load, 2.0) / (1.5 + b * b), ops.absolute(lever))
    grip = ops.sqrt(1.0 + bent * bent) * ops.exp(-0.1 * a * a)
    return [sign * grip + load * d, lever * grip - sign * bent]


def four_corners(x, c):
    """Four places, two of them mirrored, and what they do together."""
    signs = (1.0, -1.0, 1.0, -1.0)
    found = [
        corner([x[k], x[4 + k], c[4 * k % 14], c[(5 * k + 3) % 16]], x[20], signs[k])
        for k in range(PLACES)
    ]
    together = sum(item[0] for item in found) / (1.0 + sum(item[1] ** 2 for item in found))
    later = [item[0] * together - sign * item[1] for item, sign in zip(found, signs, strict=True)]
    return [together, *later, *(item[1] for item in found)]


def a_chain(x, c):
    """Four equal steps of which each waits for the one before, beside four that do not."""
    value = x[0]
    for k in range(PLACES):
        value = ops.sin(value * c[k] + x[k]) * x[20] - c[k] / (2.0 + x[4 + k] ** 2)
    return [value, *[x[k] * x[8 + k] - c[k] / (3.0 + x[k] ** 2) for k in range(PLACES)]]


def many_corners(x, c):
    """So much that it is printed in pieces."""
    own = x
    for _ in range(12):
        found = four_corners(own, c)
        own = ca.vertcat(*[ca.sin(item) for item in found[1:]], x[8:])
    return [found[0], *[own[k] for k in range(8)]]


LAWS = [four_corners, a_chain, many_corners]


def function_of(law):
    x, c = ca.SX.sym("x", N_INPUT), ca.SX.sym("c", N_INPUT)
    return ca.Function("law", [x, c], [ca.cse(ca.vertcat(*law(x, c)))])


def build(function, folder, *, in_rows):
    """Return the compiled function of x and c."""
    copies = Copies(N_INPUT)
    text = print_function(
        function, "law", ["x", "c"], piece=100, copies=copies if in_rows else None
    )
    head = [shared_source(name) for name in ("real.h", "elementary.c", "fours.h")]
    door = "VD_EXPORT void door(const real *x, real *c, real *r) { lay_out(c); law(x, c, r); }"
    folder.mkdir()
    source = "\n".join([*head, text, copies.text, door])
    library = ctypes.CDLL(str(build_library(find_compiler(), source, folder)))
    room = ctypes.c_int.in_dll(library, "vd_copies").value

    def call(x, c):
        given, found = np.concatenate([c, np.zeros(room)]), np.zeros(function.numel_out(0))
        library.door(*[ctypes.c_void_p(array.ctypes.data) for array in (x, given, found)])
        return found

    return call


@pytest.mark.skipif(suitable_lanes() < PLACES, reason="rows need the registers of AVX2")
@pytest.mark.parametrize("law", LAWS)
def test_rows_change_no_bit(law, tmp_path, needs_compiler):
    function = function_of(law)
    one = build(function, tmp_path / "one", in_rows=False)
    rows = build(function, tmp_path / "rows", in_rows=True)
    rng = np.random.default_rng(3)
    for scale in (0.1, 1.0, 30.0):
        for _ in range(50):
            x, c = rng.normal(scale=scale, size=(2, N_INPUT))
            found = rows(x, c)
            assert np.array_equal(found, one(x, c), equal_nan=True)
            if law is four_corners:  # the others amplify rounding
                assert found == pytest.approx(np.array(function(x, c)).ravel(), rel=1e-9, abs=1e-9)


@pytest.mark.skipif(suitable_lanes() < PLACES, reason="rows need the registers of AVX2")
@pytest.mark.parametrize("without", ["-mno-avx2", "-mno-fma", "-mno-avx512f"])
def test_compilers_told_to_do_without_registers(without, tmp_path, needs_compiler, monkeypatch):
    command = " ".join(find_compiler().command)
    monkeypatch.setenv("VEHICLEDYN_CC", f"{command} {without}")
    function = function_of(four_corners)
    one = build(function, tmp_path / "one", in_rows=False)
    rows = build(function, tmp_path / "rows", in_rows=True)
    x, c = np.random.default_rng(5).normal(size=(2, N_INPUT))
    x[8], c[3] = np.nan, np.inf
    assert np.array_equal(rows(x, c), one(x, c), equal_nan=True)
    x[8], c[3] = 0.3, -0.7
    assert np.array_equal(rows(x, c), one(x, c))


def test_most_of_what_is_alike_becomes_rows():
    lowered = lower(read_function(function_of(four_corners)), in_rows=True)
    rows = [step for step in lowered.steps if isinstance(step, PackedRow)]
    alone = [step for step in lowered.steps if isinstance(step, int)]
    assert len(rows) >= 18
    assert len(alone) <= 14  # the sums of all places, what follows from them, and results
    signs = {item for row in rows for item in row.signs}
    assert any(len(set(item)) == 2 for item in signs)  # mirrored places add what others take off


@pytest.mark.parametrize("law", LAWS)
def test_each_step_comes_behind_what_it_needs(law):
    lowered = lower(read_function(function_of(law)), in_rows=True)
    done = {k for k, item in enumerate(lowered.values) if item.operation in ("INPUT", "CONST")}
    for step in lowered.steps:
        computed = [step] if isinstance(step, int) else step.computed
        groups = [lowered.values[step].operands] if isinstance(step, int) else step.operands
        assert {operand for group in groups for operand in group} <= done
        assert done.isdisjoint(computed)
        done.update(computed)
    assert {value for _, _, value in lowered.results} <= done


def test_what_occurs_once_stays_as_it_is():
    function = function_of(lambda x, c: [x[0] * c[0] + ops.sin(x[1]) / c[1]])
    plain = lower(read_function(function), in_rows=True)
    assert plain.rows == []
    assert all(isinstance(step, int) or step.function == "sin" for step in plain.steps)
