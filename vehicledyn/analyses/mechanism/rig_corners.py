"""Places on the rig where a law has a corner, so that slopes differ to both sides of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.corner_functions import CornerFunctions
from vehicledyn.analyses.mechanism.rig_bench import Bench
from vehicledyn.analyses.mechanism.rig_tests import RigTest
from vehicledyn.base.errors import NumericalError
from vehicledyn.codegen.passes.branch_functions import BranchFunctions

Array = NDArray[np.float64]
Find = Callable[[RigTest, float], Array]

_BESIDE = {"N": 1e-3, "N*m": 1e-3}
"""Distance to both sides at which corners of laws are looked for, 1e-7 of other units."""

_LIFTED = 2e-7
"""Travel to both sides along with that [m], so that wheels that roll do not cross each other."""

_NEAR = 1e-4
"""Part of what it is in the design position up to which a function may vanish nearby."""

JUMP = 1e-3
"""Part of the largest above which a change between both sides is a jump; of smooth laws 1e-7."""


def apart(bench: Bench, test: RigTest, value: float, steps: int, find: Find) -> Array:
    """Return what is found a little to both sides of a place, the upper side first."""
    lifted, found = bench.lifted, []
    try:
        for away in (steps, -steps):
            bench.lift(lifted + away * _LIFTED)
            found.append(find(test, value + away * _BESIDE.get(test.unit, 1e-7)))
    finally:
        bench.lift(lifted)
    return np.array(found)


def jumps(
    bench: Bench, test: RigTest, value: float, find: Find
) -> tuple[NDArray[np.bool_], Array, Array]:
    """Return which quantities jump at a place, and what they are above and below it."""
    near, wide = (apart(bench, test, value, steps, find) for steps in (1, 10))
    change, grown = (_largest(both[0] - both[1]) for both in (near, wide))
    jump = (change > JUMP * _largest(near[0])) & (grown < 2.0 * change)
    return np.asarray(jump), np.asarray(near[0]), np.asarray(near[1])


def _largest(values: Array) -> Array:
    """Return the magnitude of each quantity, the largest of its rows if there are any."""
    return np.asarray(np.max(np.abs(np.atleast_2d(values)), axis=0))


class RigCorners:
    """Finds what jumps at places of an axle on the rig.

    Parameters
    ----------
    bench
        The axle.
    """

    def __init__(self, bench: Bench) -> None:
        names = [c.name for c in bench.equations.channels]
        pads = [names.index(bench.pad(k)) for k in range(len(bench.corners))]
        functions = CornerFunctions(BranchFunctions.of(bench.equations, pads))
        self._bench, self._functions = bench, functions
        self._designed = np.abs(self._decided()) if self._functions.count else np.zeros(0)

    def sides(self, test: RigTest, value: float, find: Find) -> Array:
        """Return quantities below and above the place asked for last, where they jump there.

        Parameters
        ----------
        test, value
            The test and the value of its control.
        find
            Returns the quantities, shape (n,).

        Returns
        -------
        Array
            Shape (2, n), not a number where they do not jump; (2, 0) where nothing does.
        """
        nothing = np.zeros((2, 0))
        if not self._functions.count:
            return nothing
        kept, here = self._bench.place, np.abs(self._decided())
        if not np.any(here <= _NEAR * np.maximum(here, self._designed)):
            return nothing
        try:
            beside = apart(self._bench, test, value, 1, self._decided_at)
            if not np.any((beside[0] * beside[1] <= 0.0) & (beside[0] != beside[1])):
                return nothing
            jump, above, below = jumps(self._bench, test, value, find)
        except NumericalError:  # the mechanism ends there
            return nothing
        finally:
            self._bench.place = kept
        found = np.where(jump, [below, above], np.nan)
        return found if jump.any() else nothing

    def _decided(self) -> Array:
        return self._functions.at(0.0, *self._bench.place, self._bench.parameters)

    def _decided_at(self, test: RigTest, value: float) -> Array:
        self._bench.at(test.controls(self._bench, value))
        return self._decided()
