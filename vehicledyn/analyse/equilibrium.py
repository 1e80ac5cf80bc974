"""Close the loops from a rough guess, and find states whose rates vanish."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.analyse.newton import Evaluate, NewtonResult, settle, solve_damped
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.derivatives import Derivatives, Slopes
from vehicledyn.kernel.engine import Ledger, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic.equations import Equations

_LOOSE = 1e-9
_NAMED = 4
_DIFFERENCE = 1e-7
"""How far a state is moved to see how the rates follow [m or rad, or per s]."""

_COSTLY = 1_500_000
"""Operations of rates, for all columns of a Jacobian, from which on differences of compiled rates
serve instead of it: Newton's method then gains but five digits a step."""

_ROUNDING = 32.0 * float(np.finfo(float).eps)
"""Changes of the states in an equilibrium that are but rounding, relative to their size or 1."""

_LARGEST_TURN = 0.5
"""How far a coordinate may turn at once on the way to an equilibrium [rad]."""


@dataclass(frozen=True)
class EquilibriumPoint:
    """States and unknowns of an equilibrium, the largest rate left, and the iterations."""

    state: Vector
    unknowns: Vector
    residual: float
    iterations: int


def assemble(kernel: Kernel, time: float, state: Any, guess: Any) -> Vector:
    """Return the unknowns that close all loops, from a guess that may be rough.

    Parameters
    ----------
    kernel
        The model with its parameters set.
    time
        Time [s].
    state
        States, shape (n_states,).
    guess
        Unknowns to start from, shape (n_unknowns,).

    Raises
    ------
    NumericalError
        If a loop cannot be closed; names the block and the distance that remains.
    """
    unknowns = np.array(guess, dtype=float)
    for index, block in enumerate(kernel.equations.blocks):
        span = slice(block.start, block.stop)

        def evaluate(part: Vector, index: int = index, span: slice = span) -> tuple[Vector, Vector]:
            unknowns[span] = part
            residual, jacobian = kernel.block(index, time, state, unknowns)
            if not (np.isfinite(residual).all() and np.isfinite(jacobian).all()):
                raise NumericalError(f"{_where(kernel, index, time)} is not finite here")
            return residual, jacobian

        found = solve_damped(evaluate, unknowns[span].copy(), tolerance=block.tolerance)
        if not found.solved:
            distance = float(np.abs(found.residual).max())
            raise NumericalError(
                f"{_where(kernel, index, time)} cannot be closed: {distance:.4g} {block.unit} "
                "remain; check lengths, attachment points and the starting position"
            )
        unknowns[span] = found.point
    return kernel.solve_unknowns(time, state, unknowns)


def guessed(kernel: Kernel, time: float, state: Vector, unknowns: Vector) -> Vector:
    """Return unknowns with those that events would move where the events would put them.

    A search that leaps from state to state passes no events; points of contact must lie where
    they touch first all the same.
    """
    moved = [pair for event in kernel.equations.events for pair in event.guesses]
    if not moved:
        return unknowns
    values, guess = kernel.reset_values(time, state, unknowns), unknowns.copy()
    for index, row in moved:
        guess[index] = values[row]
    return guess


def find_equilibrium(
    equations: Equations,
    kernel: Kernel,
    *,
    time: float,
    state: Any,
    unknowns: Any,
    free: Sequence[int],
    balanced: Sequence[int],
    tolerance: float,
    derivatives: Slopes | None = None,
    settling: float | None = None,
    not_held: Callable[[], Mapping[str, str]] = dict,
) -> EquilibriumPoint:
    """Return the point where chosen rates vanish, found by moving as many chosen states.

    Parameters
    ----------
    equations
        The model.
    kernel
        Its kernel, with the parameters set.
    time
        Time [s].
    state, unknowns
        Point to start from; states that are not free keep these values.
    free
        Indices of the states to move.
    balanced
        Indices of the rates that must vanish, as many as free states.
    tolerance
        Largest rate that counts as zero, in units of the states per s. Larger ones do that are but
        the rounding of states, as where large forces of a thin beam act on small inertias.
    derivatives
        Those of the equations, where they are at hand already.
    settling
        How far a free state may move in a step while forces have yet to begin, as where contacts
        are still open; then the point settles as in strongly damped motion first [m or rad].
    not_held
        Returns why a coordinate, by name, may have nothing that holds it, with advice; called
        for the message only.

    Raises
    ------
    NumericalError
        If there is no equilibrium near; names the rates that stay and their values.
    """
    if len(free) != len(balanced):
        raise ValueError(f"{len(free)} free states cannot balance {len(balanced)} rates")
    problem = BalancedRates(
        kernel, derivatives or Derivatives(equations), time, list(free), list(balanced)
    )
    problem.start(state, unknowns)
    begin = problem.state[problem.free]
    largest = largest_steps(equations, free)
    if settling is not None:
        begin = settle(problem.quickest, begin, longest=settling, largest_step=largest)
    found = problem.solved_roughly(begin, tolerance, largest)
    if found is None:
        found = solve_damped(
            problem.evaluate, begin, tolerance=tolerance, largest_step=largest, rounding=_ROUNDING
        )
    if not found.solved:
        loose = _loose(equations, problem, found.point, int(np.argmax(np.abs(found.residual))))
        reasons = _reasons(equations, found.residual, balanced, tolerance, not_held())
        advice = _advice(reasons, loose)
        raise NumericalError(_unbalanced(equations, balanced, found.residual, tolerance, advice))
    final_state, final_unknowns = problem.point(found.point)
    for attitude in equations.attitudes:
        quaternion = list(attitude.quaternion)
        final_state[quaternion] /= np.linalg.norm(final_state[quaternion])
    residual = float(np.abs(found.residual).max(initial=0.0))
    return EquilibriumPoint(final_state, final_unknowns, residual, found.iterations)


def largest_steps(equations: Equations, free: Sequence[int]) -> Vector:
    """Return how far each free state may move at once, shape (n_free,) [units of the states]."""
    turns = [equations.states[k].unit == "rad" for k in free]
    return np.where(turns, _LARGEST_TURN, np.inf)


@dataclass
class BalancedRates:
    """The balanced rates as a function of the free states, with closed loops."""

    kernel: Kernel
    derivatives: Slopes
    time: float
    free: list[int]
    balanced: list[int]

    def start(self, state: Any, unknowns: Any) -> None:
        """Close the loops at the starting point, from where the unknowns are followed."""
        self.state = self.kernel.checked_state(state)
        self._unknowns = assemble(self.kernel, self.time, self.state, unknowns)
        self._base = self.state[self.free].copy()
        self._follow = np.zeros((self._unknowns.size, len(self.free)))
        if self._unknowns.size:
            self._follow = self._derive(self.state, self._unknowns).unknowns[:, self.free]

    def at(self, time: float) -> BalancedRates:
        """Return the same at another time [s]; the loops are followed from here."""
        moved = copy(self)
        moved.time, moved._follow = time, self._follow.copy()
        return moved

    @property
    def quickest(self) -> Evaluate:
        """Rates and Jacobian in the quickest way that there is."""
        return self.roughly if self.kernel.backend == "compiled" else self.evaluate

    def solved_roughly(
        self, begin: Vector, tolerance: float, largest: Vector
    ) -> NewtonResult | None:
        """Return the solution by differences where these are much cheaper; None if it is none."""
        operations = self.kernel.report.operations.get("rates", 0)
        columns = self.state.size + self._unknowns.size
        if self.kernel.backend != "compiled" or columns * operations < _COSTLY:
            return None
        try:
            found = solve_damped(
                self.roughly, begin, tolerance=tolerance, largest_step=largest, persistent=False
            )
        except NumericalError:
            return None
        return found if found.solved else None

    def point(self, part: Vector) -> tuple[Vector, Vector]:
        """Return state and unknowns for values of the free states."""
        state = self.state.copy()
        state[self.free] = part
        guess = self._unknowns + self._follow @ (part - self._base)
        guess = guessed(self.kernel, self.time, state, guess)
        return state, self.kernel.solve_unknowns(self.time, state, guess)

    def evaluate(self, part: Vector) -> tuple[Vector, Vector]:
        """Return the balanced rates and their Jacobian, and follow the loops from here."""
        state, unknowns = self.point(part)
        total = self._derive(state, unknowns)
        rates = self.kernel.rates(self.time, state, unknowns)[self.balanced]
        jacobian = total.rates[np.ix_(self.balanced, self.free)]
        if not (np.isfinite(rates).all() and np.isfinite(jacobian).all()):
            raise NumericalError("the rates are no finite numbers at a trial point")
        self._base, self._unknowns = part.copy(), unknowns
        self._follow = total.unknowns[:, self.free]
        return rates, jacobian

    def roughly(self, part: Vector) -> tuple[Vector, Vector]:
        """Return the same with differences for the Jacobian, which compiled code makes at once."""
        state, unknowns = self.point(part)
        ledger = Ledger()
        rates = self.kernel.rates(self.time, state, unknowns)
        jacobian = np.empty((len(self.balanced), part.size))
        for column, index in enumerate(self.free):
            moved, guess = state.copy(), unknowns + _DIFFERENCE * self._follow[:, column]
            moved[index] += _DIFFERENCE
            found = self.kernel.evaluate(self.time, moved, guess, ledger)
            jacobian[:, column] = (found - rates)[self.balanced] / _DIFFERENCE
            self._follow[:, column] = (guess - unknowns) / _DIFFERENCE
        if not (np.isfinite(rates).all() and np.isfinite(jacobian).all()):
            raise NumericalError("the rates are no finite numbers at a trial point")
        self._base, self._unknowns = part.copy(), unknowns
        return rates[self.balanced], jacobian

    def _derive(self, state: Vector, unknowns: Vector) -> Any:
        return self.derivatives.total(self.time, state, unknowns, self.kernel.parameters)


def _where(kernel: Kernel, index: int, time: float) -> str:
    return f"block '{kernel.equations.blocks[index].name}' at t = {time:.9g} s"


def _per_second(unit: str) -> str:
    return f"{unit}^2" if unit.endswith("/s") else f"{unit}/s"


def _loose(equations: Equations, problem: BalancedRates, point: Vector, worst: int) -> list[str]:
    """Return states that can move together without any rate taking notice, few at most.

    None are returned if that of the rate which is worst in balance is not among them.
    """
    try:
        _, jacobian = problem.evaluate(point)
    except NumericalError:
        return []
    rows = np.abs(jacobian).max(axis=1, keepdims=True)
    _, sizes, directions = np.linalg.svd(jacobian / np.where(rows > 0.0, rows, 1.0))
    if not sizes.size or sizes[-1] > _LOOSE * sizes[0]:
        return []
    share = np.abs(directions[-1])
    if not share[worst] > 0.1 * share.max():
        return []
    taken = [k for k in np.argsort(-share) if share[k] > 0.1 * share.max()][:_NAMED]
    return [equations.states[problem.free[k]].name for k in taken]


def _reasons(
    equations: Equations,
    residual: Vector,
    balanced: Sequence[int],
    tolerance: float,
    not_held: Mapping[str, str],
) -> list[str]:
    """Return why the rates that stay cannot be balanced, where parts say so."""
    stay = [
        equations.states[k].name
        for k, r in zip(balanced, residual, strict=True)
        if not abs(r) <= tolerance
    ]
    names = [name.removesuffix("_rate") for name in stay]
    return list(dict.fromkeys(not_held[name] for name in names if name in not_held))


def _advice(reasons: Sequence[str], loose: Sequence[str]) -> str:
    if reasons:
        return "; ".join(reasons)
    if loose:
        return f"nothing holds {', '.join(loose)}: hold them by a spring or a drive"
    return "change loads or parameters, or start nearer to it"


def _unbalanced(
    equations: Equations,
    balanced: Sequence[int],
    residual: Vector,
    tolerance: float,
    advice: str,
) -> str:
    order = np.argsort(-np.abs(residual))
    worst = [k for k in order if not abs(residual[k]) <= tolerance][:_NAMED]
    rates = [
        f"{equations.states[balanced[k]].name} ({residual[k]:.4g} "
        f"{_per_second(equations.states[balanced[k]].unit)})"
        for k in worst
    ]
    return (
        f"no equilibrium of model '{equations.name}' near the starting point; rates that stay "
        f"unbalanced: {', '.join(rates)}; {advice}"
    )
