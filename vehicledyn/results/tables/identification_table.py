"""Identified parameters with their intervals, and how well they fit, as a result file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.units import digits_of
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

FORMAT = "vehicledyn-identification"


@dataclass(frozen=True)
class IdentificationTable:
    """Identified parameters, in SI.

    ``start``, ``value``, ``low`` and ``high`` of the 95 % intervals (n,); ``covariance`` (n, n);
    ``signals`` that were measured, and for each of their samples ``signal`` (n_samples,), which of
    them it belongs to, ``time`` [s], or where on a curve, ``measured``, ``fitted`` and
    ``residual`` in noise deviations.
    """

    title: str
    message: str
    n_runs: int
    parameters: tuple[Quantity, ...]
    start: Any
    value: Any
    low: Any
    high: Any
    covariance: Any
    variance: float
    whiteness: float
    signals: tuple[Quantity, ...]
    signal: Any
    time: Any
    measured: Any
    fitted: Any
    residual: Any
    notes: tuple[str, ...]
    over: tuple[str, ...] = ()
    """What the samples of each signal are measured over, such as ``time [s]``, with its unit."""


_BY_PARAMETER = {
    "start": "Value at the start",
    "value": "Identified value",
    "low": "Lower end of the 95 % interval",
    "high": "Upper end of the 95 % interval",
}
_BY_SAMPLE = {
    "signal": ("1", "Signal that the sample belongs to, from zero"),
    "time": ("as over", "Time, or place on a curve"),
    "measured": ("as signal", "Measured value"),
    "fitted": ("as signal", "Value of the model"),
    "residual": ("1", "Model less measurement, by the deviation of the noise"),
}


def write_identification(path: Path, table: IdentificationTable) -> None:
    """Write identified parameters to a file.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = {
        "title": table.title,
        "model": "",
        "message": table.message,
        "runs": table.n_runs,
        "variance": table.variance,
        "whiteness": table.whiteness,
    }
    with new_file(path, FORMAT, head) as file:
        parameters = write_quantities(file, "parameter", table.parameters)
        other = write_texts(file, "other", [item.name for item in table.parameters])
        other.make_scale("other")
        write_quantities(file, "signals", table.signals)
        numbers = np.arange(1, len(table.time) + 1)
        sample = write_axis(file, "sample", numbers, ("1", "Number of the sample"))
        for name, words in _BY_PARAMETER.items():
            about = ("as parameter", words)
            write_numbers(file, f"parameter_{name}", getattr(table, name), (parameters,), about)
        about = ("parameter*other", "Covariance of the parameters")
        write_numbers(file, "covariance", table.covariance, (parameters, other), about)
        for name, about in _BY_SAMPLE.items():
            write_numbers(file, f"sample_{name}", getattr(table, name), (sample,), about)
        write_texts(file, "notes", table.notes)
        write_texts(file, "over", table.over)


def read_identification(path: Path) -> IdentificationTable:
    """Read what :func:`write_identification` wrote.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        parameters = read_quantities(file, "parameter")
        sizes = Sizes({"parameters": len(parameters)})
        numbers = {
            name: sizes.read(file, f"parameter_{name}", "parameters", infinite=True)
            for name in _BY_PARAMETER
        }
        numbers |= {name: sizes.read(file, f"sample_{name}", "samples") for name in _BY_SAMPLE}
        both = ("parameters", "parameters")
        return IdentificationTable(
            str(file.attrs["title"]),
            str(file.attrs["message"]),
            int(file.attrs["runs"]),
            parameters,
            covariance=sizes.read(file, "covariance", *both, infinite=True),
            variance=float(file.attrs["variance"]),
            whiteness=float(file.attrs["whiteness"]),
            signals=read_quantities(file, "signals"),
            notes=tuple(read_texts(file, "notes")),
            over=tuple(read_texts(file, "over")) if "over" in file else (),
            **numbers,
        )


def describe_identification(path: Path) -> dict[str, Any]:
    """Return what a file of identified parameters holds."""
    table = read_identification(path)
    rows = zip(table.parameters, table.value, table.low, table.high, strict=True)
    return {
        "holds": "identified parameters",
        "title": table.title,
        "message": table.message,
        "runs": table.n_runs,
        "parameters": [
            f"{item.name} {value:.{digits}g} ({low:.{digits}g} to {high:.{digits}g}) {item.unit}"
            for item, value, low, high in rows
            for digits in (digits_of(float(value), float(high - low)),)
        ],
        "signals": [f"{item.name} [{item.unit}]" for item in table.signals],
        "notes": list(table.notes),
    }
