"""Verbs on studies: "optimise", "optimise-manoeuvre", "identify" and "uncertainty"."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import vehicledyn
from vehicledyn.cli.exit_codes import code_of_result
from vehicledyn.cli.finding import find_file
from vehicledyn.cli.options import Json, Overrides
from vehicledyn.cli.performing import perform, show
from vehicledyn.cli.replacing import (
    IDENTIFICATION,
    MANOEUVRE,
    OPTIMUM,
    UNCERTAINTY,
    Overwrite,
    Resume,
    check_replacing,
)

if TYPE_CHECKING:
    from vehicledyn.results.labelled.data import LabelledData

Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Result file; STUDY.h5 if absent."),
]
FoundSystem = Annotated[
    Path | None,
    typer.Option(metavar="FILE.yaml", help="System file to write with the resulting values."),
]
Plots = Annotated[Path | None, typer.Option(help="Folder for the figures.")]


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    for verb in (optimise, optimise_manoeuvre, identify, uncertainty):
        app.command(verb.__name__.replace("_", "-"))(verb)


def optimise(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="Optimisation study file.")],
    *,
    output: Output = None,
    overrides: Overrides = None,
    resume: Resume = False,
    system: FoundSystem = None,
    plots: Plots = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Optimise parameters of a model by exact gradients, with bounds and constraints."""
    files = _Files(study, output, plots, resume=resume, overwrite=overwrite)
    files.conduct(vehicledyn.optimise, OPTIMUM, overrides, as_json, system_file=system)


def optimise_manoeuvre(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="Study of an optimal manoeuvre.")],
    *,
    output: Output = None,
    overrides: Overrides = None,
    resume: Resume = False,
    plots: Plots = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Compute the controls that minimise the time or cost of a manoeuvre, by collocation."""
    files = _Files(study, output, plots, resume=resume, overwrite=overwrite)
    files.conduct(vehicledyn.optimise_manoeuvre, MANOEUVRE, overrides, as_json)


def identify(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="Identification study file.")],
    *,
    output: Output = None,
    overrides: Overrides = None,
    resume: Resume = False,
    system: FoundSystem = None,
    plots: Plots = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Estimate parameters and initial values from measurements, with 95 % intervals."""
    files = _Files(study, output, plots, resume=resume, overwrite=overwrite)
    files.conduct(vehicledyn.identify_study, IDENTIFICATION, overrides, as_json, system_file=system)


def uncertainty(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="Uncertainty study file.")],
    *,
    output: Output = None,
    overrides: Overrides = None,
    resume: Resume = False,
    plots: Plots = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Compute the scatter of key figures when parameters have distributions."""
    files = _Files(study, output, plots, resume=resume, overwrite=overwrite)
    files.conduct(vehicledyn.uncertainty_study, UNCERTAINTY, overrides, as_json)


@dataclass(frozen=True)
class _Files:
    """The study, and what is written."""

    study: Path
    output: Path | None
    plots: Path | None
    resume: bool
    overwrite: bool

    def conduct(
        self,
        analysis: Callable[..., LabelledData],
        kind: str,
        overrides: list[str] | None,
        as_json: bool,
        **more: Any,
    ) -> None:
        """Conduct the study, draw its figures and print its report; leave with its exit code."""
        from vehicledyn.files.scenario.overrides import read_overrides

        path = find_file(self.study, "study")
        result = self.output or Path(f"{self.study.stem}.h5")
        check_replacing(result, kind, overwrite=self.overwrite, resume=self.resume)
        data = perform(
            analysis,
            path,
            plots=self.plots,
            set=read_overrides(overrides or ()),
            save_to=result,
            overwrite=True,
            resume=self.resume,
            **more,
        )
        show(data, as_json=as_json, plots=self.plots)
        raise typer.Exit(code_of_result(data))
