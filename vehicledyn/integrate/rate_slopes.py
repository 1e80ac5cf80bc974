"""Derivatives of rates along closed loops: compiled for large models or where many are wanted."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from vehicledyn.integrate.compiled_jacobian import CompiledJacobian
from vehicledyn.integrate.implicit import implicit_equations, is_compiled_already
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Progress

_WORTH_WAITING = 6_000
"""Columns that are interpreted before: as long as the compiler takes, whatever the model's size."""


@dataclass
class RateSlopes:
    """Evaluates dẋ/dx of a kernel; ``progress`` is told when a compiler works.

    ``left`` counts the columns that are interpreted before the others are compiled.
    """

    kernel: Kernel
    progress: Progress
    left: float = 0.0
    compiled: CompiledJacobian | None = None
    derivatives: Derivatives = field(init=False)

    def __post_init__(self) -> None:
        """Decide how much is interpreted first."""
        e, made = self.kernel.equations, self.kernel.made
        if "total derivatives" not in made:
            made["total derivatives"] = Derivatives(e, outputs=False, often=not self.kernel.key)
        self.derivatives = made["total derivatives"]
        self._columns = len(e.states) + len(e.unknowns)
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
        self.left -= self._columns
        return self.derivatives.total(time, state, unknowns, parameters).rates

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
