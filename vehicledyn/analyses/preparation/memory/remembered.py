"""Derivations from memory: the equations and the kernel of a target that was derived before."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager

from vehicledyn.analyses.preparation.memory.equation_memory import (
    EquationMemory,
    recall_equations,
    remember_equations,
)
from vehicledyn.analyses.preparation.prepared import Derived
from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.base.version import PACKAGE
from vehicledyn.codegen.toolchain.fingerprint import fingerprint, note_fingerprint
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import known_kernel
from vehicledyn.symbolic.cached_equations import expressions_of, facts_of, whole_equations
from vehicledyn.symbolic.constrained_equations import ConstrainedEquations
from vehicledyn.symbolic.motion_residuals import MotionResiduals


def remembered(target: Target, subject: Subject, key: str) -> tuple[Derived, Kernel | None]:
    """Return the derivation of a target, and its kernel where both are remembered.

    Parameters
    ----------
    target, subject
        What is to be derived.
    key
        Names the model among those that are remembered; empty for none.
    """
    fresh = Derived(target, subject, key)
    memory = recall_equations(key) if key else None
    if memory is None:
        return fresh, None

    def constrained() -> ConstrainedEquations:
        """Return the residuals of the same motion, which the derivation alone knows."""
        residuals = derived.derived_equations.constrained
        if residuals is None:
            raise ValueError("the derivation has no residuals")
        return residuals()

    def motion_residuals() -> MotionResiduals:
        """Return what the accelerations of the same motion fulfil."""
        residuals = derived.derived_equations.motion_residuals
        if residuals is None:
            raise ValueError("the derivation has no residuals of accelerations")
        return residuals()

    try:
        equations = whole_equations(
            memory.facts,
            memory.expressions,
            constrained if memory.has_residuals else None,
            motion_residuals if memory.has_motion_residuals else None,
        )
    except (ArithmeticError, LookupError, RuntimeError, TypeError, ValueError):
        return fresh, None
    kernel = known_kernel(equations, memory.kernel)
    if kernel is None:
        return fresh, None
    note_fingerprint(equations, memory.fingerprint)
    derived = Derived(target, subject, key, equations)
    return derived, kernel


def remember_derived(derived: Derived, kernel: Kernel) -> None:
    """Keep the equations of a derivation with the key of their compiled kernel."""
    e = derived.equations
    memory = EquationMemory(
        facts_of(e),
        expressions_of(e),
        e.constrained is not None,
        e.motion_residuals is not None,
        fingerprint(e),
        kernel.key,
    )
    remember_equations(derived.key, memory)


class _Collector(logging.Handler):
    """Keeps the messages it is given."""

    def __init__(self, level: int) -> None:
        super().__init__(level)
        self.records: list[logging.LogRecord] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a message."""
        self.records.append(record)


@contextmanager
def recorded_warnings() -> Iterator[list[logging.LogRecord]]:
    """Collect the warnings that are given meanwhile."""
    handler = _Collector(logging.WARNING)
    logger = logging.getLogger(PACKAGE)
    logger.addHandler(handler)
    try:
        yield handler.records
    finally:
        logger.removeHandler(handler)
