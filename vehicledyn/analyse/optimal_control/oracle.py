"""A nonlinear program as the functions that CasADi's interior-point method asks for."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.rows import OBJECTIVE, Rows

Floats = NDArray[np.float64]


class Oracle:
    """CasADi functions of the variables x, no parameters p, and multipliers.

    ``values`` (x, p) -> (f, g), ``gradient`` (x, p) -> (f, ∇f), ``jacobian`` (x, p) -> (g, ∂g/∂x),
    ``hessian`` (x, p, λf, λg) -> upper triangle. ``error`` is what an evaluation raised; from then
    on they give what is no number.

    Parameters
    ----------
    rows
        The program.
    """

    def __init__(self, rows: Rows) -> None:
        import casadi

        self.rows, self.error = rows, None  # type: tuple[Rows, BaseException | None]
        n, m = rows.scale.size, rows.count - 1
        self._at: tuple[bytes, Floats] | None = None
        self._slopes_at: tuple[bytes, Floats] | None = None
        whole = rows.slopes
        in_objective = whole.rows == OBJECTIVE
        self._of_objective, self._of_rows = (
            np.nonzero(in_objective)[0],
            np.nonzero(~in_objective)[0],
        )
        columns = np.repeat(np.arange(n), np.diff(whole.starts))
        self._gradient_columns = columns[self._of_objective]
        starts = np.searchsorted(columns[self._of_rows], np.arange(n + 1))
        pattern = _pattern(m, n, starts, whole.rows[self._of_rows] - 1)
        bends = _pattern(n, n, rows.bends.starts, rows.bends.rows)
        dense = casadi.Sparsity.dense
        f, g = {"f": dense(1, 1)}, {"g": dense(m, 1)}
        given = {"x": dense(n, 1), "p": dense(0, 1)}
        multipliers = {"lam_f": f["f"], "lam_g": g["g"]}
        self.values = _callback("nlp", given, f | g, self._values)
        slopes = f | {"grad_f_x": given["x"]}
        self.gradient = _callback("nlp_grad_f", given, slopes, self._gradient)
        self.jacobian = _callback("nlp_jac_g", given, g | {"jac_g_x": pattern}, self._jacobian)
        curvature = {"triu_hess_gamma_x_x": bends}
        self.hessian = _callback("nlp_hess_l", given | multipliers, curvature, self._hessian)

    def _guarded(self, evaluate: Any, size: int) -> Floats:
        """Return an evaluation; one that fails is kept, as it must not cross C++ code."""
        if self.error is None:
            try:
                return np.asarray(evaluate())
            except BaseException as error:
                self.error = error
        return np.full(size, np.nan)

    def _rows_at(self, x: Floats) -> Floats:
        key = x.tobytes()
        if self._at is None or self._at[0] != key:
            self._at = key, self._guarded(lambda: self.rows.values(x), self.rows.count)
        return self._at[1]

    def _all_slopes_at(self, x: Floats) -> Floats:
        key = x.tobytes()
        if self._slopes_at is None or self._slopes_at[0] != key:
            size = self.rows.slopes.fixed.size
            self._slopes_at = key, self._guarded(lambda: self.rows.jacobian(x), size)
        return self._slopes_at[1]

    def _values(self, x: Floats, _: Floats) -> list[Floats]:
        found = self._rows_at(x)
        return [found[:1], found[1:]]

    def _gradient(self, x: Floats, _: Floats) -> list[Floats]:
        gradient = np.zeros(x.size)
        gradient[self._gradient_columns] = self._all_slopes_at(x)[self._of_objective]
        return [self._rows_at(x)[:1], gradient]

    def _jacobian(self, x: Floats, _: Floats) -> list[Floats]:
        return [self._rows_at(x)[1:], self._all_slopes_at(x)[self._of_rows]]

    def _hessian(self, x: Floats, _: Floats, of: Floats, og: Floats) -> list[Floats]:
        multipliers, size = np.concatenate([of, og]), self.rows.bends.fixed.size
        return [self._guarded(lambda: self.rows.hessian(x, multipliers), size)]


def _pattern(n_rows: int, n_columns: int, starts: Any, rows: Any) -> Any:
    import casadi

    return casadi.Sparsity(n_rows, n_columns, starts.tolist(), rows.tolist())


def _callback(name: str, inputs: dict[str, Any], outputs: dict[str, Any], evaluate: Any) -> Any:
    """Return a CasADi function that calls one of Python with the numbers of its inputs.

    ``inputs`` and ``outputs`` are patterns by name.
    """
    import casadi

    names_in, names_out = list(inputs), list(outputs)
    patterns_in, patterns_out = list(inputs.values()), list(outputs.values())

    class Evaluation(casadi.Callback):
        """Call the function."""

        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.construct(name, {})

        def get_n_in(self) -> int:
            return len(names_in)

        def get_n_out(self) -> int:
            return len(names_out)

        def get_name_in(self, index: int) -> str:
            return names_in[index]

        def get_name_out(self, index: int) -> str:
            return names_out[index]

        def get_sparsity_in(self, index: int) -> Any:
            return patterns_in[index]

        def get_sparsity_out(self, index: int) -> Any:
            return patterns_out[index]

        def eval(self, given: Any) -> list[Any]:
            found = evaluate(*[np.array(item.nonzeros()) for item in given])
            return [casadi.DM(s, v) for s, v in zip(patterns_out, found, strict=True)]

    return Evaluation()
