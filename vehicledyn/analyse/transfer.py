"""Transfer functions of a linear system, evaluated on the imaginary axis.

    s x = A x + (B_0 + s B_1 + s² B_2) u,    y = C x + (D_0 + s D_1 + s² D_2) u,    s = i ω

The terms s and s² belong to inputs that move a coordinate: its rate and acceleration act too.
Each frequency is solved by itself with the balanced matrix, so that rounding near a pole grows
no more than the distance to the pole demands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.analyse.zero_eigenvalues import staircase
from vehicledyn.kernel.engine import Vector

_TABLE = 4_000_000
"""Elements of the matrices that are solved at once."""

_NOISE = 1e-11
_CONSISTENT = 1e-8
"""Part of its factors below which a product that should vanish counts as zero [1]."""


@dataclass(frozen=True)
class InputTerm:
    """How one input u, its rate and its acceleration enter: B and D by powers of s.

    ``state`` has the shape (3, n_states) and ``output`` (3, n_outputs). A term is felt with a
    ``delay`` [s] and multiplied by ``factor``.
    """

    state: Vector
    output: Vector
    delay: float = 0.0
    factor: float = 1.0


@dataclass(frozen=True)
class TransferSystem:
    """A linear system with outputs C (n_outputs, n_states); each input is a sum of terms."""

    matrix: Vector
    output: Vector
    inputs: tuple[tuple[InputTerm, ...], ...]

    def response(self, frequencies: Any) -> Any:
        """Return the complex response, shape (n_frequencies, n_inputs, n_outputs).

        Where a frequency hits an undamped pole exactly the response is infinite.

        Parameters
        ----------
        frequencies
            Above zero, shape (n_frequencies,) [Hz].
        """
        s = 2j * np.pi * np.atleast_1d(np.asarray(frequencies, dtype=float))
        a, scale = _balanced(self.matrix)
        found = np.zeros((len(s), len(self.inputs), self.output.shape[0]), dtype=complex)
        step = max(1, _TABLE // max(a.size, 1))
        for first in range(0, len(s), step):
            part = slice(first, first + step)
            with np.errstate(over="ignore", invalid="ignore"):  # at undamped poles
                found[part] = self._block(s[part], a, scale)
        found[~np.isfinite(found)] = complex(np.inf, 0.0)
        return found

    def static_gain(self) -> Any:
        """Return the response at rest, shape (n_inputs, n_outputs); nan where there is none.

        There is none where the output never settles, as the position of a car that is steered.
        """
        gains = np.full((len(self.inputs), self.output.shape[0]), np.nan)
        for i, terms in enumerate(self.inputs):
            drive = np.sum([t.factor * _undelayed(t.state, t.delay) for t in terms], axis=0)
            direct = sum(term.factor * term.output[0] for term in terms)
            for k, row in enumerate(self.output):
                settled = static_response(self.matrix, drive, row)
                if settled is not None:
                    gains[i, k] = settled + np.asarray(direct)[k]
        return gains

    def _block(self, s: Any, a: Vector, scale: Vector) -> Any:
        """Return the response at some s."""
        powers = np.stack([np.ones_like(s), s, s * s], axis=1)
        terms = [term for terms in self.inputs for term in terms]
        weights = np.stack([t.factor * np.exp(-s * t.delay) for t in terms], axis=1)
        drive = np.einsum("fp,tpn->fnt", powers, np.stack([t.state for t in terms]))
        direct = np.einsum("fp,tpk->ftk", powers, np.stack([t.output for t in terms]))
        inside = np.zeros_like(direct)
        if a.size:
            shifted = s[:, None, None] * np.eye(len(a)) - a
            inside = np.einsum("kn,fnt->ftk", self.output * scale, _solve(shifted, drive, scale))
        whole = weights[:, :, None] * (inside + direct)
        owners = np.repeat(np.arange(len(self.inputs)), [len(t) for t in self.inputs])
        return np.stack(
            [whole[:, owners == i].sum(axis=1) for i in range(len(self.inputs))], axis=1
        )


def _solve(shifted: Any, drive: Any, scale: Vector) -> Any:
    """Return x of (s I - A) x = b in balanced states, with one step of refinement."""
    right = drive / scale[:, None]
    try:
        found = np.linalg.solve(shifted, right)
        return found + np.linalg.solve(shifted, right - shifted @ found)
    except np.linalg.LinAlgError:
        return np.stack([_solve_one(m, b) for m, b in zip(shifted, right, strict=True)])


def _solve_one(matrix: Any, right: Any) -> Any:
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return np.full(right.shape, complex(np.inf, 0.0))


def _balanced(matrix: Vector) -> tuple[Vector, Vector]:
    from scipy.linalg import matrix_balance

    if not matrix.size:
        return matrix, np.ones(0)
    balanced, (scale, _) = matrix_balance(matrix, permute=False, separate=True)
    return balanced, scale


def static_response(matrix: Vector, drive: Vector, row: Vector) -> float | None:
    """Return the limit of c (s I - A)⁻¹ (b_0 + s b_1 + s² b_2) for s → 0, None if unbounded.

    A car that is steered has poles at zero, those of its place and heading, and yet its yaw rate
    settles. The staircase parts the poles at zero, with the nilpotent matrix Z, from the others,
    K; of c Σ Zᵏ s⁻ᵏ⁻¹ b the terms with negative powers must vanish.

    Parameters
    ----------
    matrix
        A, shape (n, n).
    drive
        b_0, b_1, b_2, shape (3, n).
    row
        c, shape (n,).
    """
    kept = _that_matter(matrix, np.abs(drive).max(axis=0), row)
    if not kept:
        return 0.0
    stairs = staircase(matrix[np.ix_(kept, kept)])
    axes, size = stairs.axes(), stairs.zeros
    right, left = axes.T @ (drive[:, kept] / stairs.scale).T, (row[kept] * stairs.scale) @ axes
    inner = axes.T @ (matrix[np.ix_(kept, kept)] * stairs.scale / stairs.scale[:, None]) @ axes
    zero, core, link = inner[:size, :size], inner[size:, size:], inner[:size, size:]
    mix = _parting(zero, core, link)
    right_zero, left_core = right[:size] - mix @ right[size:], left[size:] + left[:size] @ mix
    settled = -left_core @ np.linalg.solve(core, right[size:, 0]) if core.size else 0.0
    limit = _CONSISTENT * float(np.abs(left).max() * np.abs(right).max())
    rest = _laurent(zero, right_zero, left[:size], limit)
    return None if rest is None else float(settled + rest)


def _laurent(zero: Vector, right: Vector, left: Vector, limit: float) -> float | None:
    """Return the constant term of c Σ Zᵏ s⁻ᵏ⁻¹ (b_0 + s b_1 + s² b_2), None if it is unbounded.

    Terms up to ``limit`` count as zero.
    """
    powers: dict[int, list[float]] = {}
    reached = right
    for k in range(len(zero)):
        for order in range(right.shape[1]):
            powers.setdefault(order - k - 1, []).append(float(left @ reached[:, order]))
        reached = zero @ reached
    if any(abs(sum(terms)) > limit for power, terms in powers.items() if power < 0):
        return None
    return sum(powers.get(0, [0.0]))


def _parting(zero: Vector, core: Vector, link: Vector) -> Vector:
    """Return Y of Z Y - Y K = -X, which parts the poles at zero from the others."""
    from scipy.linalg import solve_sylvester

    if not zero.size or not core.size:
        return np.zeros(link.shape)
    return np.asarray(solve_sylvester(zero, -core, -link), dtype=float)


def _undelayed(state: Vector, delay: float) -> Vector:
    """Return b_0, b_1, b_2 with the first terms of exp(-s τ) in them."""
    first, second, third = state
    return np.stack(
        [first, second - delay * first, third - delay * second + 0.5 * delay**2 * first]
    )


def _that_matter(matrix: Vector, drive: Vector, row: Vector) -> list[int]:
    """Return the states that the input reaches and that reach the output, rounding apart."""
    size = np.abs(matrix)
    linked = size > _NOISE * size.max(axis=1, initial=0.0)[:, None]
    reached = _spread(linked, np.abs(drive) > _NOISE * np.abs(drive).max(initial=0.0))
    seen = _spread(linked.T, np.abs(row) > _NOISE * np.abs(row).max(initial=0.0))
    return [int(k) for k in np.flatnonzero(reached & seen)]


def _spread(linked: Any, start: Any) -> Any:
    """Return all states that can be reached from some along links (to, from)."""
    found = start.copy()
    while True:
        more = found | (linked @ found)
        if (more == found).all():
            return found
        found = more
