"""Operations of the languages: one table of arithmetic, and nothing that one can write alone."""

import math

import pytest

from vehicledyn.codegen.ir.instructions import CELL, ENTRY, KNOT
from vehicledyn.codegen.passes.scheduling import CALLED
from vehicledyn.codegen.printers.languages import Term
from vehicledyn.codegen.printers.operations import KERNEL, MATLAB, PYTHON, C, kernel_expression

ONLY_IN_KERNELS = {"FMA", "FMS", "FNMA", "FNMS", "NEGADD", "SELECT", CELL, KNOT, ENTRY}
EXPORTED = (C, PYTHON, MATLAB)


@pytest.mark.parametrize("language", EXPORTED, ids=lambda item: item.name)
def test_kernels_and_exports_know_the_same_operations(language):
    """But a tangent, which kernels make of sine and cosine."""
    known = set(KERNEL.templates) - ONLY_IN_KERNELS | set(CALLED)
    assert known | {"TAN"} == set(language.templates)


def test_kernels_write_arithmetic_as_exported_c():
    terms = [Term("a"), Term("b")]
    for operation in ("ADD", "SUB", "MUL", "DIV", "NEG", "SQ", "INV", "ASSIGN"):
        n = len(C.templates[operation].operands)
        own = kernel_expression(operation, ["a", "b"][:n], [False] * n, {})
        assert own == C.apply(operation, terms[:n]).text


def test_numbers_read_back():
    for value in (0.1, -2.5e-300, 1.0, -0.0):
        assert float(KERNEL.number(value).text) == value
        assert math.copysign(1.0, float(KERNEL.number(value).text)) == math.copysign(1.0, value)
    assert KERNEL.number(-math.inf).text == "-INFINITY"
    assert KERNEL.number(math.nan).text == "NAN"
