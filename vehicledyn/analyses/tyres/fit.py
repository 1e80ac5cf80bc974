"""Fit of Magic Formula coefficients to measured forces, with residuals and confidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.tyres.fitted_file import write_fitted
from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError, NumericalError, unknown_name
from vehicledyn.base.files.column_files import ColumnKind, read_columns
from vehicledyn.road.tyre_files.names import coefficients
from vehicledyn.road.tyre_files.tyre_file import TURNED
from vehicledyn.road.tyres.file_tyre import FileTyre
from vehicledyn.road.tyres.tyre import TyreInput
from vehicledyn.road.tyres.tyre_of_file import TyreOfFile
from vehicledyn.symbolic import ops

Array = NDArray[np.float64]

CONFIDENCE = 0.95
"""Probability of the intervals of coefficients, if errors are independent and normal [1]."""

_INPUTS = {
    "load": ColumnKind("N", required=True),
    "longitudinal_slip": ColumnKind("1"),
    "slip_angle": ColumnKind("rad"),
    "camber": ColumnKind("rad"),
}
_FORCES = {
    "longitudinal_force": ColumnKind("N"),
    "lateral_force": ColumnKind("N"),
    "aligning_moment": ColumnKind("N*m"),
}
_USUAL = {
    "longitudinal_force": ("PCX1", "PDX1", "PDX2", "PEX1", "PKX1", "PKX2", "PHX1", "PVX1"),
    "lateral_force": ("PCY1", "PDY1", "PDY2", "PEY1", "PKY1", "PKY2", "PHY1", "PVY1"),
    "aligning_moment": ("QBZ1", "QCZ1", "QDZ1", "QDZ2", "QEZ1", "QHZ1", "QDZ6"),
}
"""Coefficients that are fitted to a force where none are named."""

_DEPENDENT = 1e-10
_MOST_TRIALS = 300
"""Ratio of singular values below which coefficients cannot be told apart by the data [1]."""


@dataclass(frozen=True)
class FittedCoefficient:
    """A fitted value, where it came from, and half the width of its confidence interval."""

    name: str
    start: float
    value: float
    half_width: float


@dataclass(frozen=True)
class TyreFit:
    """Fitted coefficients, and root mean squares of the residuals before and after by force."""

    file: str
    data: str
    rows: int
    fitted: tuple[FittedCoefficient, ...]
    residuals: dict[str, tuple[float, float, float]]
    output: Path | None = None
    plots: Path | None = None

    def as_text(self) -> str:
        """Return coefficients and residuals as lines."""
        lines = [f"{self.file} fitted to {self.data}: {self.rows} rows"]
        lines.append(f"{'coefficient':<14}{'start':>14}{'fitted':>14}{'95 % ±':>12}")
        lines += [
            f"{c.name:<14}{c.start:>14.6g}{c.value:>14.6g}{c.half_width:>12.3g}"
            for c in self.fitted
        ]
        for name, (before, after, largest) in self.residuals.items():
            unit = _FORCES[name].unit
            lines.append(
                f"{name}: rms residual {after:.4g} {unit} (before {before:.4g}), "
                f"largest {largest:.4g} {unit}"
            )
        lines += [f"written to {place}" for place in (self.output, self.plots) if place]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data."""
        return {
            "file": self.file,
            "data": self.data,
            "rows": self.rows,
            "coefficients": [vars(c) for c in self.fitted],
            "residuals": {
                n: {"rms_before": b, "rms": a, "largest": m}
                for n, (b, a, m) in self.residuals.items()
            },
        }


def fit_tyre(
    path: Path,
    data: Path,
    *,
    names: Sequence[str] = (),
    convention: str | None = None,
    output: Path | None = None,
    plots: Path | None = None,
) -> TyreFit:
    """Return the coefficients of a tyre property file that fit measured forces best.

    Least squares of each force over its largest measured value, from the values of the file,
    with exact derivatives. The intervals come from the residuals and the derivatives there.

    Parameters
    ----------
    path
        Tyre property file with start values.
    data
        Table with ``load [N]``, slips and camber (zero if left out) and forces.
    names
        Coefficients to fit; the usual ones of the measured forces if there are none.
    convention, output, plots
        Rules of the law; fitted tyre property file to write and folder of the figures.

    Raises
    ------
    InputError
        If a file cannot be read, or a coefficient is unknown or without effect on the data.
    NumericalError
        If the fit does not converge.
    """
    tyre = TyreOfFile(file=str(path), convention=convention, mirror="never")
    given, measured = _read(data)
    chosen = _chosen(names, list(measured))
    problem = _Problem(tyre, chosen, given, measured)
    start = np.array([tyre.content.values[name] for name in chosen])
    value, half = problem.solve(start, f"{data}")
    residuals = {}
    for k, name in enumerate(measured):
        before, after = (problem.differences(v)[k] for v in (start, value))
        residuals[name] = (_rms(before), _rms(after), float(np.abs(after).max()))
    fitted = tuple(
        FittedCoefficient(n, float(s), float(v), float(h))
        for n, s, v, h in zip(chosen, start, value, half, strict=True)
    )
    if output is not None:
        kept = {n: tyre.content.values[n] for n in TURNED if tyre.content.turned}
        write_fitted(tyre.path, kept | {c.name: c.value for c in fitted}, output)
    if plots is not None:
        from vehicledyn.results.plots.picture_files import save_figures
        from vehicledyn.results.plots.tyres.tyre_fit_figures import fit_figures

        columns = dict(zip(_INPUTS, given.T, strict=True))
        curves = problem.forces(value)
        save_figures(fit_figures(columns, measured, curves), plots, ("png", "svg"))
    return TyreFit(str(path), str(data), len(given), fitted, residuals, output, plots)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values * values)))


def _read(data: Path) -> tuple[Array, dict[str, Array]]:
    """Return inputs, shape (n, 4), and the measured forces by name."""
    columns = read_columns(data, {**_INPUTS, **_FORCES})
    numbers = {name: np.array(values) for name, values in columns.numbers.items()}
    count = len(numbers["load"])
    zero = np.zeros(count)
    given = np.stack([numbers.get(name, zero) for name in _INPUTS], axis=1)
    measured = {name: numbers[name] for name in _FORCES if name in numbers}
    if not measured:
        raise InputError(f"{data}: no forces: give one of {', '.join(_FORCES)} as a column")
    for name, values in {**dict(zip(_INPUTS, given.T, strict=True)), **measured}.items():
        wrong = np.flatnonzero(~np.isfinite(values))
        if wrong.size:
            line = columns.lines[int(wrong[0])]
            raise InputError(f"{data}:{line}: {name}: expected a number in every line")
    return given, measured


def _chosen(names: Sequence[str], measured: list[str]) -> list[str]:
    able = [n for n, c in coefficients().items() if c.section.endswith("_COEFFICIENTS")]
    able = [n for n in able if not coefficients()[n].section.startswith("SCALING")]
    for name in names:
        if name not in able:
            raise InputError(
                f"{argument('coefficients')}: {unknown_name('coefficient', name, able)}"
            )
    return list(dict.fromkeys(names)) or [n for force in measured for n in _USUAL[force]]


class _Problem:
    """Residuals of the forces and their derivatives by the coefficients."""

    def __init__(
        self, tyre: FileTyre, names: list[str], given: Array, measured: dict[str, Array]
    ) -> None:
        self.names, self._measured = names, measured
        self._rows = [column[None] for column in given.T]
        self._scales = {n: max(float(np.abs(v).max()), 1e-9) for n, v in measured.items()}
        inputs = [ops.symbol(name) for name in _INPUTS]
        symbols = ops.column([ops.symbol(name) for name in names])
        changes = {name: symbols[k] for k, name in enumerate(names)}
        p = tyre.coefficients().changed(**changes)
        found = tyre.steady_forces(p, TyreInput(*inputs))
        column = ops.column([getattr(found, name) for name in measured])
        self._value = ops.numeric([*inputs, symbols], column)
        self._slope = ops.numeric([*inputs, symbols], ops.jacobian(column, symbols))

    def forces(self, values: Array) -> dict[str, Array]:
        """Return the forces of the law at the measured points."""
        found = self._value(*self._rows, values)
        return dict(zip(self._measured, found, strict=True))

    def differences(self, values: Array) -> list[Array]:
        """Return law less measurement, by force."""
        return [force - self._measured[name] for name, force in self.forces(values).items()]

    def residuals(self, values: Array) -> Array:
        """Return all differences over the largest measured value of each force."""
        parts = zip(self.differences(values), self._scales.values(), strict=True)
        return np.concatenate([part / scale for part, scale in parts])

    def jacobian(self, values: Array) -> Array:
        """Return the derivatives of :meth:`residuals`."""
        slopes = self._slope(*self._rows, values)
        parts = zip(slopes, self._scales.values(), strict=True)
        return np.concatenate([part.reshape(-1, len(values)) / scale for part, scale in parts])

    def solve(self, start: Array, source: str) -> tuple[Array, Array]:
        """Return the best values and half the widths of their confidence intervals."""
        from scipy.optimize import least_squares
        from scipy.stats import t

        slopes = self.jacobian(start)
        idle = [n for n, c in zip(self.names, slopes.T, strict=True) if not np.any(c)]
        if idle:
            raise InputError(f"{source}: {', '.join(idle)}: without effect on these data")
        freedom = len(slopes) - len(start)
        if freedom < 1:
            raise InputError(
                f"{source}: {len(slopes)} values for {len(start)} coefficients: give more lines "
                "or fewer coefficients"
            )
        if not (np.isfinite(slopes).all() and np.isfinite(self.residuals(start)).all()):
            raise InputError(
                f"{source}: the start values give no finite forces at these loads and slips"
            )
        try:
            found = least_squares(
                self.residuals, start, self.jacobian, x_scale="jac", max_nfev=_MOST_TRIALS,
                xtol=1e-14, ftol=1e-14, gtol=1e-14,
            )  # fmt: skip
        except (ValueError, np.linalg.LinAlgError) as error:
            raise NumericalError(f"{source}: the fit gives no finite number: {error}") from None
        if not (found.success and np.isfinite(found.jac).all()):
            raise NumericalError(f"{source}: the fit does not converge: {found.message}")
        size = np.linalg.norm(found.jac, axis=0)
        scaled = found.jac / np.where(size > 0.0, size, 1.0)
        _, singular, basis = np.linalg.svd(scaled, full_matrices=False)
        if singular[-1] < _DEPENDENT * singular[0]:
            worst = [self.names[k] for k in np.argsort(-np.abs(basis[-1]))[:2]]
            raise NumericalError(f"{source}: {' and '.join(worst)} cannot be told apart; fit one")
        covariance = (basis.T / singular**2) @ basis * (2.0 * found.cost / freedom)
        deviation = np.sqrt(np.diag(covariance)) / np.where(size > 0.0, size, 1.0)
        return found.x, deviation * float(t.ppf(0.5 + 0.5 * CONFIDENCE, freedom))
