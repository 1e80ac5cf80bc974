"""The derivatives of compiled rates along closed loops, from the code of the stiff methods."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.implicit import ImplicitEquations
from vehicledyn.kernel.engine import Vector

_BY_STATE, _BY_UNKNOWN, _RESIDUAL = 1, 2, 4
"""Places of derivatives among the results of jac_vd_dae: rates first, then residuals."""


class CompiledJacobian:
    """Evaluates dẋ/dx, the columns of a colour together and several colours at once.

    With 0 = g(x, z): df/dx = ∂f/∂x - ∂f/∂z (∂g/∂z)⁻¹ ∂g/∂x.
    """

    def __init__(self, equations: ImplicitEquations, library: Any, name: str) -> None:
        """Take the compiled functions of a model of this name."""
        self._name, self._constants_of = name, equations.constants
        self._call = library.jac_vd_dae
        n, m = equations.sizes
        sizes = [ctypes.c_longlong() for _ in range(4)]
        library.jac_vd_dae_work(*map(ctypes.byref, sizes))
        self._work = np.zeros(sizes[3].value + 1)
        wanted = [row + column for row in (0, _RESIDUAL) for column in (_BY_STATE, _BY_UNKNOWN)]
        shapes = [(rows, columns) for rows in (n, m) for columns in (n, m)]
        self._results = (ctypes.c_void_p * 8)()
        self._parts: list[tuple[NDArray[np.int64], NDArray[np.int64], Vector, Vector]] = []
        for place, shape in zip(wanted, shapes, strict=True):
            rows, columns = _pattern(library, place)
            values = np.zeros(len(rows) + 1)
            self._parts.append((rows, columns, values, np.zeros(shape)))
            self._results[place] = values.ctypes.data
        self._arguments = (ctypes.c_void_p * 6)()
        self._parameters, self._constants = np.zeros(0), np.zeros(0)

    def rates_by_states(
        self, time: float, state: Vector, unknowns: Vector, parameters: Vector
    ) -> Vector:
        """Return dẋ/dx along closed loops, shape (n_states, n_states).

        Raises
        ------
        NumericalError
            If the loops are singular at this point.
        """
        if not np.array_equal(parameters, self._parameters):
            self._parameters, self._constants = parameters, self._constants_of(parameters)
        given = [np.array([time]), np.ascontiguousarray(state), np.ascontiguousarray(unknowns)]
        for k, item in enumerate([*given, self._constants]):
            self._arguments[k] = item.ctypes.data
        self._call(self._arguments, self._results, None, ctypes.c_void_p(self._work.ctypes.data), 0)
        for rows, columns, values, dense in self._parts:
            dense[rows, columns] = values[:-1]
        by_state, by_unknown, g_x, g_z = (dense for *_, dense in self._parts)
        if not len(g_z):
            return by_state
        try:
            follow = np.linalg.solve(g_z, g_x)
        except np.linalg.LinAlgError:
            raise NumericalError(
                f"the loops of model '{self._name}' are singular at t = {time:.9g} s; no "
                "derivative along their motions exists there"
            ) from None
        total: Vector = by_state - by_unknown @ follow
        return total


def _pattern(library: Any, place: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return rows and columns of the elements of a result, from its compressed columns."""
    find = library.jac_vd_dae_sparsity_out
    find.restype, find.argtypes = ctypes.POINTER(ctypes.c_longlong), [ctypes.c_longlong]
    found = find(place)
    n_columns = found[1]
    starts = np.array(found[2 : n_columns + 3], dtype=np.int64)
    rows = np.array(found[n_columns + 3 : n_columns + 3 + int(starts[-1])], dtype=np.int64)
    return rows, np.repeat(np.arange(n_columns), np.diff(starts))
