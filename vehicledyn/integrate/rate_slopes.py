"""Derivatives of rates along closed loops, compiled where many are wanted.

Before, those of small models are interpreted; those of large ones, whose interpretation takes as
long as thousands of steps, are differences of the compiled rates.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.compiled_jacobian import CompiledJacobian
from vehicledyn.integrate.implicit import implicit_equations, is_compiled_already
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.kernel.engine import Ledger, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Progress

_WORTH_WAITING = 6_000
"""Columns that are interpreted before: as long as the compiler takes, whatever the model's size."""
_QUICKER = 100
"""Columns of differences in the time of an interpreted one."""
_LARGE = 2_000_000
"""Operations of a Jacobian above which it is found by differences: a tenth of a second."""
_PART = 3e-8
"""Difference of a state, for one plus its size."""


@dataclass
class RateSlopes:
    """Evaluates dẋ/dx of a kernel; ``progress`` is told when a compiler works.

    ``left`` counts the columns that are interpreted before the others are compiled.
    """

    kernel: Kernel
    progress: Progress
    left: float = 0.0
    compiled: CompiledJacobian | None = None

    def __post_init__(self) -> None:
        """Decide how much is interpreted first."""
        e, report = self.kernel.equations, self.kernel.report
        self._columns = len(e.states) + len(e.unknowns)
        self._is_large = bool(self.kernel.key) and (
            report.operations["rates"] * self._columns > _LARGE
        )
        self.left = 0.0 if is_compiled_already(self.kernel) else _WORTH_WAITING

    def __call__(self, time: float, state: Vector, unknowns: Vector, parameters: Vector) -> Vector:
        """Return dẋ/dx along closed loops at a point, shape (n_states, n_states).

        Raises
        ------
        NumericalError
            If the loops are singular there.
        """
        if self.compiled is None and self.left <= 0.0 and self.kernel.key:
            self._compile()
        if self.compiled is not None:
            return self.compiled.rates_by_states(time, state, unknowns, parameters)
        if self._is_large:
            self.left -= self._columns / _QUICKER
            found = self._differences(time, state, unknowns, parameters)
            if np.isfinite(found).all():
                return found
        self.left -= self._columns
        return self._derivatives.total(time, state, unknowns, parameters).rates

    @property
    def _derivatives(self) -> Derivatives:
        made = self.kernel.made
        if "total derivatives" not in made:
            often = not self.kernel.key
            made["total derivatives"] = Derivatives(
                self.kernel.equations, outputs=False, often=often
            )
        found: Derivatives = made["total derivatives"]
        return found

    def _differences(
        self, time: float, state: Vector, unknowns: Vector, parameters: Vector
    ) -> Vector:
        """Return differences, not a number where a loop cannot be closed."""
        if not np.array_equal(parameters, self.kernel.parameters):
            self.kernel = self.kernel.with_parameters(parameters)
        ledger, found = Ledger(), np.full((len(state), len(state)), np.nan)
        try:
            rates = self.kernel.evaluate(time, state, unknowns.copy(), ledger).copy()
            for k, value in enumerate(state):
                moved = state.copy()
                moved[k] = value + _PART * (1.0 + abs(value))
                other = self.kernel.evaluate(time, moved, unknowns.copy(), ledger)
                found[:, k] = (other - rates) / (moved[k] - value)
        except NumericalError:
            return found
        return found

    def _compile(self) -> None:
        """Take the code of the stiff methods, or stay as it is where there is none."""
        equations = implicit_equations(self.kernel, self.progress)
        self.left = math.inf
        if equations.library is not None:
            name = self.kernel.equations.name
            self.compiled = CompiledJacobian(equations, equations.library, name)


def slopes_of_rates(kernel: Kernel, progress: Progress) -> RateSlopes:
    """Return the derivatives of the rates of a kernel, made once for all its parameter sets."""
    if "rate slopes" not in kernel.made:
        kernel.made["rate slopes"] = RateSlopes(kernel, progress)
    found: RateSlopes = kernel.made["rate slopes"]
    return found
