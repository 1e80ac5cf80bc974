"""Linear systems in state space: made proper, reduced by balanced truncation.

dx/dt = A x + B u,    y = C x + D u
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.transfer import TransferSystem
from vehicledyn.base.errors import InputError

Floats = NDArray[np.float64]

_NOTHING = 1e-12
"""Part of a matrix's largest entry below which a product that should vanish counts as zero."""

_STABLE = 1e-7
"""Part of the fastest eigenvalue that a growth must be below zero to be cut away."""


@dataclass(frozen=True)
class StateSpace:
    """A, B, C and D of a linear system; ``hankel`` are the singular values of its stable part.

    ``error`` bounds what a reduction changes of the largest gain at any frequency.
    """

    a: Floats
    b: Floats
    c: Floats
    d: Floats
    hankel: Floats
    error: float = 0.0

    def response(self, frequencies: Floats) -> NDArray[np.complex128]:
        """Return the response at frequencies [Hz], shape (n_frequencies, n_outputs, n_inputs)."""
        unit = np.eye(len(self.a))
        return np.array(
            [
                self.c @ np.linalg.solve(2j * np.pi * f * unit - self.a, self.b) + self.d
                for f in frequencies
            ]
        )


def proper(system: TransferSystem) -> tuple[StateSpace, list[int]]:
    """Return a transfer system in state space, and of which order each input is taken.

    Rates and accelerations of an input are taken into the states,

        x = z + (B_1 + A B_2) u + B_2 du/dt,

    where no output feels them directly: its order is zero. Else its rate (order one) or its
    acceleration (two) is the input, and it becomes a state itself, behind those of the system.

    Raises
    ------
    InputError
        If an input acts with a delay.
    """
    a, c = np.asarray(system.matrix, dtype=float), np.asarray(system.output, dtype=float)
    parts, orders = [], []
    for terms in system.inputs:
        if any(term.delay for term in terms):
            raise InputError(
                "a road that wheels run over one after the other has no state space; "
                "take an input for each wheel"
            )
        b = sum((t.factor * t.state for t in terms), np.zeros((3, len(a))))
        d = sum((t.factor * t.output for t in terms), np.zeros((3, len(c))))
        shift = b[1] + a @ b[2]
        size = max(float(np.max(np.abs(d), initial=0.0)), float(np.max(np.abs(c @ b.T))), 1e-300)
        improper = np.maximum(np.abs(d[1] + c @ b[2]), np.abs(d[2]))
        if np.max(improper, initial=0.0) <= _NOTHING * size:
            b, d = np.stack([b[0] + a @ shift]), np.stack([d[0] + c @ shift])
        elif not (b[2].any() or d[2].any()):
            b, d = b[:2], d[:2]
        parts.append((b, d))
        orders.append(len(b) - 1)
    return _with_inputs(a, c, parts), orders


def _with_inputs(a: Floats, c: Floats, parts: list[tuple[Floats, Floats]]) -> StateSpace:
    """Return a system with the lower derivatives of each input as states behind the others."""
    n, n_more = len(a), sum(len(b) - 1 for b, _ in parts)
    whole = np.zeros((n + n_more, n + n_more))
    whole[:n, :n] = a
    output = np.hstack([c, np.zeros((len(c), n_more))])
    drive, direct = np.zeros((n + n_more, len(parts))), np.zeros((len(c), len(parts)))
    place = n
    for k, (b, d) in enumerate(parts):
        own = list(range(place, place + len(b) - 1))
        whole[:n, own], output[:, own] = b[:-1].T, d[:-1].T
        drive[:n, k], direct[:, k] = b[-1], d[-1]
        for lower, higher in itertools.pairwise(own):
            whole[lower, higher] = 1.0
        if own:
            drive[own[-1], k] = 1.0
        place += len(own)
    return StateSpace(whole, drive, output, direct, _hankel(whole, drive, output))


def reduced(system: StateSpace, order: int) -> StateSpace:
    """Return a system of lower order by balanced truncation; its unstable part is kept whole.

    The largest gain of what is lost is at most twice the sum of the Hankel singular values that
    are cut away.

    Parameters
    ----------
    system
        The system.
    order
        Number of states to keep.

    Raises
    ------
    InputError
        If the order is not between that of the unstable part and the full one.

    References
    ----------
    Antoulas (2005), Approximation of Large-Scale Dynamical Systems, chapter 7.
    """
    n = len(system.a)
    a_kept, b_kept, c_kept, stable = _parted(system)
    n_kept = len(a_kept)
    if not n_kept <= order <= n:
        raise InputError(
            f"order: {order} states are too few or too many; give {n_kept} to {n}: modes that do "
            f"not decay have {n_kept} states, which are all kept"
        )
    left, right, values = _balancing(stable.a, stable.b, stable.c)
    count = min(order - n_kept, int(np.sum(values > _NOTHING * np.max(values, initial=0.0))))
    scale = 1.0 / np.sqrt(values[:count])
    back, forth = scale[:, None] * left[:, :count].T, right[:, :count] * scale
    a = np.block(
        [
            [a_kept, np.zeros((n_kept, count))],
            [np.zeros((count, n_kept)), back @ stable.a @ forth],
        ]
    )
    b, c = np.vstack([b_kept, back @ stable.b]), np.hstack([c_kept, stable.c @ forth])
    error = 2.0 * float(np.sum(values[count:]))
    return replace(system, a=a, b=b, c=c, hankel=values, error=error)


def _parted(system: StateSpace) -> tuple[Floats, Floats, Floats, StateSpace]:
    """Return A, B and C of the part that does not decay, and the stable part."""
    from scipy.linalg import schur, solve_sylvester

    limit = -_STABLE * max(float(np.max(np.abs(np.linalg.eigvals(system.a)), initial=0.0)), 1e-300)
    form, basis, n = schur(system.a, sort=lambda re, _im: bool(re >= limit))
    # [I X; 0 I] decouples the blocks of the triangular form.
    corner = solve_sylvester(form[:n, :n], -form[n:, n:], -form[:n, n:])
    b, c = basis.T @ system.b, system.c @ basis
    kept_b = b[:n] - corner @ b[n:]
    stable_c = c[:, n:] + c[:, :n] @ corner
    stable = StateSpace(form[n:, n:], b[n:], stable_c, system.d, np.zeros(0))
    return form[:n, :n], kept_b, c[:, :n], stable


def _balancing(a: Floats, b: Floats, c: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the factors of the balancing transformation and the Hankel singular values."""
    if not len(a):
        return np.zeros((0, 0)), np.zeros((0, 0)), np.zeros(0)
    from scipy.linalg import solve_continuous_lyapunov, svd

    reach = _root(solve_continuous_lyapunov(a, -b @ b.T))
    watch = _root(solve_continuous_lyapunov(a.T, -c.T @ c))
    u, values, v = svd(watch.T @ reach)
    return watch @ u, reach @ v.T, values


def _root(gramian: Floats) -> Floats:
    """Return a square root of a symmetric matrix without negative eigenvalues but by rounding."""
    values, vectors = np.linalg.eigh(0.5 * (gramian + gramian.T))
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)), dtype=float)


def _hankel(a: Floats, b: Floats, c: Floats) -> Floats:
    stable = _parted(StateSpace(a, b, c, np.zeros((len(c), b.shape[1])), np.zeros(0)))[3]
    return _balancing(stable.a, stable.b, stable.c)[2]
