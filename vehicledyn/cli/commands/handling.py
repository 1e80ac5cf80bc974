"""The verbs on the handling of road vehicles: steady cornering, and the standards' tests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import vehicledyn
from vehicledyn.base.errors import InputError
from vehicledyn.cli.commands.analyses import read_target
from vehicledyn.cli.options import Backend, BackendChoice, Json, Overrides, Target
from vehicledyn.cli.performing import perform
from vehicledyn.cli.replacing import HANDLING, Overwrite, Resume, check_replacing
from vehicledyn.cli.terminal import emit_report, show_progress

if TYPE_CHECKING:
    from vehicledyn.files.scenario import LoadedModel, LoadedScenario
    from vehicledyn.results.labelled.data import LabelledData
    from vehicledyn.results.tables.handling_table import HandlingTable

Against = Annotated[str | None, typer.Option(metavar="CAR", help="Second car to compare with.")]
Result = Annotated[
    Path | None, typer.Option("--output", "-o", help="Result file (.h5) of the first car.")
]
Plots = Annotated[Path | None, typer.Option(help="Folder for the figures.")]
ReportPage = Annotated[Path | None, typer.Option("--report", help="Report to write (.html).")]


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    app.command()(steady)
    app.command()(handling)


def steady(
    car: Target,
    *,
    speed: Annotated[
        str, typer.Option(help="Speed for turns, yaw moments and limits.")
    ] = "100 km/h",
    radius: Annotated[str, typer.Option(help="Radius of the circle.")] = "100 m",
    against: Against = None,
    overrides: Overrides = None,
    output: Result = None,
    plots: Plots = None,
    page: ReportPage = None,
    backend: BackendChoice = Backend.AUTO,
    resume: Resume = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Compute steady-state cornering: gradients, modes, yaw moments and limits."""
    wish = {"speed": speed, "radius": radius, "backend": backend.value}
    files = _Files(output, plots, page, overwrite, resume)
    _perform(vehicledyn.steady, _targets(car, against, overrides), files, wish, as_json)


def handling(
    car: Target,
    *,
    against: Against = None,
    overrides: Overrides = None,
    output: Result = None,
    plots: Plots = None,
    page: ReportPage = None,
    backend: BackendChoice = Backend.AUTO,
    resume: Resume = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Drive a car through the standard handling tests and write one report of the results."""
    files = _Files(output, plots, page, overwrite, resume)
    wish = {"backend": backend.value}
    _perform(vehicledyn.handling, _targets(car, against, overrides), files, wish, as_json)


@dataclass(frozen=True)
class _Files:
    """Where results, figures and the page go, and what becomes of a result that is there."""

    output: Path | None
    plots: Path | None
    page: Path | None
    overwrite: bool
    resume: bool


def _targets(
    car: str, against: str | None, overrides: list[str] | None
) -> list[LoadedScenario | LoadedModel]:
    """Return the cars; changes are those of the first."""
    return [read_target(car, overrides), *([] if against is None else [read_target(against, None)])]


def _perform(
    analysis: Callable[..., LabelledData],
    targets: list[LoadedScenario | LoadedModel],
    files: _Files,
    wish: dict[str, Any],
    as_json: bool,
) -> None:
    from vehicledyn.analyses.handling.report import HandlingReport

    output = files.output
    if output is not None:
        if output.suffix != ".h5":
            raise InputError(f"--output {output}: the name must end in .h5")
        check_replacing(output, HANDLING, overwrite=files.overwrite, resume=files.resume)
    found: list[HandlingTable] = []
    going_on = {"resume": True} if files.resume else {}  # the first car only
    for target, place in zip(targets, (output, None), strict=False):
        data = perform(
            analysis, target, save_to=place, overwrite=True, plots=files.plots, **wish, **going_on
        )
        going_on = {}
        found.append(data.report.table)  # type: ignore[union-attr]
    _draw(found, files)
    other = found[1] if len(found) > 1 else None
    emit_report(HandlingReport(found[0], other), as_json=as_json)


def _draw(tables: list[HandlingTable], files: _Files) -> None:
    """Draw the figures into a folder, and write the page."""
    with show_progress() as progress:
        if files.plots is not None:
            from vehicledyn.results.plots.handling.test_figures import handling_figures
            from vehicledyn.results.plots.picture_files import save_figures

            progress("drawing", None)
            save_figures(handling_figures(tables), files.plots, ("png", "svg"))
        if files.page is not None:
            from vehicledyn.results.report.handling_page import write_handling_page

            write_handling_page(files.page, tables, progress)
