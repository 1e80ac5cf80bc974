"""Eigenmodes of a linear system, with the zeros that belong to free motions told apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.solve.engine import Vector

_NOISE = 1e-11
_ZERO = 1e-10
_DOMINANT = 0.1


@dataclass(frozen=True)
class Mode:
    """One mode; of a complex pair the one with positive imaginary part stands for both.

    ``eigenvalue`` [1/s], ``frequency`` of the undamped motion |λ|/2π [Hz], ``damping_ratio``
    -Re λ/|λ| (0 for a zero), ``shape`` (n_states,), its largest element 1, and ``dominant``:
    the states with at least a tenth of the participation, largest first.
    """

    eigenvalue: complex
    frequency: float
    damping_ratio: float
    shape: Any
    dominant: tuple[str, ...]

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
    root of the rounding error. Participation is |w_i v_i| of left and right eigenvectors, which
    does not depend on units: Pérez-Arriaga, Verghese, Schweppe (1982), IEEE Trans. PAS 101(9).

    Parameters
    ----------
    matrix
        A, shape (n_states, n_states).
    names
        Names of the states.
    """
    a = np.array(matrix, dtype=float)
    removed, core = _set_apart(a)
    modes = [_zero_mode(a.shape[0], index, names[index]) for index, _ in removed]
    modes += _core_modes(a, removed, core, names)
    return tuple(sorted(modes, key=lambda mode: (mode.frequency, mode.eigenvalue.real)))


def _set_apart(a: Vector) -> tuple[list[tuple[int, bool]], list[int]]:
    """Return the states set apart, with whether they follow the others, and the rest.

    A state follows if no rate depends on it (zero column); one that never moves has a zero
    row. Elements far below the largest of their row, as rounding leaves
    them, count as zero.
    """
    size = np.abs(a)
    significant = size > _NOISE * size.max(axis=1, initial=0.0)[:, None]
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


def _zero_mode(size: int, index: int, name: str) -> Mode:
    shape = np.zeros(size, dtype=complex)
    shape[index] = 1.0
    return Mode(0j, 0.0, 0.0, shape, (name,))


def _core_modes(
    a: Vector, removed: list[tuple[int, bool]], core: list[int], names: Sequence[str]
) -> list[Mode]:
    from scipy.linalg import eig

    if not core:
        return []
    inner = a[np.ix_(core, core)]
    values, left, right = eig(inner, left=True, right=True)
    smallest = _ZERO * np.abs(inner).max()
    modes = []
    for k, value in enumerate(values):
        if value.imag < 0.0:
            continue
        eigenvalue = complex(value) if abs(value) > smallest else 0j
        participation = np.abs(left[:, k] * right[:, k])
        dominant = _dominant(participation, [names[index] for index in core])
        shape = _whole_shape(a, removed, core, (complex(value), right[:, k]))
        modes.append(_mode(eigenvalue, shape, dominant))
    return modes


def _mode(eigenvalue: complex, shape: Any, dominant: tuple[str, ...]) -> Mode:
    size = abs(eigenvalue)
    ratio = -eigenvalue.real / size if size else 0.0
    return Mode(eigenvalue, size / (2.0 * math.pi), ratio, shape, dominant)


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
