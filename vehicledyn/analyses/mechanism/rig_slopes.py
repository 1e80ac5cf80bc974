"""Derivatives of what a rig shows by the parameters of the axle.

An axle at rest on the rig is an equilibrium x(p, u) of its parameters p and the rig's u; channels
y and their slopes along a direction c of the rig's parameters are

    dy = y_x dx + y_p dp,    y' = D c - C A⁻¹ B c

with A, B, C, D of the axle linearised there. The second is a row times a matrix times a column,
whose derivative :mod:`vehicledyn.analyse.gradients.linear_system` knows. Heights of the wheels
count from the design position, which follows the parameters, too: the rig's u move with p.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.eigenvalues import LinearPoint
from vehicledyn.analyse.gradients.linear_system import (
    Following,
    LinearisedSlopes,
    SystemDerivatives,
)
from vehicledyn.analyses.mechanism.rig import quantities, ways
from vehicledyn.analyses.mechanism.rig_bench import Bench
from vehicledyn.analyses.mechanism.rig_corners import JUMP, apart, jumps
from vehicledyn.analyses.mechanism.rig_tests import RigTest
from vehicledyn.base.errors import NumericalError

Array = NDArray[np.float64]

_ASIDE = 1e-40
"""Step into the complex plane, so small that its square is nothing."""

_NEGLIGIBLE = 1e-9
"""Part of the largest derivative below which a loose motion of the design position is not felt."""


class BenchSlopes:
    """Quantities of the tests of an axle with their derivatives by its parameters.

    Attributes
    ----------
    parameters
        Numbers of the axle's own parameters among those of its equations.
    """

    def __init__(self, bench: Bench) -> None:
        """Derive the functions; raises InputError if the axle has quaternions among its states."""
        self.bench = bench
        e = bench.equations
        heads = tuple(f"{c.name}." for c in bench.corners)
        own = {*bench.lengths, f"{bench.steering}_force"}
        self._needed = [
            k
            for k, c in enumerate(e.channels)
            if c.name in own or c.name.startswith((*heads, "rig."))
        ]
        names = [p.name for p in e.parameters]
        self._controls = [names.index(name) for name in bench.controls]
        self._derivatives = SystemDerivatives(e, self._controls, self._needed)
        self.parameters = [k for k in range(len(names)) if k not in self._controls]
        known = [p.name for p in bench.design.parameters]
        self._places = [known.index(names[k]) for k in self.parameters]

    def at(self, test: RigTest, value: float) -> Array:
        """Return all quantities of a test at a value of its control, with their derivatives.

        Returns
        -------
        Array
            Quantities, then a row for each of the axle's parameters, (1 + n_parameters, n).
            Derivatives are not a number where a law has a corner that they jump at.

        Raises
        ------
        NumericalError
            If nothing balances there, or what is wanted has no derivatives.
        """
        found = self._smooth(test, value)
        kept = self.bench.place
        try:
            if self._is_corner(test, value):
                jump = jumps(self.bench, test, value, lambda *at: self._smooth(*at)[1:])[0]
                found[1:, jump] = np.nan
        except NumericalError:
            pass  # the mechanism ends there
        finally:
            self.bench.place = kept
        return found

    def _is_corner(self, test: RigTest, value: float) -> bool:
        """Whether slopes of forces or moments along the rig's ways jump at a place."""
        right, left = apart(self.bench, test, value, 1, self._ways)
        units = np.array([c.unit for c in self.bench.channels.values()])
        return any(
            np.max(np.abs(right - left)[:, units == unit])
            > JUMP * np.max(np.abs(right)[:, units == unit])
            for unit in {"N", "N*m"} & set(units)
        )

    def _ways(self, test: RigTest, value: float) -> Array:
        """Return slopes of all channels along the rig's ways, (n_ways, n_channels)."""
        bench = self.bench
        bench.at(test.controls(bench, value))
        return np.array([list(way.values()) for way in bench.slopes(*ways(bench, test))])

    def _smooth(self, test: RigTest, value: float) -> Array:
        """Return quantities and derivatives as of laws without corners."""
        bench, n = self.bench, len(self.bench.equations.states)
        seen = bench.at(test.controls(bench, value))
        directions = ways(bench, test)
        slopes = bench.slopes(*directions)
        names = [bench.equations.channels[k].name for k in self._needed]
        point = LinearPoint(bench.parameters, 0.0, *bench.place, bench.pairs)
        still = Following((), np.zeros((n, len(point.parameters))))
        linear = self._derivatives.at(point, still)
        bent = [self._control_slopes(test, value), self._turning(test)]
        by_parameter = np.zeros((len(point.parameters), len(self.parameters)))
        by_parameter[self.parameters] = np.eye(len(self.parameters))
        by_parameter[self._controls] = bent[0]
        moved = [linear.outputs @ by_parameter]
        for k, way in enumerate(directions):
            matrix, by_all = self._along(linear, way)
            moved.append(by_all @ by_parameter + (matrix @ bent[1] if k == 0 else 0.0))
        rows = [np.array(quantities(bench, test, seen, slopes)).real]
        rows += [
            np.array(quantities(bench, test, *self._aside(names, seen, slopes, columns))).imag
            / _ASIDE
            for columns in np.transpose(moved, (2, 0, 1))
        ]
        return np.array(rows)

    def _aside(
        self,
        names: list[str],
        seen: Mapping[str, float],
        slopes: list[dict[str, float]],
        columns: Array,
    ) -> tuple[dict[str, complex], list[dict[str, complex]]]:
        """Return channels and slopes with a step into the complex plane along a parameter."""
        found = [
            {name: complex(given[name], _ASIDE * d) for name, d in zip(names, column, strict=True)}
            for given, column in zip((seen, *slopes), columns, strict=True)
        ]
        return found[0], found[1:]

    def _along(self, linear: LinearisedSlopes, way: Mapping[str, float]) -> tuple[Array, Array]:
        """Return slopes of channels by all controls, and derivatives of those along a way.

        Shapes (n_needed, n_controls) and (n_needed, n_parameters of the equations).
        """
        bench, matrix, n = self.bench, linear.matrix, linear.n_states
        free, balanced = bench.pairs
        along = np.array([way.get(name, 0.0) for name in bench.controls])
        inverse = np.linalg.pinv(matrix[np.ix_(balanced, free)], rcond=1e-12)
        followed = -matrix[n:, free] @ inverse
        right = np.zeros(matrix.shape[1])
        right[n:] = along
        right[free] = -inverse @ matrix[balanced, n:] @ along
        found = []
        for k, row in enumerate(followed):
            left = np.zeros(len(matrix), dtype=complex)
            left[balanced], left[n + k] = row, 1.0
            found.append(linear.slope(left, right.astype(complex)).real)
        return matrix[n:, n:] + followed @ matrix[balanced, n:], np.array(found)

    def _control_slopes(self, test: RigTest, value: float) -> Array:
        """Return how the rig's parameters move with the axle's, (n_controls, n_parameters)."""
        bench, found = self.bench, value * self._turning(test)
        heights, _, starts = self._design
        moved = {f"rig.travel_{k}": row for k, row in enumerate(heights)} | starts
        for name, row in moved.items():
            found[bench.controls.index(name)] += row
        return found

    def _turning(self, test: RigTest) -> Array:
        """Return how the direction of a test's control moves with the axle's parameters."""
        bench = self.bench
        found = np.zeros((len(bench.controls), len(self.parameters)))
        if test.control == "roll":
            for k, row in enumerate(self._design[1]):
                found[bench.controls.index(f"rig.travel_{k}")] = row
        return found

    @cached_property
    def _design(self) -> tuple[Array, Array, dict[str, Array]]:
        """Derivatives of contact points' heights and y, and of what stands still, as designed.

        The last are by the parameters of the rig that they are added to.

        Raises
        ------
        NumericalError
            If loops that leave freedom were open as they are written.
        """
        design, bench = self.bench.design, self.bench
        q, started = design.start, design.start_by_parameter
        roles = [c.role for c in design.coordinates]
        free = [k for k, role in enumerate(roles) if role in ("auto", "dependent")]
        coordinates = [c.name for c in design.coordinates]
        names = [c.name for c in design.channels]
        gaps = design.jacobian(q)
        opened = design.residual_by_parameter(q) + gaps @ started
        moved = started.copy()
        moved[free] -= np.linalg.pinv(gaps[:, free], rcond=1e-10) @ opened
        rows = [
            names.index(f"{corner.name}.contact_{axis}")
            for axis in "zy"
            for corner in bench.corners
        ]
        slopes = design.slopes(q)[rows]
        self._refuse_loose(gaps[:, free], slopes[:, free])
        found = (design.values_by_parameter(q)[rows] + slopes @ moved)[:, self._places]
        heights, tracks = np.split(found, 2)
        still = {name: f"rig.held.{name}" for name in bench.held}
        if bench.steering:
            still[bench.steering] = "rig.steering"
        starts = {
            control: started[coordinates.index(name), self._places]
            for name, control in still.items()
        }
        return heights, tracks, starts

    def _refuse_loose(self, gaps: Array, slopes: Array) -> None:
        """Refuse a design position that depends on how open loops were drawn together."""
        design = self.bench.design
        if np.allclose(design.written, design.start, rtol=0.0, atol=1e-9) or not gaps.size:
            return
        _, sizes, directions = np.linalg.svd(gaps)
        rank = int(np.sum(sizes > 1e-10 * np.max(sizes, initial=0.0)))
        effects = np.abs(slopes @ directions[rank:].T)
        if np.any(effects > _NEGLIGIBLE * np.max(np.abs(slopes), initial=1e-300)):
            raise NumericalError(
                "the design position has no derivative: its loops are open as they are written and "
                "leave freedom; write start values that close them"
            )
