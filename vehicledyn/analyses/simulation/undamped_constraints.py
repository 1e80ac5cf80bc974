"""Warn of steps of index 3 whose errors across the constraints do not fade."""

from __future__ import annotations

from typing import Any

from vehicledyn.symbolic.equations import Equations

_FADES = 1.0 - 1e-6


def undamped_constraints(solver: Any, equations: Equations) -> list[str]:
    """Return a warning where the multipliers of a method make its run fail sooner or later.

    Cardona, Géradin (1989), Computers & Structures 33, 801-820: Newmark's undamped method with
    multipliers is weakly unstable.
    """
    has_multipliers = equations.structure.get("constraint_method") == "multipliers"
    if not has_multipliers or getattr(solver, "constraints", "") != "index3":
        return []
    left = solver.weights.left_across_constraints
    if left < _FADES:
        return []
    grow = "add up, weakly unstable" if left < 2.0 - _FADES else f"grow {left:.3g} times each step"
    return [
        "warning: 'constraints: index3' with a method that damps nothing: errors of velocities and "
        f"multipliers across the constraints alternate and {grow}; short or gentle motions pass, "
        "in others Newton's method fails; take a spectral radius below 1, such as 0.9, or "
        "'constraints: stabilised_index2'"
    ]
