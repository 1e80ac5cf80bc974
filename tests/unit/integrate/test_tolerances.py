"""Tolerances that no step can hold: refused where they are read, given up where they are met."""

import time

import numpy as np
import pytest
from solve_examples import oscillator

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.registry import find, kinds
from vehicledyn.integrate.explicit_pairs.adaptive_run import run_explicit
from vehicledyn.integrate.methods.tolerances import SMALLEST_ABSOLUTE, SMALLEST_RELATIVE
from vehicledyn.integrate.task import Task
from vehicledyn.kernel.make_kernel import compile_kernel

ADAPTIVE = [k for k in kinds("solver") if "relative_tolerance" in find("solver", k).model_fields]


def test_there_are_adaptive_methods():
    assert {"rk45", "dop853", "rosenbrock", "cvodes", "idas"} <= set(ADAPTIVE)


@pytest.mark.parametrize("kind", ADAPTIVE)
@pytest.mark.parametrize(
    ("relative", "absolute"), [(1e-30, 1e-9), (1e-9, 1e-30), (1e-9, 1e-200), (1e-9, 0.0)]
)
def test_tolerances_below_rounding_are_refused(kind, relative, absolute):
    with pytest.raises((InputError, ValueError), match="must be at least"):
        find("solver", kind).model_validate(
            {"relative_tolerance": relative, "absolute_tolerance": absolute}
        )


@pytest.mark.parametrize("kind", ADAPTIVE)
def test_the_smallest_ones_are_taken(kind):
    find("solver", kind).model_validate(
        {"relative_tolerance": SMALLEST_RELATIVE, "absolute_tolerance": SMALLEST_ABSOLUTE}
    )


@pytest.mark.parametrize("scheme", ["RK45", "DOP853"])
def test_steps_too_short_for_the_run_end_it_with_a_reason(scheme):
    """A span of 1e12 s, of an oscillation of some seconds, needs more steps than can be taken."""
    kernel = compile_kernel(oscillator())
    state = np.array([1.0, 0.0])
    task = Task(kernel, 0.0, 1e9, 1000, state, np.zeros(0), lambda *_: None, _tell, _tell)
    started = time.perf_counter()
    with pytest.raises(NumericalError, match="the rest of the run would need"):
        run_explicit(task, "x", scheme, relative_tolerance=3e-14, absolute_tolerance=1e-16)
    assert time.perf_counter() - started < 30.0


def _tell(*_):
    pass
