"""Residuals of constrained motion and their sparse Jacobian, as numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.interpreted import BufferedFunction
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic.constrained_equations import ConstrainedEquations


class Instant(NamedTuple):
    """Time [s], coordinates, their rates, accelerations, multipliers and further states."""

    time: float
    position: Vector
    velocity: Vector
    acceleration: Vector
    multiplier: Vector
    other: Vector


class Residuals(NamedTuple):
    """What is left of forces, constraints and their rates, and the rates of further states."""

    force: Vector
    gap: Vector
    opening: Vector
    other_rate: Vector


class Sparse(NamedTuple):
    """A sparse matrix by rows and columns of its elements, and their values."""

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    values: Vector
    shape: tuple[int, int]

    def matrix(self) -> Any:
        """Return it in compressed columns."""
        from scipy.sparse import csc_matrix

        return csc_matrix((self.values, (self.rows, self.columns)), shape=self.shape)


class Partials(NamedTuple):
    """Derivatives, named by what and by which variable: f forces, s other rates, h openings."""

    f_a: Sparse
    f_v: Sparse
    f_q: Sparse
    f_s: Sparse
    s_v: Sparse
    s_q: Sparse
    s_s: Sparse
    h_q: Sparse
    jacobian: Sparse


class ResidualFunctions:
    """Evaluates the residuals of a motion and their derivatives, which are exact."""

    def __init__(self, equations: ConstrainedEquations) -> None:
        """Differentiate the residuals; only elements that are not always zero are kept."""
        import casadi

        e = self.equations = equations
        inputs = [e.time, e.position, e.velocity, e.acceleration, e.multiplier, e.other]
        inputs.append(e.parameter)
        results = [casadi.densify(x) for x in (e.force, e.gap, e.opening, e.other_rate)]
        self._residual = BufferedFunction(_function("residual", inputs, results))
        blocks = [
            *(casadi.jacobian(e.force, x) for x in (e.acceleration, e.velocity)),
            *(casadi.jacobian(e.force, x) for x in (e.position, e.other)),
            *(casadi.jacobian(e.other_rate, x) for x in (e.velocity, e.position, e.other)),
            casadi.jacobian(e.opening, e.position),
            e.spread,
        ]
        self._patterns = []
        for block in blocks:
            rows, columns = block.sparsity().get_triplet()
            self._patterns.append((np.array(rows, int), np.array(columns, int), block.shape))
        values = [casadi.vertcat(casadi.SX(0, 1), *block.nonzeros()) for block in blocks]
        self._partials = BufferedFunction(_function("partials", inputs, values))
        lift = [casadi.densify(e.quadratic + e.jacobian @ e.acceleration)]
        self._lift = BufferedFunction(_function("lift", inputs, lift))
        spread = [casadi.vertcat(casadi.SX(0, 1), *e.spread.nonzeros())]
        self._jacobian = BufferedFunction(_function("jacobian", inputs, spread))
        self._inputs = inputs
        self._output: BufferedFunction | None = None
        self.sizes = e.position.numel(), e.other.numel(), e.multiplier.numel()

    def residuals(self, at: Instant, parameters: Vector) -> Residuals:
        """Return the residuals at an instant."""
        return Residuals(*self._residual(*at, parameters))

    def partials(self, at: Instant, parameters: Vector) -> Partials:
        """Return the derivatives at an instant."""
        found = self._partials(*at, parameters)
        pairs = zip(self._patterns, found, strict=True)
        return Partials(*[Sparse(r, c, value, shape) for (r, c, shape), value in pairs])

    def jacobian(self, at: Instant, parameters: Vector) -> Sparse:
        """Return the Jacobian of the constraints at an instant, its elements column by column."""
        rows, columns, shape = self._patterns[-1]
        return Sparse(rows, columns, self._jacobian(*at, parameters)[0], shape)

    @property
    def shows_own(self) -> bool:
        """Whether channels off the constraints are others than those of the equations."""
        return self.equations.output is not None

    def outputs(self, at: Instant, parameters: Vector) -> Vector:
        """Return the channels at an instant, with its own accelerations and multipliers."""
        import casadi

        if self._output is None:
            output = self.equations.output
            if output is None:
                raise ValueError("these residuals have no channels of their own")
            results = [casadi.densify(output())]
            self._output = BufferedFunction(_function("output", self._inputs, results))
        return self._output(*at, parameters)[0]

    def lift(self, at: Instant, parameters: Vector) -> Vector:
        """Return the accelerations of the constraints at those of the coordinates."""
        return self._lift(*at, parameters)[0]


def residual_functions(kernel: Kernel) -> ResidualFunctions:
    """Return the residuals of a kernel's equations, derived once for each kernel.

    Raises
    ------
    InputError
        If the equations have no such form.
    """
    made: dict[str, Any] = kernel.made
    if "constrained residuals" not in made:
        derive: Callable[[], Any] | None = kernel.equations.constrained
        if derive is None:
            raise InputError(
                f"the equations of '{kernel.equations.name}' were not derived from bodies and "
                "joints; 'constraints' of this method must be 'reduced'"
            )
        made["constrained residuals"] = ResidualFunctions(derive())
    functions: ResidualFunctions = made["constrained residuals"]
    return functions


def lightness_of(kernel: Kernel) -> Vector:
    """Return the inverse masses of the coordinates where the model starts, one where none is."""
    functions = residual_functions(kernel)
    (n, _, m), e = functions.sizes, functions.equations
    state = np.array([variable.start for variable in kernel.equations.states], dtype=float)
    q, v, s = (state[list(part)] for part in (e.positions, e.velocities, e.others))
    start = Instant(0.0, q, v, np.zeros(n), np.zeros(m), s)
    masses = functions.partials(start, kernel.parameters).f_a.matrix().diagonal()
    found: Vector = 1.0 / np.where(np.isfinite(masses) & (masses > 0.0), masses, 1.0)
    return found


def _function(name: str, inputs: list[Any], results: list[Any]) -> Any:
    import casadi

    return casadi.Function(name, inputs, results, {"cse": True})
