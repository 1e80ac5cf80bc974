"""Curves of a tyre: pure and combined slip at some loads, computed by its law."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.results.tables.tyre_table import COLUMNS, TyreTable, write_tyre
from vehicledyn.road.tyre_files.tyre_file import ValidRange
from vehicledyn.road.tyres.asked_modes import asked
from vehicledyn.road.tyres.file_tyre import FileTyre
from vehicledyn.road.tyres.tyre import Tyre, TyreInput
from vehicledyn.road.tyres.tyre_of_file import TyreOfFile
from vehicledyn.symbolic import ops

Array = NDArray[np.float64]

LOAD_SHARES = (0.5, 1.0, 1.5)
"""Loads over the nominal load, where none are given [1]."""

_SLIPS = 0.4 * np.sinh(np.linspace(-4.0, 4.0, 121)) / np.sinh(4.0)
_ANGLES = np.radians(np.linspace(-15.0, 15.0, 121))
_CAMBERS = np.radians(np.linspace(-6.0, 6.0, 49))
_COMBINED_ANGLES = np.radians([-8.0, -4.0, -2.0, 0.0, 2.0, 4.0, 8.0])


@dataclass(frozen=True)
class TyreReport:
    """What a tyre file says and its key figures, and where table and figures were written."""

    tables: list[TyreTable]
    facts: list[dict[str, Any]]
    output: Path | None = None
    plots: Path | None = None

    def as_text(self) -> str:
        """Return facts and key figures of each tyre."""
        lines = []
        for fact in self.facts:
            lines.append(f"{fact['file']}: version {fact['version']}, side {fact['side']}")
            for name, (low, high, unit) in fact["ranges"].items():
                lines.append(f"  range of {name}: {low:g} to {high:g} {unit}")
            lines += [f"  {text}" for text in fact["asked"]]
            heads = [f"{text} [{unit}]" for text, unit in _HEADS.values()]
            lines.append("  " + "".join(f"{head:>20}" for head in heads))
            for row in fact["loads"]:
                cells = ("-" if row[n] is None else f"{row[n]:.5g}" for n in _HEADS)
                lines.append("  " + "".join(f"{cell:>20}" for cell in cells))
            lines += [f"  outside its range: {text}" for text in fact["outside"]]
        lines += [f"written to {place}" for place in (self.output, self.plots) if place]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data."""
        sweeps = [
            {s: {n: v.tolist() for n, v in c.items()} for s, c in t.sweeps.items()}
            for t in self.tables
        ]
        return {"tyres": self.facts, "sweeps": sweeps}


_HEADS = {
    "load": ("load", "N"),
    "longitudinal_stiffness": ("C_kappa", "N"),
    "cornering_stiffness": ("C_alpha", "N/rad"),
    "longitudinal_peak": ("peak F_x", "N"),
    "lateral_peak": ("peak F_y", "N"),
    "relaxation_kappa": ("sigma_kappa", "m"),
    "relaxation_alpha": ("sigma_alpha", "m"),
}


def view_tyre(
    path: Path,
    *,
    other: Path | None = None,
    loads: Sequence[float] = (),
    convention: str | None = None,
    output: Path | None = None,
    plots: Path | None = None,
) -> TyreReport:
    """Return the curves of a tyre property file, and those of a second one beside.

    Parameters
    ----------
    path, other
        Tyre property files.
    loads
        Loads [N]; half, once and 1.5 times the nominal load if there are none.
    convention
        Rules where public programs disagree; the usual ones if None.
    output, plots
        Table to write, CSV or HDF5 by its ending, and folder of the figures; None for none.

    Raises
    ------
    InputError
        If a file cannot be read or written.
    """
    tyres = [
        TyreOfFile(file=str(place), convention=convention, mirror="never")
        for place in (path, other)
        if place is not None
    ]
    nominal = tyres[0].content.values["FNOMIN"]
    used = sorted(loads) or [share * nominal for share in LOAD_SHARES]
    tables = [tyre_table(tyre, tyre.path.name, used) for tyre in tyres]
    facts = [_facts(tyre, table) for tyre, table in zip(tyres, tables, strict=True)]
    if output is not None:
        write_tyre(tables, output)
    if plots is not None:
        from vehicledyn.results.plots.picture_files import save_figures
        from vehicledyn.results.plots.tyres.tyre_figures import tyre_figures

        save_figures(tyre_figures(tables), plots, ("png", "svg"))
    return TyreReport(tables, facts, output, plots)


def tyre_table(tyre: Tyre, title: str, loads: Sequence[float], speed: float = 16.7) -> TyreTable:
    """Return the curves of any tyre law at some loads [N] and a speed [m/s]."""
    evaluate = force_function(tyre, speed)
    zero = np.zeros(1)
    grids = {
        "longitudinal": (_SLIPS, zero, zero),
        "lateral": (zero, _ANGLES, zero),
        "cambered": (zero, zero, _CAMBERS),
        "combined": (_SLIPS, _COMBINED_ANGLES, zero),
    }
    sweeps = {}
    for name, (slips, angles, cambers) in grids.items():
        axes = np.meshgrid(np.array(loads), angles, slips, cambers, indexing="ij")
        load, angle, slip, camber = (axis.ravel() for axis in axes)
        inputs = np.stack([load, slip, angle, camber], axis=1)
        values = np.hstack([inputs, evaluate(inputs)])
        sweeps[name] = dict(zip(COLUMNS, values.T, strict=True))
    return TyreTable(title, sweeps)


def force_function(tyre: Tyre, speed: float) -> Callable[[Array], Array]:
    """Return the forces as a function of load, slip, slip angle and camber, shape (n, 4)."""
    symbols = [ops.symbol(name) for name in ("load", "slip", "angle", "camber")]
    load, slip, angle, camber = symbols
    found = tyre.forces(TyreInput(load, slip, angle, camber, speed))
    column = ops.column([getattr(found, name) for name in list(COLUMNS)[4:]])
    function = ops.numeric(symbols, column)
    return lambda inputs: function(*inputs.T[:, None]).T


def _facts(tyre: FileTyre, table: TyreTable) -> dict[str, Any]:
    content = tyre.content
    return {
        "file": str(tyre.path),
        "version": content.version,
        "side": content.side,
        "given": len(content.given),
        "unknown": list(content.unknown),
        "asked": list(asked(tyre)),
        "outside": _outside(content.ranges, table),
        "ranges": {n: (r.lowest, r.highest, r.unit) for n, r in content.ranges.items()},
        "loads": [_key_figures(tyre, table, load) for load in table.loads],
    }


def _outside(ranges: Mapping[str, ValidRange], table: TyreTable) -> list[str]:
    """Return which quantities of the curves lie outside the ranges of the file."""
    found = []
    for name in ("load", "longitudinal_slip", "slip_angle", "camber"):
        values = np.concatenate([sweep[name] for sweep in table.sweeps.values()])
        low, high = float(values.min()), float(values.max())
        known = ranges.get(name)
        if known is not None and (low < known.lowest or high > known.highest):
            unit = "" if known.unit == "1" else f" {known.unit}"
            words = f"{name} {low:.4g} to {high:.4g}{unit} of the curves"
            found.append(f"{words}, of {known.lowest:.4g} to {known.highest:.4g}{unit} of the file")
    return found


def _key_figures(tyre: FileTyre, table: TyreTable, load: float) -> dict[str, float | None]:
    """Return slopes at no slip, peaks and relaxation lengths at a load."""
    step = 1e-5
    evaluate = force_function(tyre, 16.7)
    inputs = np.array(
        [[load, s, a, 0.0] for s, a in ((step, 0), (-step, 0), (0, step), (0, -step))]
    )
    forces = evaluate(inputs)
    along, across = table.of_load("longitudinal", load), table.of_load("lateral", load)
    try:
        lengths = tyre.relaxation_lengths(TyreInput(load, 0.0, 0.0, 0.0))
        sigma: tuple[float | None, ...] = (float(lengths.longitudinal), float(lengths.lateral))
    except InputError:
        sigma = (None, None)
    slopes = (forces[0, 0] - forces[1, 0], forces[3, 1] - forces[2, 1])
    peaks = (np.abs(along["longitudinal_force"]).max(), np.abs(across["lateral_force"]).max())
    numbers = (load, *(s / (2.0 * step) for s in slopes), *peaks, *sigma)
    found = {n: None if v is None else float(v) for n, v in zip(_HEADS, numbers, strict=True)}
    if not all(v is None or math.isfinite(v) for v in found.values()):
        raise InputError(f"{tyre.path}: forces at {load:g} N are no numbers")
    return found
