"""How figures scatter with their parameters, as a result file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.results.store.consistency import Sizes
from vehicledyn.results.store.linear_file import (
    Quantity,
    new_file,
    old_file,
    read_quantities,
    read_texts,
    write_axis,
    write_numbers,
    write_quantities,
    write_texts,
)

FORMAT = "vehicledyn-uncertainty"


@dataclass(frozen=True)
class UncertaintyTable:
    """Spread of figures, in SI.

    ``mean``, ``deviation`` and their standard errors (m,); ``shares`` and ``totals`` (m, n) of the
    variance by parameter, not a number where the method gives none; ``points`` (n_runs, n) and
    ``samples`` (n_runs, m) of the runs, none of a method with gradients; samples of failed runs are
    not a number. ``shares_error`` and ``totals_error`` (m, n) are standard errors.
    """

    title: str
    method: str
    n_runs: int
    parameters: tuple[Quantity, ...]
    figures: tuple[Quantity, ...]
    mean: Any
    deviation: Any
    mean_error: Any
    deviation_error: Any
    shares: Any
    totals: Any
    points: Any
    samples: Any
    risks: tuple[str, ...]
    notes: tuple[str, ...]
    shares_error: Any = None
    totals_error: Any = None


_BY_FIGURE = {
    "mean": "Mean",
    "deviation": "Standard deviation",
    "mean_error": "Standard error of the mean",
    "deviation_error": "Standard error of the standard deviation",
}
_SHARES = {
    "shares": "Part of the variance that a parameter brings alone",
    "totals": "Part of the variance that a parameter takes part in",
}
_SHARE_ERRORS = {
    "shares_error": "Standard error of the part that a parameter brings alone",
    "totals_error": "Standard error of the part that a parameter takes part in",
}


def write_uncertainty(path: Path, table: UncertaintyTable) -> None:
    """Write the spread of figures to a file.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = {"title": table.title, "model": "", "method": table.method, "runs": table.n_runs}
    with new_file(path, FORMAT, head) as file:
        parameters = write_quantities(file, "parameter", table.parameters)
        figures = write_quantities(file, "figure", table.figures)
        runs = np.arange(1, len(table.samples) + 1)
        run = write_axis(file, "run", runs, ("1", "Number of the run"))
        for name, words in _BY_FIGURE.items():
            write_numbers(file, name, getattr(table, name), (figures,), ("as figure", words))
        for name, words in _SHARES.items():
            write_numbers(file, name, getattr(table, name), (figures, parameters), ("1", words))
        for name, words in _SHARE_ERRORS.items():
            given = getattr(table, name)
            errors = np.full(np.shape(table.shares), np.nan) if given is None else given
            write_numbers(file, name, errors, (figures, parameters), ("1", words))
        about = ("as parameter", "Parameters of the run")
        write_numbers(file, "point", table.points, (run, parameters), about)
        about = ("as figure", "Figures of the run")
        write_numbers(file, "sample", table.samples, (run, figures), about)
        write_texts(file, "risks", table.risks)
        write_texts(file, "notes", table.notes)


def read_uncertainty(path: Path) -> UncertaintyTable:
    """Read what :func:`write_uncertainty` wrote.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        parameters, figures = read_quantities(file, "parameter"), read_quantities(file, "figure")
        sizes = Sizes({"parameters": len(parameters), "figures": len(figures)})
        numbers = {name: sizes.read(file, name, "figures") for name in _BY_FIGURE}
        numbers |= {name: sizes.read(file, name, "figures", "parameters") for name in _SHARES}
        numbers |= {
            name: sizes.read(file, name, "figures", "parameters")
            for name in _SHARE_ERRORS
            if name in file  # files of earlier versions have none
        }
        return UncertaintyTable(
            str(file.attrs["title"]),
            str(file.attrs["method"]),
            int(file.attrs["runs"]),
            parameters,
            figures,
            points=sizes.read(file, "point", "points", "parameters"),
            samples=sizes.read(file, "sample", "points", "figures"),
            risks=tuple(read_texts(file, "risks")),
            notes=tuple(read_texts(file, "notes")),
            **numbers,
        )


def describe_uncertainty(path: Path) -> dict[str, Any]:
    """Return what a file of an uncertainty study holds."""
    table = read_uncertainty(path)
    spreads = zip(table.figures, table.mean, table.deviation, strict=True)
    return {
        "holds": "an uncertainty study",
        "title": table.title,
        "method": table.method,
        "runs": table.n_runs,
        "parameters": [item.name for item in table.parameters],
        "figures": [
            f"{item.name} {mean:.6g} +- {deviation:.3g} {item.unit}"
            for item, mean, deviation in spreads
        ],
        "risks": list(table.risks),
        "notes": list(table.notes),
    }
