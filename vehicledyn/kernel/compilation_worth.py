"""Whether compiling a model pays: of large ones only where they are evaluated often."""

from __future__ import annotations

from vehicledyn.symbolic.equations import Equations

LARGE = 60_000
"""Operations of rates and outputs, a shared function counting as one, that make a model large.

A vehicle on eight axles is not; a chain of 1,000 bodies is.
"""

MANY = 5_000
"""Evaluations from which the compiler has paid for itself.

For 1,000 bodies in a chain printing and compiling take 11 s, which 1,250 steps of four evaluations
win back.
"""


def compiling_pays(equations: Equations, evaluations: float | None) -> bool:
    """Return whether to compile a model.

    Parameters
    ----------
    equations
        The model.
    evaluations
        How many evaluations of its rates are expected; None where few are, or nobody knows.
    """
    if evaluations is not None and evaluations >= MANY:
        return True
    return not is_large(equations)


def is_large(equations: Equations) -> bool:
    """Return whether a model has more than 60,000 operations."""
    import casadi

    e = equations
    given = [e.time, e.state, e.algebraic, e.parameter]
    function = casadi.Function("size", given, [casadi.SX(e.rate), casadi.SX(e.output)])
    return bool(function.n_instructions() > LARGE)
