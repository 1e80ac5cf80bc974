"""Where along an orbit the equations have a kink: mesh points are put there.

A spring that begins to act (a flange that touches) bends the motion and makes the derivatives
jump. Collocation is accurate only between such points, so each gets a mesh point, which moves
with it. So do means of channels with kinks of their own, such as a wear number's where a creepage
changes its side. Kinks are zeros of the arguments of min, max, abs, sign and comparisons in the
equations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.interpreted import BufferedFunction
from vehicledyn.symbolic.shared import inlined

ALIGNED = 1e-9
"""Distance, part of the period, at which a mesh point counts as lying on a kink."""

_LOOKS = 6
_REFINEMENTS = 60
_NOISE = 1e-9
_STRONG = 1e-6
_BESIDE = 1e-7
_FURTHER, _LASTING = 10.0, 0.5
_BEHIND, _BENT = 1e-6, 1e-5
"""Distance from a place, part of the period, at which rates of channels are compared, and part of
their range in a period by which these jump at a kink."""
_PAIRS = ("OP_FMIN", "OP_FMAX", "OP_LT", "OP_LE")
_SINGLES = ("OP_FABS", "OP_SIGN")


@dataclass(eq=False)
class Kinks:
    """Finds the kinks of a model along its orbits, of its rates and of some ``channels``."""

    model: AutonomousField
    channels: Sequence[int] = ()

    def __post_init__(self) -> None:
        """Collect the functions whose sign decides between branches of the equations."""
        import casadi

        m = self.model
        e = m.equations
        shown = casadi.SX(e.output[list(self.channels)])
        whole = inlined(casadi.vertcat(e.rate[m.kept], e.residual, shown))
        moving = casadi.vertcat(e.state[m.kept], e.algebraic)
        found = [item for item in deciders(whole) if casadi.depends_on(item, moving)]
        self.count = len(found)
        self._deciding = _Column(m, casadi.vertcat(*found) if found else casadi.SX(0, 1))
        self._shown = _Column(m, shown)

    def along(self, orbit: Orbit) -> Vector:
        """Return the places of strong kinks, parts of the period in rising order."""
        if not self.count:
            return np.zeros(0)
        widths = orbit.widths[:, None]
        inside = (np.arange(_LOOKS) + 0.5) / _LOOKS
        places = (orbit.mesh[:-1, None] + widths * inside).ravel()
        values = self._at(orbit, places)
        sizes = np.abs(values).max(axis=0)
        after = np.roll(values, -1, axis=0)
        ahead = np.append(places[1:], places[0] + 1.0)
        changed = (values * after < 0.0) & (np.minimum(abs(values), abs(after)) > _NOISE * sizes)
        i, k = np.nonzero(changed)
        found = self._refined(orbit, k, (places[i], ahead[i]), (values[i, k], after[i, k]))
        return self._strong(orbit, np.unique(found))

    def _refined(
        self, orbit: Orbit, k: Any, ends: tuple[Vector, Vector], values: tuple[Vector, Vector]
    ) -> Vector:
        """Return the zeros between pairs of places, by the Illinois variant of false position."""
        (a, b), (fa, fb) = ends, values
        rows = np.arange(len(a))
        for _ in range(_REFINEMENTS if len(a) else 0):
            slope = np.where(fb == fa, np.inf, fb - fa)
            middle = b - fb * (b - a) / slope
            value = self._at(orbit, middle % 1.0)[rows, k]
            crossed = value * fb < 0.0
            a, fa = np.where(crossed, b, a), np.where(crossed, fb, 0.5 * fa)
            moved, b, fb = np.abs(middle - b).max(), middle, value
            if moved < 0.01 * ALIGNED:
                break
        return np.asarray(b % 1.0)

    def _strong(self, orbit: Orbit, places: Vector) -> Vector:
        """Return those at which derivatives jump.

        A change that shrinks with the distance is none: that of max(p, 0)³ is smooth.
        """
        if not places.size:
            return np.zeros(0)
        scales = orbit.scales()
        offsets = np.array([-_FURTHER, -1.0, 1.0, _FURTHER])[:, None] * _BESIDE
        states, unknowns = orbit.sample(((places + offsets) % 1.0).ravel())
        slopes = self.model.evaluate(states, unknowns, orbit.parameter).by_state
        slopes = slopes * (scales / scales[:, None])
        low, before, after, high = slopes.reshape(4, places.size, *slopes.shape[1:])
        jumps = np.abs(after - before)
        strong = jumps * orbit.period > _STRONG * np.abs(slopes).max()
        lasting = jumps > _LASTING * np.abs(high - low)
        found = (strong & lasting).any(axis=(1, 2))
        return np.asarray(places[found | self._bending(orbit, places)])

    def _bending(self, orbit: Orbit, places: Vector) -> NDArray[np.bool_]:
        """Return at which places the rate of a channel jumps."""
        if not self._shown.count:
            return np.zeros(places.size, dtype=bool)
        near = _BEHIND * np.array([1.0, 2.0])
        offsets = np.concatenate([-near[::-1], near])
        sides = np.concatenate([offsets, _FURTHER * offsets])
        values = self._shown.at(orbit, ((places + sides[:, None]) % 1.0).ravel())
        values = values.reshape(2, 2, 2, places.size, -1)
        rates = (values[:, :, 1] - values[:, :, 0]) / _BEHIND
        rates[1] /= _FURTHER
        jumps = np.abs(rates[:, 1] - rates[:, 0])
        strong = jumps[0] > _BENT * np.ptp(values, axis=(0, 1, 2, 3))
        return np.asarray((strong & (jumps[0] > _LASTING * jumps[1])).any(axis=-1))

    def _at(self, orbit: Orbit, places: Vector) -> Vector:
        return self._deciding.at(orbit, places)


class _Column:
    """A column of functions of states, unknowns and parameters, at places of orbits."""

    def __init__(self, model: AutonomousField, column: Any) -> None:
        import casadi

        e = model.equations
        state = [casadi.SX(s.start) for s in e.states]
        for k in model.kept:
            state[k] = e.state[k]
        fixed = [casadi.SX(0.0), casadi.vertcat(*state)]
        (column,) = casadi.substitute([column], [e.time, e.state], fixed)
        inputs = [e.state[model.kept], e.algebraic, e.parameter]
        column = casadi.densify(column)
        self.count = int(column.numel())
        self._model = model
        self.compiled = model.compiled(column) if self.count else None
        self._function = casadi.Function("column", inputs, [column])
        self._values: dict[int, BufferedFunction] = {}

    def at(self, orbit: Orbit, places: Vector) -> Vector:
        """Return the values at places (n_places, n_functions)."""
        count = len(places)
        states, unknowns = orbit.sample(places)
        values = self._model.parameters(orbit.parameter)
        if self.compiled is not None:
            return self.compiled.values(np.concatenate([states, unknowns], axis=1), values)
        if count not in self._values:
            mapped = self._function.map("column", "serial", count, [2], [])
            self._values[count] = BufferedFunction(mapped)
        (found,) = self._values[count](states.ravel(), unknowns.ravel(), values)
        return found.T if found.ndim == 2 else found.reshape(count, self.count)


def aligned(mesh: Vector, kinks: Vector) -> Vector:
    """Return a mesh with a point on each kink: the nearest is moved, or one is added."""
    points, taken = list(mesh), set[float]()
    for kink in kinks:
        if min(kink, 1.0 - kink) < ALIGNED:
            continue
        free = [p for p in points[1:-1] if p not in taken]
        near = min(free, key=lambda p: abs(p - kink), default=2.0)
        above = min((p for p in points if p > kink), default=1.0)
        below = max((p for p in points if p <= kink), default=0.0)
        if abs(near - kink) <= 0.6 * (above - below):
            points.remove(near)
        if kink not in points:
            points.append(float(kink))
        points.sort()
        taken.add(float(kink))
    return np.array(points)


def misalignment(mesh: Vector, kinks: Vector) -> float:
    """Return the largest distance of a kink from the mesh points, part of the period."""
    if not kinks.size:
        return 0.0
    return float(np.abs(kinks[:, None] - mesh[None, :]).min(axis=1).max())


def deciders(whole: Any) -> list[Any]:
    """Return the arguments of the operations in an expression that are not smooth."""
    import casadi

    pairs = {getattr(casadi, name) for name in _PAIRS}
    singles = {getattr(casadi, name) for name in _SINGLES}
    stack = [whole[k] for k in range(whole.numel())]
    seen: set[int] = set()
    found: list[Any] = []
    while stack:
        item = stack.pop()
        if item.element_hash() in seen:
            continue
        seen.add(item.element_hash())
        if item.is_constant() or item.is_symbolic():
            continue
        operands = [item.dep(k) for k in range(item.n_dep())]
        if item.op() in pairs:
            found.append(operands[0] - operands[1])
        elif item.op() in singles:
            found.append(operands[0])
        stack += operands
    return found
