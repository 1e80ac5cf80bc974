"""The optimum of a study with the points that led to it, as a result file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py

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

FORMAT = "vehicledyn-optimum"

KEPT = 1e-5
"""Scaled violation up to which constraints are kept."""


@dataclass(frozen=True)
class FrontPoint:
    """A best compromise: variables (n,), objective and second figure there, and how it was found.

    ``optimality`` is the largest part of the scaled gradient left, ``violation`` the largest one
    of a constraint, ``n_runs`` the number of runs.
    """

    variables: Any
    objective: float
    figure: float
    optimality: float
    violation: float
    n_runs: int

    @property
    def is_kept(self) -> bool:
        """Whether it keeps the constraints."""
        return self.violation <= KEPT


@dataclass(frozen=True)
class OptimumTable:
    """An optimum, in SI.

    ``variables`` with ``low``, ``high``, ``start`` and ``best`` (n,); ``figures`` with values at
    the start and the optimum ``figure_values`` (2, m) and ``figure_slopes`` (m, n) there; the runs
    with ``points`` (n_runs, n), ``objective`` and ``violation`` (n_runs,); ``front`` the best
    compromises with a second figure; ``limits`` words on each constraint. ``status`` is "ok",
    "infeasible" where a constraint is not kept, which ``message`` names, or "stopped" where the
    search had no more runs.
    """

    title: str
    message: str
    variables: tuple[Quantity, ...]
    low: Any
    high: Any
    start: Any
    best: Any
    figures: tuple[Quantity, ...]
    figure_values: Any
    figure_slopes: Any
    points: Any
    objective: Any
    violation: Any
    optimality: float
    n_runs: int
    notes: tuple[str, ...]
    front: tuple[FrontPoint, ...] = ()
    front_figure: Quantity | None = None
    status: str = "ok"
    limits: tuple[str, ...] = ()


def write_optimum(path: Path, table: OptimumTable) -> None:
    """Write an optimum to a file.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = {
        "title": table.title,
        "model": "",
        "status": table.status,
        "message": table.message,
        "optimality": table.optimality,
        "runs": table.n_runs,
    }
    with new_file(path, FORMAT, head) as file:
        variables = write_quantities(file, "variable", table.variables)
        figures = write_quantities(file, "figure", table.figures)
        runs = range(1, len(table.objective) + 1)
        run = write_axis(file, "run", runs, ("1", "Number of the run"))
        for name, values, words in (
            ("low", table.low, "Lowest value allowed"),
            ("high", table.high, "Highest value allowed"),
            ("start", table.start, "Value at the start"),
            ("best", table.best, "Value at the optimum"),
        ):
            about = ("as variable", words)
            write_numbers(file, f"variable_{name}", values, (variables,), about)
        for name, values in zip(("start", "best"), table.figure_values, strict=True):
            about = ("as figure", f"Figure at the {name} point")
            write_numbers(file, f"figure_{name}", values, (figures,), about)
        about = ("figure/variable", "Derivative of the figure at the optimum")
        write_numbers(file, "figure_slope", table.figure_slopes, (figures, variables), about)
        about = ("as variable", "Variables of the run")
        write_numbers(file, "point", table.points, (run, variables), about)
        write_numbers(file, "objective", table.objective, (run,), ("1", "Objective of the run"))
        about = ("1", "Largest scaled violation of a constraint")
        write_numbers(file, "violation", table.violation, (run,), about)
        _write_front(file, table, variables)
        write_texts(file, "limits", table.limits)
        write_texts(file, "notes", table.notes)


def _write_front(file: h5py.File, table: OptimumTable, variables: h5py.Dataset) -> None:
    if table.front_figure is None:
        return
    file.attrs["front_figure"] = table.front_figure.name
    numbers = range(1, len(table.front) + 1)
    point = write_axis(file, "compromise", numbers, ("1", "Number of the compromise"))
    for name, unit, words in (
        ("objective", "1", "Objective of the compromise"),
        ("figure", table.front_figure.unit, f"{table.front_figure.name} of the compromise"),
        ("optimality", "1", "Largest part of the scaled gradient left"),
        ("violation", "1", "Largest scaled violation of a constraint"),
        ("n_runs", "1", "Runs of the compromise"),
    ):
        values = [float(getattr(item, name)) for item in table.front]
        write_numbers(file, f"front_{name}", values, (point,), (unit, words))
    values = [item.variables for item in table.front]
    about = ("as variable", "Variables of the compromise")
    write_numbers(file, "front_variables", values, (point, variables), about)


def read_optimum(path: Path) -> OptimumTable:
    """Return an optimum from its file.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        variables, figures = read_quantities(file, "variable"), read_quantities(file, "figure")
        sizes = Sizes({"variables": len(variables), "figures": len(figures)})
        columns = {
            name: sizes.read(file, f"variable_{name}", "variables")
            for name in ("low", "high", "start", "best")
        }
        values = [sizes.read(file, f"figure_{name}", "figures") for name in ("start", "best")]
        return OptimumTable(
            str(file.attrs["title"]),
            str(file.attrs["message"]),
            variables,
            figures=figures,
            figure_values=values,
            figure_slopes=sizes.read(file, "figure_slope", "figures", "variables"),
            points=sizes.read(file, "point", "runs", "variables"),
            objective=sizes.read(file, "objective", "runs", infinite=True),
            violation=sizes.read(file, "violation", "runs", infinite=True),
            optimality=float(file.attrs["optimality"]),
            n_runs=int(file.attrs["runs"]),
            notes=tuple(read_texts(file, "notes")),
            front=_read_front(file, sizes),
            front_figure=_front_figure(file),
            status=str(file.attrs.get("status", "ok")),
            limits=tuple(read_texts(file, "limits")) if "limits" in file else (),
            **columns,
        )


def _front_figure(file: h5py.File) -> Quantity | None:
    if "front_figure" not in file.attrs:
        return None
    unit, words = (str(file["front_figure"].attrs[key]) for key in ("units", "long_name"))
    return Quantity(str(file.attrs["front_figure"]), unit, words)


def _read_front(file: h5py.File, sizes: Sizes) -> tuple[FrontPoint, ...]:
    if "front_figure" not in file.attrs:
        return ()
    names = ("objective", "figure", "optimality", "violation", "n_runs")
    columns = [sizes.read(file, f"front_{name}", "points") for name in names]
    points = sizes.read(file, "front_variables", "points", "variables")
    return tuple(
        FrontPoint(point, float(a), float(b), float(c), float(d), int(n))
        for point, a, b, c, d, n in zip(points, *columns, strict=True)
    )


@dataclass(frozen=True)
class OptimumCourse:
    """What figures of an optimum show: the runs, and the front of compromises if there is one.

    ``objective`` and ``violation`` (n_runs,); ``front_objective``, ``front_value`` and whether
    constraints are kept, ``front_kept`` (n_points,).
    """

    objective: Any
    violation: Any
    front_figure: Quantity | None
    front_objective: Any
    front_value: Any
    front_kept: Any


def read_course(path: Path) -> OptimumCourse:
    """Return the course of a search from its file.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        sizes = Sizes()
        objective = sizes.read(file, "objective", "runs", infinite=True)
        violation = sizes.read(file, "violation", "runs", infinite=True)
        front_figure = _front_figure(file)
        if front_figure is None:
            return OptimumCourse(objective, violation, None, (), (), ())
        return OptimumCourse(
            objective,
            violation,
            front_figure,
            sizes.read(file, "front_objective", "points"),
            sizes.read(file, "front_figure", "points"),
            sizes.read(file, "front_violation", "points") <= KEPT,
        )


def describe_optimum(path: Path) -> dict[str, Any]:
    """Return what a file of an optimum holds.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        names = [item.name for item in read_quantities(file, "variable")]
        sizes = Sizes({"variables": len(names)})
        best = zip(names, sizes.read(file, "variable_best", "variables"), strict=True)
        return {
            "holds": "an optimum",
            "title": str(file.attrs["title"]),
            "status": str(file.attrs.get("status", "ok")),
            "message": str(file.attrs["message"]),
            "optimality": f"{float(file.attrs['optimality']):.2g}",
            "runs": int(file.attrs["runs"]),
            "variables": [f"{name} {float(value):.6g}" for name, value in best],
            "figures": [f"{item.name} [{item.unit}]" for item in read_quantities(file, "figure")],
        }
