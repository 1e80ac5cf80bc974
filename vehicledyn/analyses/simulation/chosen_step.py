"""The step of a fixed-step method that a scenario leaves to the program."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import NumericalError
from vehicledyn.files.scenario.checks import MOST_SAMPLES
from vehicledyn.integrate.accuracy.proposed_step import proposed_step

if TYPE_CHECKING:
    from vehicledyn.analyses.preparation.prepare import AssembledPoint
    from vehicledyn.kernel.kernel import Kernel


def leaves_step(solver: Any) -> bool:
    """Return whether a method needs a step that its settings do not say."""
    return hasattr(solver, "fixed_method") and solver.step is None


def with_step(solver: Any, kernel: Kernel, start: AssembledPoint, interval: float) -> Any:
    """Return the settings of a method with a step that suits the motion at its start.

    Parameters
    ----------
    solver
        Settings; those that need no step, or say theirs, are returned as they are.
    kernel
        The model with its parameters set.
    start
        Where the run starts.
    interval
        Time between samples, which the step divides [s].

    Raises
    ------
    NumericalError
        If the motion near the start cannot be computed, or needs too many steps.
    """
    if not leaves_step(solver):
        return solver
    point = (0.0, start.state, start.unknowns)
    try:
        step = proposed_step(kernel, solver.fixed_method, point, interval)
    except NumericalError as error:
        raise NumericalError(f"no step can be chosen: {error}; give solver.step") from None
    if interval > MOST_SAMPLES * step:
        raise NumericalError(
            f"no step can be chosen: the motion at the start needs one of {step:.3g} s, too short "
            f"for the output interval of {interval:g} s; take a shorter interval, or give "
            "solver.step"
        )
    return solver.model_copy(update={"step": step})
