"""Equilibria along a parameter, their eigenvalues, and where an oscillation begins to grow."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.basis import basis
from vehicledyn.analyse.periodic.collocation import Direction
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector

_ITERATIONS, _BISECTIONS = 40, 60
_FOUND = 1e-12
_TURNING = 1e-6
"""Least imaginary part of an oscillation, part of the largest eigenvalue."""

_ZERO = 1e-7
"""Magnitude of eigenvalues that are zero but for rounding, part of the largest."""

_RANK, _ROUNDS = 1e-10, 8
"""Singular value that counts as zero once the matrix is balanced, and rounds of balancing."""

_PURE = 1e-5
"""Largest real part at a Hopf bifurcation, part of the magnitude."""


def growing_oscillations(eigenvalues: Vector) -> int:
    """Return the number of oscillations that grow, of eigenvalues (n,) [1/s]."""
    least = _TURNING * float(np.abs(eigenvalues).max(initial=0.0))
    return int(((eigenvalues.imag > least) & (eigenvalues.real > 0.0)).sum())


@dataclass(frozen=True)
class CriticalPoint:
    """An equilibrium at a value of the parameter, with its eigenvalues (n_kept,) [1/s]."""

    value: float
    state: Vector
    unknowns: Vector
    eigenvalues: Vector

    @property
    def growing_pairs(self) -> int:
        """Number of oscillations that grow."""
        return growing_oscillations(self.eigenvalues)

    @property
    def largest_real_part(self) -> float:
        """Real part of the eigenvalue that decides about stability [1/s]."""
        return float(self.eigenvalues.real.max())


@dataclass(frozen=True)
class Hopf:
    """Equilibrium with a purely imaginary pair: its frequency ω [rad/s] and shape.

    ``shape`` (n_kept,) and ``unknowns_shape`` are complex; ``begins`` says whether the
    oscillation begins to grow, rather than to decay, where the parameter gets larger.
    """

    balance: CriticalPoint
    frequency: float
    shape: Vector
    unknowns_shape: Vector
    begins: bool

    def orbit(self, amplitude: float, leading: int, *, intervals: int, degree: int) -> Orbit:
        """Return the small oscillation in which a state has an amplitude in its unit."""
        factor = amplitude / self.shape[leading]
        rule = basis(degree)
        mesh = np.linspace(0.0, 1.0, intervals + 1)
        empty = np.zeros((intervals * degree, 0))
        bare = Orbit(rule, mesh, empty, empty, 2.0 * np.pi / self.frequency, self.balance.value)
        own, gauss = bare.times_of(mesh)
        return Orbit(
            rule,
            mesh,
            self.balance.state + _wave(own, factor * self.shape),
            self.balance.unknowns + _wave(gauss, factor * self.unknowns_shape),
            2.0 * np.pi / self.frequency,
            self.balance.value,
        )

    def growing(self, orbit: Orbit) -> Direction:
        """Return the direction in which a small oscillation becomes larger."""
        return Direction(orbit.states - self.balance.state, 0.0, 0.0)


def find_balance(
    field: AutonomousField, value: float, state: Vector, unknowns: Vector
) -> CriticalPoint:
    """Return the equilibrium near a point, with its eigenvalues.

    Where a shift makes no difference (a neutral direction), the nearest one.

    Raises
    ------
    NumericalError
        If there is none near.
    """
    x, z = np.array(state, dtype=float), np.array(unknowns, dtype=float)
    for _ in range(_ITERATIONS):
        found = field.evaluate(x[None], z[None], value)
        step = -np.linalg.lstsq(found.by_state[0], found.rates[0], rcond=_FOUND)[0]
        correction = found.gap[0] + found.follow[0] @ step
        x, z = x + step, z - correction
        small = np.abs(step) <= _FOUND * (1.0 + np.abs(x))
        if small.all() and (np.abs(correction) <= 1e2 * _FOUND * (1.0 + np.abs(z))).all():
            found = field.evaluate(x[None], z[None], value)
            return CriticalPoint(value, x, z, np.linalg.eigvals(found.by_state[0]).astype(complex))
        if not np.isfinite(x).all():
            break
    raise NumericalError(f"there is no equilibrium near by at {field.parameter} = {value:.9g}")


def follow_balance(
    field: AutonomousField, values: Sequence[float], state: Vector, unknowns: Vector
) -> list[CriticalPoint]:
    """Return the equilibria at values of the parameter, each found from the one before."""
    found: list[CriticalPoint] = []
    for value in values:
        if found:
            state, unknowns = ahead(field, found[-1], value)
        found.append(find_balance(field, value, state, unknowns))
    return found


def ahead(field: AutonomousField, balance: CriticalPoint, value: float) -> tuple[Vector, Vector]:
    """Return states and unknowns of an equilibrium at another value, along the tangent.

    A wheel that rolls must turn faster with the speed: from its old rate it would slide.
    """
    found = field.evaluate(balance.state[None], balance.unknowns[None], balance.value)
    change = value - balance.value
    step = -np.linalg.lstsq(found.by_state[0], found.by_parameter[0], rcond=_FOUND)[0] * change
    unknowns = found.follow[0] @ step + found.follow_parameter[0] * change
    return balance.state + step, balance.unknowns - unknowns


Equilibria = Callable[[float, Vector, Vector], CriticalPoint]
"""Returns the equilibrium at a value near states and unknowns."""


def neutral_directions(field: AutonomousField, balance: CriticalPoint) -> Vector:
    """Return directions of states in which an equilibrium stays one, shape (n_kept, n_neutral).

    Such is the rolling speed of a vehicle that nothing drives or slows.
    """
    matrix = field.evaluate(balance.state[None], balance.unknowns[None], balance.value).by_state[0]
    columns = np.ones(len(matrix))
    with np.errstate(divide="ignore"):
        for _ in range(_ROUNDS):
            rows = 1.0 / np.sqrt(np.abs(matrix).max(axis=1))
            matrix = matrix * np.where(np.isfinite(rows), rows, 1.0)[:, None]
            own = 1.0 / np.sqrt(np.abs(matrix).max(axis=0))
            own = np.where(np.isfinite(own), own, 1.0)
            matrix, columns = matrix * own, columns * own
    _, values, right = np.linalg.svd(matrix)
    left = values <= _RANK * values.max(initial=np.finfo(float).tiny)
    return np.asarray(np.linalg.qr(columns[:, None] * right[left].T)[0])


@dataclass(frozen=True)
class Divergence:
    """A real eigenvalue passes zero; ``begins`` where the parameter rises into the growth."""

    value: float
    begins: bool


def find_hopf(
    field: AutonomousField, balances: Sequence[CriticalPoint], at: Equilibria | None = None
) -> list[Hopf]:
    """Return the Hopf bifurcations between successive equilibria, in their order.

    ``at`` finds equilibria between them; by default those near their means.
    """
    find = at or partial(find_balance, field)
    found: list[Hopf] = []
    for before, after in pairwise(balances):
        found += _between(field, find, before, after, 6)
    return found


def find_divergence(
    field: AutonomousField, balances: Sequence[CriticalPoint], at: Equilibria | None = None
) -> list[Divergence]:
    """Return where real eigenvalues pass zero between successive equilibria, in their order.

    Eigenvalues that are zero at all of them, of neutral directions, do not count.
    """
    if not balances:
        return []
    find = at or partial(find_balance, field)
    largest = max(float(np.abs(b.eigenvalues).max(initial=0.0)) for b in balances)
    zeros = min(int((np.abs(b.eigenvalues) <= _ZERO * largest).sum()) for b in balances)
    found = []
    for before, after in pairwise(balances):
        low, high = before, after
        first, last = _growing(low, zeros), _growing(high, zeros)
        if (last - first) % 2 == 0:
            continue
        for _ in range(_BISECTIONS):
            middle = _midway(find, low, high)
            if middle.value in (low.value, high.value):
                break
            is_low = (_growing(middle, zeros) - first) % 2 == 0
            low, high = (middle, high) if is_low else (low, middle)
        found.append(Divergence(low.value, last > first))
    return found


def _growing(balance: CriticalPoint, zeros: int) -> int:
    """Return the number of real eigenvalues above zero, the smallest ones left out."""
    order = np.argsort(np.abs(balance.eigenvalues))[zeros:]
    values = balance.eigenvalues[order]
    return int(((values.imag == 0.0) & (values.real > 0.0)).sum())


def _between(
    field: AutonomousField, find: Equilibria, low: CriticalPoint, high: CriticalPoint, depth: int
) -> list[Hopf]:
    change = high.growing_pairs - low.growing_pairs
    if not change:
        return []
    if abs(change) > 1 and depth:
        middle = _midway(find, low, high)
        return [
            *_between(field, find, low, middle, depth - 1),
            *_between(field, find, middle, high, depth - 1),
        ]
    first = low.growing_pairs
    for _ in range(_BISECTIONS):
        middle = _midway(find, low, high)
        if middle.value in (low.value, high.value):
            break
        low, high = (middle, high) if middle.growing_pairs == first else (low, middle)
    hopf = _hopf(field, low, begins=change > 0)
    return [hopf] if hopf else []


def _midway(find: Equilibria, low: CriticalPoint, high: CriticalPoint) -> CriticalPoint:
    return find(
        0.5 * (low.value + high.value),
        0.5 * (low.state + high.state),
        0.5 * (low.unknowns + high.unknowns),
    )


def _hopf(field: AutonomousField, balance: CriticalPoint, *, begins: bool) -> Hopf | None:
    """Return the bifurcation at a point, None if no pair is purely imaginary there."""
    found = field.evaluate(balance.state[None], balance.unknowns[None], balance.value)
    values, vectors = np.linalg.eig(found.by_state[0])
    least = _TURNING * float(np.abs(values).max())
    pairs = np.flatnonzero(values.imag > least)
    if not pairs.size:
        return None
    chosen = pairs[np.argmin(np.abs(values[pairs].real) / np.abs(values[pairs]))]
    if abs(values[chosen].real) > _PURE * abs(values[chosen]):
        return None
    shape = vectors[:, chosen]
    return Hopf(balance, float(values[chosen].imag), shape, -found.follow[0] @ shape, begins)


def _wave(places: Vector, shape: Vector) -> Vector:
    turn = np.exp(2j * np.pi * places)
    return np.asarray((turn[:, None] * shape[None, :]).real)
