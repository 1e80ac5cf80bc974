"""The verb "export": the equations of a model or scenario as functions, or as an FMU."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

from vehicledyn.analyses.preparation.prepare import (
    AssembledPoint,
    nominal_point,
    prepare,
    start_point,
)
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.codegen.printers.cuda_source import cuda_source
from vehicledyn.export.document import ExportedStart
from vehicledyn.export.files import SUFFIXES, export_files, file_of, write_text
from vehicledyn.export.fmi_description import RunDefaults
from vehicledyn.export.fmu import export_fmu
from vehicledyn.files.scenario.target import Target
from vehicledyn.multibody.equations.equation_terms import derive_ingredients

ExportKind: TypeAlias = Literal["c", "python", "matlab", "fmu", "cuda"]


@dataclass(frozen=True)
class ExportReport:
    """The files that were written."""

    paths: tuple[Path, ...]

    def as_text(self) -> str:
        """Return a line for each file."""
        return "\n".join(map(str, self.paths))

    def as_dict(self) -> dict[str, Any]:
        """Return the files as plain data."""
        return {"files": [str(path) for path in self.paths]}


def export_target(
    target: Target, *, kind: ExportKind, path: Path | None, progress: Progress
) -> ExportReport:
    """Write the equations of a model or scenario.

    The files carry the parameter values along and the point to start from: that of the
    scenario, or the nominal position of a model at rest.

    Parameters
    ----------
    target
        The validated scenario or model.
    kind
        "c", "python", "matlab", "fmu" or "cuda".
    path
        File to write, or the folder to write it to; None for the present folder.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If a file cannot be written.
    NumericalError
        If the loops cannot be assembled or there is no equilibrium to start from.
    """
    prepared = prepare(target, backend="interpreted", progress=progress)
    progress("finding the point to start from", None)
    point = _point(target, prepared)
    start = ExportedStart(
        tuple(map(float, prepared.kernel.parameters)),
        tuple(map(float, point.state)),
        tuple(map(float, point.unknowns)),
    )
    file = file_of(path, target.file_stem, SUFFIXES[kind])
    progress(f"writing {file}", None)
    if kind == "cuda":
        return ExportReport((write_text(file, cuda_source(prepared.equations)),))
    if kind == "fmu":
        return ExportReport((export_fmu(prepared.equations, file, start, _experiment(target)),))
    ingredients = derive_ingredients(prepared.subject.system)
    return ExportReport(tuple(export_files(ingredients, kind, file, start)))


def _point(target: Target, prepared: Prepared) -> AssembledPoint:
    chosen = target.choices
    if chosen is None:
        return nominal_point(prepared, 0.0)
    return start_point(prepared, chosen.speed or 0.0, chosen.start)


def _experiment(target: Target) -> RunDefaults:
    chosen = target.choices
    return RunDefaults() if chosen is None else RunDefaults(chosen.duration, chosen.output.interval)
