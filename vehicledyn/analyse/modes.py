"""Eigenmodes of a linear system, with the zeros that belong to free motions distinguished."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.analyse.zero_eigenvalues import named_chains, staircase
from vehicledyn.kernel.engine import Vector

_NOISE = 1e-11
_DOMINANT = 0.1


@dataclass(frozen=True)
class Mode:
    """One mode; of a complex pair the one with positive imaginary part stands for both.

    ``eigenvalue`` [1/s], ``frequency`` of the undamped motion |λ|/2π [Hz], ``damping_ratio``
    -Re λ/|λ| (0 for a zero), ``shape`` (n_states,), its largest element 1, ``dominant``: the
    states with at least a tenth of the participation, largest first, and ``participation``
    (n_states,), |w_i v_i| of left and right eigenvector, of sum 1.

    Of a zero, ``level`` is the place k in its chain, the smallest with Aᵏ v = 0, and ``shape``
    is v, 1 at the state that names it: 1 is a state in which the system stays, 2 one in which
    it drifts evenly into a state of level 1, as a free body at constant speed. Other modes have
    the level 0.
    """

    eigenvalue: complex
    frequency: float
    damping_ratio: float
    shape: Any
    dominant: tuple[str, ...]
    participation: Any = None
    level: int = 0

    @property
    def kind(self) -> str:
        """What the mode is: "oscillation", "aperiodic", and of zeros "free" or "drift"."""
        if self.is_zero:
            return "drift" if self.level > 1 else "free"
        return "oscillation" if self.is_oscillation else "aperiodic"

    @property
    def is_zero(self) -> bool:
        """Whether the mode is a free motion, with an eigenvalue that is exactly zero."""
        return self.eigenvalue == 0

    @property
    def is_oscillation(self) -> bool:
        """Whether the mode stands for a complex pair."""
        return self.eigenvalue.imag != 0.0


def eigenmodes(matrix: Any, names: Sequence[str]) -> tuple[Mode, ...]:
    """Return the modes of d(δx)/dt = A δx, zeros first, then by rising frequency.

    A state that moves nothing (a position, a heading) makes a zero; such states are set apart
    before the eigenvalues are computed, because repeated zeros come out as large as the square
    root of the rounding error. Zeros that only a sum of states makes (two masses on a spring,
    free) are taken away by the staircase of :mod:`~vehicledyn.analyse.zero_eigenvalues`.
    Participation is
    |w_i v_i| of left and right eigenvectors, which does not depend on units: Pérez-Arriaga,
    Verghese, Schweppe (1982), IEEE Trans. PAS 101(9).

    Parameters
    ----------
    matrix
        A, shape (n_states, n_states).
    names
        Names of the states.
    """
    a = np.array(matrix, dtype=float)
    removed, core = _set_apart(a)
    modes, hidden = _core_modes(a, removed, core, names)
    modes += _zero_modes(a, [index for index, _ in removed], hidden, names)
    return tuple(sorted(modes, key=lambda mode: (mode.frequency, mode.eigenvalue.real)))


def _set_apart(a: Vector) -> tuple[list[tuple[int, bool]], list[int]]:
    """Return the states set apart, with whether they follow the others, and the rest.

    A state follows if no rate depends on it (zero column); one that never moves has a zero
    row. Elements far below the largest of their row, as rounding leaves
    them, count as zero.
    """
    significant = _significant(a)
    core = list(range(a.shape[0]))
    removed: list[tuple[int, bool]] = []
    searching = True
    while searching:
        searching = False
        for index in list(core):
            follows = not significant[core, index].any()
            if follows or not significant[index, core].any():
                core.remove(index)
                removed.append((index, follows))
                searching = True
    return removed, core


def _significant(a: Vector) -> Any:
    """Return which elements are more than rounding of the largest of their row."""
    size = np.abs(a)
    return size > _NOISE * size.max(axis=1, initial=0.0)[:, None]


def _zero_modes(a: Vector, removed: list[int], hidden: int, names: Sequence[str]) -> list[Mode]:
    """Return the zeros: states set apart, and as many as the core hides, with their chains."""
    count = len(removed) + hidden
    if not count:
        return []
    stairs = staircase(np.where(_significant(a), a, 0.0))
    if stairs.zeros != count:  # rounding hides a chain; what is set apart is certain
        shapes = [(index, np.eye(len(a))[index], 1) for index in removed]
        return [_zero_mode(chain, names) for chain in shapes]
    return [_zero_mode(chain, names) for chain in named_chains(*stairs.chains(), removed)]


def _zero_mode(chain: tuple[int, Vector, int], names: Sequence[str]) -> Mode:
    index, vector, level = chain
    participation = np.eye(len(vector))[index]
    return Mode(0j, 0.0, 0.0, vector.astype(complex), (names[index],), participation, level)


def _core_modes(
    a: Vector, removed: list[tuple[int, bool]], core: list[int], names: Sequence[str]
) -> tuple[list[Mode], int]:
    """Return the modes that are no zeros, and how many zeros the core hides."""
    from scipy.linalg import eig

    if not core:
        return [], 0
    stairs = staircase(a[np.ix_(core, core)])
    if not stairs.core.size:
        return [], stairs.zeros
    inner = stairs.core if stairs.zeros else a[np.ix_(core, core)]
    values, left, right = eig(inner, left=True, right=True)
    modes = []
    for k, value in enumerate(values):
        if value.imag < 0.0:
            continue
        vectors = left[:, k], right[:, k]
        if stairs.zeros:
            vectors = stairs.left(left[:, k]), stairs.right(complex(value), right[:, k])
        participation = np.zeros(len(a))
        participation[core] = np.abs(vectors[0] * vectors[1])
        participation /= participation.sum()
        shape = _whole_shape(a, removed, core, (complex(value), vectors[1]))
        modes.append(_mode(complex(value), shape, participation, names))
    return modes, stairs.zeros


def _mode(eigenvalue: complex, shape: Any, participation: Vector, names: Sequence[str]) -> Mode:
    size = abs(eigenvalue)
    dominant = _dominant(participation, names)
    damping = -eigenvalue.real / size if size else 0.0
    return Mode(eigenvalue, size / (2.0 * math.pi), damping, shape, dominant, participation)


def _dominant(participation: Vector, names: Sequence[str]) -> tuple[str, ...]:
    order = np.argsort(-participation, kind="stable")
    total = participation.sum()
    chosen = [k for k in order if participation[k] >= _DOMINANT * total]
    return tuple(names[k] for k in chosen)


def _whole_shape(
    a: Vector, removed: list[tuple[int, bool]], core: list[int], inner: tuple[complex, Any]
) -> Any:
    """Return the shape in all states: those set apart follow as λ v_j = Σ a_jk v_k."""
    eigenvalue, part = inner
    shape = np.zeros(a.shape[0], dtype=complex)
    shape[core] = part
    for index, follows in reversed(removed):
        if follows and eigenvalue != 0:
            shape[index] = a[index] @ shape / eigenvalue
    return shape / shape[np.argmax(np.abs(shape))]
