"""How a periodic orbit and its channels follow all parameters: exact derivatives of collocation.

The equations of an orbit, F(Y, T, λ; p) = 0 with states Y, period T and free parameter λ, hold for
all p, so that

    F_Y dY/dp + F_T dT/dp + F_λ dλ/dp = -F_p

With λ held this gives the cycle at one value. On the plane across the branch at a fold it gives
dλ/dp of the fold, since there λ does not change along the branch.

References
----------
Doedel, Keller, Kernévez (1991), Numerical analysis and control of bifurcation problems,
Int. J. Bifurcation and Chaos 1(4), for the equations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.collocation import Intervals, last_row
from vehicledyn.analyse.periodic.fine_orbits import FineOrbit
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.kernel.engine import Vector
from vehicledyn.symbolic import ops

_ITERATIONS, _SETTLED = 12, 1e-13

_LOOKS, _PART = 16, 0.37
"""Points of a cycle at which channels are looked at for what goes on, and parts of the period for
which it goes on there."""
_MOST = 1e-7
"""Change of a channel then, part of its size, that rounding makes."""


@dataclass(frozen=True)
class OrbitSlopes:
    """Derivatives of an orbit by n parameters.

    ``states`` (n_points, n_kept, n) at its representation points, ``period`` and ``parameter``
    (n,).
    """

    states: Vector
    period: Vector
    parameter: Vector


@dataclass(frozen=True)
class ChannelValues:
    """Channels at some points (n_points, n_channels), and their derivatives.

    ``by_state`` (n_points, n_channels, n_kept) and ``by_parameter`` (n_points, n_channels, n) are
    total ones: the ``unknowns`` (n_points, n_unknowns) follow.
    """

    unknowns: Vector
    values: Vector
    by_state: Vector
    by_parameter: Vector


class ParameterSlopes:
    """Derivatives of rates and channels of a field by some of its parameters.

    Parameters
    ----------
    field
        The equations.
    which
        Indices of the parameters.
    channels
        Indices of the channels.
    held
        Derivatives (n_states, n_parameters) of the start, at which states set apart stay.
    """

    def __init__(
        self,
        field: AutonomousField,
        which: Sequence[int],
        channels: Sequence[int] = (),
        held: Vector | None = None,
    ) -> None:
        import casadi

        self.field, self.which, self.asked = field, list(which), tuple(channels)
        e = field.equations
        state, chosen = e.state[field.kept], e.parameter[self.which]
        given = [state, e.algebraic, e.parameter]
        whole = [
            ops.jacobian(field.whole, e.algebraic),
            ops.jacobian(field.whole, chosen),
        ]
        self._rates = casadi.Function("rates", given, _dense(whole))
        apart = [k for k in range(len(e.states)) if k not in field.kept]
        none = np.zeros((len(e.states), len(field.values)))
        self._held = (none if held is None else held)[np.ix_(apart, self.which)]
        fixed: Any = [casadi.SX(0.0), casadi.SX(field.full(np.zeros(field.size))[apart])]
        taken = self._taken = e.output[list(channels)]
        by_all = (state, e.algebraic, chosen, e.state[apart])
        shown = [taken, *(ops.jacobian(taken, by) for by in by_all)]
        shown = casadi.substitute(shown, [e.time, e.state[apart]], fixed)
        self._channels = casadi.Function("channels", given, _dense(shown))

    def going_on(self, orbit: Orbit) -> list[int]:
        """Return the channels, by their number among those asked for, that an orbit does not close.

        They follow time, or states set apart that move.
        """
        import casadi

        field, e = self.field, self.field.equations
        apart = [k for k in range(len(e.states)) if k not in field.kept]
        if not casadi.depends_on(self._taken, casadi.vertcat(e.time, e.state[apart])):
            return []
        given = [e.time, e.state, e.algebraic, e.parameter]
        seen = casadi.Function("seen", given, [self._taken, e.rate])
        states, unknowns = orbit.sample(np.arange(_LOOKS) / _LOOKS)
        unknowns = unknowns - field.evaluate(states, unknowns, orbit.parameter).gap
        parameters, duration = field.parameters(orbit.parameter), _PART * orbit.period
        ends = []
        for state, own in zip(field.full(states), unknowns, strict=True):
            begin, rates = seen(0.0, state, own, parameters)
            moved = state.copy()
            moved[apart] += duration * rates.full()[apart, 0]
            ends.append((begin.full(), seen(duration, moved, own, parameters)[0].full()))
        values = np.array(ends)[..., 0]
        size = np.abs(values).max(axis=(0, 1))
        change = np.abs(values[:, 1] - values[:, 0]).max(axis=0)
        return [int(k) for k in np.flatnonzero(change > _MOST * size)]

    def rates(self, states: Vector, unknowns: Vector, value: float) -> tuple[Vector, Vector]:
        """Return derivatives of rates (n_points, n_kept, n) and unknowns (n_points, n_unknowns, n).

        At points (n_points, n_kept) whose ``unknowns`` (n_points, n_unknowns) solve their
        equations; ``value`` is that of the free parameter.
        """
        kept = self.field.size
        by_unknown, direct = self._at(self._rates, states, unknowns, value)
        follow = np.asarray(np.linalg.solve(by_unknown[:, kept:], direct[:, kept:]), dtype=float)
        return direct[:, :kept] - by_unknown[:, :kept] @ follow, -follow

    def channels(self, states: Vector, unknowns: Vector, value: float) -> ChannelValues:
        """Return channels and their derivatives at points, the unknowns a guess."""
        found = self.field.evaluate(states, unknowns, value)
        for _ in range(_ITERATIONS):
            if np.abs(found.gap).max(initial=0.0) <= _SETTLED * np.abs(unknowns).max(initial=0.0):
                break
            unknowns = unknowns - found.gap
            found = self.field.evaluate(states, unknowns, value)
        _, by = self.rates(states, unknowns, value)
        shown, by_state, by_unknown, direct, by_apart = self._at(
            self._channels, states, unknowns, value
        )
        return ChannelValues(
            unknowns,
            shown[:, :, 0],
            by_state - by_unknown @ found.follow,
            direct + by_unknown @ by + by_apart @ self._held,
        )

    def _at(self, function: Any, states: Vector, unknowns: Vector, value: float) -> list[Vector]:
        """Return what a function gives at each point, stacked."""
        parameters = self.field.parameters(value)
        rows = [
            [part.full() for part in function.call([x, z, parameters])]
            for x, z in zip(states, unknowns, strict=True)
        ]
        return [np.array(part) for part in zip(*rows, strict=True)]


def orbit_slopes(slopes: ParameterSlopes, fine: FineOrbit) -> OrbitSlopes:
    """Return the derivatives of an orbit by parameters.

    Where the orbit has a direction it stays on the plane across it; else the free parameter stays.

    Raises
    ------
    NumericalError
        If the orbit is not isolated.
    """
    found, scales = fine.found, fine.scales
    system, orbit, field = found.system, found.orbit, slopes.field
    n, count, m, s = field.size, orbit.intervals, orbit.basis.degree, scales.states
    intervals = Intervals.of(field, orbit, scales)
    places = orbit.at_gauss().reshape(count * m, n)
    by, _ = slopes.rates(places, orbit.unknowns, orbit.parameter)
    step = np.repeat(orbit.widths * orbit.period, m)[:, None, None]
    own = intervals.solve(-(step * by / s[:, None]).reshape(count, m * n, -1))
    last = last_row(orbit, fine.along, scales)
    rows = [row[:, 1:].reshape(count, -1) for row in (system.phase, last[0])]
    right = np.concatenate(
        [
            -own[:, -n:].reshape(count * n, -1),
            *(np.einsum("jq,jqc->c", row, own)[None] for row in rows),
        ]
    )
    solution = system.factorised(last).solve(right)
    mesh, ends = solution[:-2].reshape(count, n, -1), solution[-2:]
    inner = -own - system.solved[:, :, :n] @ mesh - system.solved[:, :, n : n + 2] @ ends
    states = np.empty((count, m, n, len(slopes.which)))
    states[:, 0] = mesh
    states[:, 1:] = inner.reshape(count, m, n, -1)[:, :-1]
    return OrbitSlopes(
        states.reshape(count * m, n, -1) * s[:, None],
        ends[0] * scales.period,
        ends[1] * scales.parameter,
    )


def slopes_at(orbit: Orbit, states: Vector, places: NDArray[np.float64]) -> Vector:
    """Return derivatives of the states (n_points, n_kept, n) at places, parts of the period."""
    m = orbit.basis.degree
    j = np.clip(np.searchsorted(orbit.mesh, places, side="right") - 1, 0, orbit.intervals - 1)
    weights = orbit.basis.values_at((places - orbit.mesh[j]) / orbit.widths[j])
    pieces = states[(j[:, None] * m + np.arange(m + 1)) % len(states)]
    return np.asarray(np.einsum("qi,qisc->qsc", weights, pieces))


def _dense(parts: Sequence[Any]) -> list[Any]:
    import casadi

    return list(casadi.cse([casadi.densify(part) for part in parts]))
