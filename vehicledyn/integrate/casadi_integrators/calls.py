"""What calls of CasADi's integrators share, with events and without."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from vehicledyn.base.errors import NumericalError
from vehicledyn.base.interrupts import heeded
from vehicledyn.integrate.explicit_pairs.adaptive_run import steepest_state
from vehicledyn.integrate.implicit import ImplicitEquations
from vehicledyn.integrate.task import Task
from vehicledyn.kernel.engine import Count, Vector


class CallStopped(Exception):  # noqa: N818
    """CasADi gave up a call; how far it came is not known."""


def elapsed_equations(implicit: ImplicitEquations, p: Any, elapsed: Any) -> dict[str, Any]:
    """Return the equations as CasADi's integrators take them, but for their time.

    Parameters
    ----------
    implicit
        The equations.
    p
        Symbols of the constants, of the time at which the integration begins, and perhaps more.
    elapsed
        What elapsed since then [s].
    """
    n = implicit.n_constants
    x, z = (
        implicit.symbols.sym(name, size) for name, size in zip("xz", implicit.sizes, strict=True)
    )
    rate, residual = implicit.function(p[n] + elapsed, x, z, p[:n])
    dae = {"x": x, "z": z, "p": p, "ode": rate, "alg": residual}
    if not z.numel():
        del dae["z"], dae["alg"]
    return dae


def integrated(integrator: Any, given: Mapping[str, Any]) -> Any:
    """Return what an integrator makes of its inputs; it takes Ctrl-C for rates that failed."""
    with heeded():
        return integrator(**given)


def count_work(stats: Mapping[str, Any], task: Task) -> int:
    """Add the evaluations and steps of a call to a task's account, and return the steps."""
    task.ledger.counts[Count.EVALUATIONS] += int(stats.get("n_rhs", stats.get("nfevals", 0)))
    steps = int(stats.get("n_steps", stats.get("nsteps", 0)))
    task.count_steps(steps)
    return steps


def stopped_between(
    task: Task, times: tuple[float, float], state: Vector, unknowns: Vector
) -> NumericalError:
    """Return the error for a method that gave up between two times [s], from this point on."""
    return NumericalError(
        f"integration stopped between t = {times[0]:.9g} s and "
        f"{times[1]:.9g} s: the steps became too small or too many; "
        f"state '{steepest_state(task.kernel, times[0], state, unknowns)}' changes fastest there; "
        "make an impact an event, soften the contact, or loosen the tolerances"
    )
