"""Functions that choose between branches of the equations, watched while a motion is followed."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import NDArray

from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.tangent_code import TangentCode

Matrix = NDArray[np.float64]

NOISE = 1e-9
"""Part of a function's size that it changes by in a step, if not by rounding; as in branches.c."""


class _Branches(ctypes.Structure):
    _fields_ = [
        (name, ctypes.c_void_p)
        for name in ("p", "is_table", "skipped", "marks", "changes", "sizes", "before")
    ]


class BranchWatch:
    """What is known of the functions at the point that a motion has reached.

    ``marks`` (count,) are their branches: signs, or cells of tables from one on; 0 where it is
    either. ``changes`` says how often they have changed, ``skipped`` which may do so without ending
    the steps that are taken at once; ``sizes`` are their largest values, ``before`` the last ones.

    Parameters
    ----------
    code
        The compiled code.
    parameters
        Those of the model.
    """

    def __init__(self, code: TangentCode, parameters: Vector) -> None:
        branches = code.branches
        self.count, self.is_table, self._code = branches.count, branches.is_table, code
        self.skipped, self.marks, self.changes = np.zeros((3, self.count), dtype=np.intc)
        self.sizes, self.before = np.zeros((2, self.count))
        self._tables = np.flatnonzero(self.is_table)
        given = code.shared_parameters(parameters) if self.count else np.zeros(1)
        self._given, self._kinds = given, self.is_table.astype(np.intc)
        counts = self.skipped, self.marks, self.changes
        arrays = (given, self._kinds, *counts, self.sizes, self.before)
        self.structure = _Branches(*[item.ctypes.data for item in arrays])

    def values(self, times: Vector, states: Matrix, unknowns: Matrix) -> Matrix:
        """Return the functions at points, shape (n, count); states and unknowns (n, ...)."""
        found = np.empty((len(times), self.count))
        points = [np.ascontiguousarray(item, dtype=float) for item in (times, states, unknowns)]
        if self.count:
            self._code.call("vd_branch_values", len(times), *points, self._given, found)
        return found

    def branches(self, values: Matrix) -> Matrix:
        """Return which branch values of the functions choose, 0 where it is either."""
        marks = (values > 0.0).astype(float) - (values < 0.0)
        if self._tables.size:
            cells = np.floor(values[..., self._tables]) + 1.0
            marks[..., self._tables] = np.nan_to_num(cells)
        return marks

    def enter(self, values: Vector, *, counted: bool) -> None:
        """Go on from a point with some values; ``counted`` if a step of the motion ends there."""
        marks = self.branches(values).astype(np.intc)
        np.fmax(self.sizes, np.abs(values), out=self.sizes)
        with np.errstate(invalid="ignore"):
            moved = np.abs(values - self.before) > NOISE * self.sizes
        known = (marks != 0) & (self.marks != 0)
        if counted:
            self.changes[known & (marks != self.marks) & moved] += 1
        self.marks[marks != 0] = marks[marks != 0]
        self.before[:] = values
