"""Verbs on linearised models: eigenmodes and frequency responses."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import vehicledyn
from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import counted, is_count
from vehicledyn.cli.commands.analyses import read_target
from vehicledyn.cli.options import (
    Backend,
    BackendChoice,
    Json,
    Overrides,
    Target,
    is_result_name,
    speeds_in_si,
)
from vehicledyn.cli.performing import perform, show
from vehicledyn.cli.replacing import MODES, RESPONSE, Overwrite, Resume, check_replacing

if TYPE_CHECKING:
    from vehicledyn.files.scenario import LoadedModel, LoadedScenario


class StartKind(StrEnum):
    """Where a motion starts, see the field ``start`` of scenarios."""

    NOMINAL = "nominal"
    STATIC = "static"
    STEADY = "steady"


class Spacing(StrEnum):
    """How frequencies are spaced."""

    LOG = "log"
    LINEAR = "linear"


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    app.command()(eig)
    app.command()(response)


def eig(
    target: Target,
    *,
    speed: Annotated[
        list[str] | None,
        typer.Option(
            help='Speed such as "20 m/s", or FROM:TO:COUNT such as "2 m/s:10 m/s:33"; may be '
            "repeated, the scenario's if absent."
        ),
    ] = None,
    overrides: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Change a value; repeat a key to compute several cases.",
        ),
    ] = None,
    start: Annotated[
        StartKind | None,
        typer.Option(
            help="Point to linearise about; if absent, straight running of a vehicle, or the "
            "scenario's start or the equilibrium of a system."
        ),
    ] = None,
    backend: BackendChoice = Backend.AUTO,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="File to write: a result with shapes (.h5), or JSON (others)."
        ),
    ] = None,
    plots: Annotated[
        Path | None, typer.Option(help="Folder for root locus and mode shapes.")
    ] = None,
    resume: Resume = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Compute eigenmodes of a vehicle running straight, or of a system about a given point."""
    speeds = [value for text in speed or [] for value in speeds_in_si(text)]
    cases = cases_of(overrides or [])
    targets = _targets(target, cases)
    is_result = output is not None and is_result_name(output)
    if output is not None and is_result:
        check_replacing(output, MODES, overwrite=overwrite, resume=resume)
    data = perform(
        vehicledyn.modes,
        dict(targets),
        speed=speeds,
        start=None if start is None else start.value,
        backend=backend.value,
        save_to=output if is_result else None,
        overwrite=True,
        resume=resume,
        plots=plots,
    )
    show(data, as_json=as_json, plots=plots, file=None if is_result else output)


def _targets(
    target: str, cases: list[tuple[str, list[str]]]
) -> list[tuple[str, LoadedScenario | LoadedModel]]:
    """Return the target with the changes of each case; problems of all cases are one error."""
    found, problems = [], []
    for setting, changes in cases:
        try:
            found.append((setting, read_target(target, changes)))
        except InputError as error:
            problems += [line for line in str(error).splitlines() if not is_count(line)]
    if problems:
        listed = list(dict.fromkeys(problems))
        raise InputError("\n".join([*listed, counted(len(listed), target)]))
    return found


def cases_of(overrides: list[str]) -> list[tuple[str, list[str]]]:
    """Return the cases of ``--set`` options: what is varied, and all changes of each case.

    Keys that are given several times vary together, the first values in the first case.
    """
    values: dict[str, list[str]] = {}
    for override in overrides:
        values.setdefault(override.partition("=")[0].strip(), []).append(override)
    varied = {key: texts for key, texts in values.items() if len(texts) > 1}
    counts = {len(texts) for texts in varied.values()}
    if len(counts) > 1:
        counted_keys = ", ".join(f"{key} {len(texts)}" for key, texts in varied.items())
        raise InputError(f"--set: keys vary together, give each as many values: {counted_keys}")
    return [
        (
            ", ".join(texts[case] for texts in varied.values()),
            [texts[case if key in varied else 0] for key, texts in values.items()],
        )
        for case in range(max(counts, default=1))
    ]


def response(
    target: Target,
    *,
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--input",
            "-u",
            metavar="NAME",
            help="Driven coordinate, steering, road_wheel_angle, road, road:WHEEL, profile, "
            "force:COORDINATE, wrench:BODY.force_x, parameter:NAME; may be repeated.",
        ),
    ] = None,
    outputs: Annotated[
        list[str] | None,
        typer.Option("--output", "-y", metavar="CHANNEL", help="Output channel; may be repeated."),
    ] = None,
    first: Annotated[
        str, typer.Option("--from", metavar="FREQUENCY", help="Lowest frequency, such as '0.1 Hz'.")
    ] = "0.1 Hz",
    last: Annotated[
        str, typer.Option("--to", metavar="FREQUENCY", help="Highest frequency, such as '30 Hz'.")
    ] = "30 Hz",
    points: Annotated[int, typer.Option(help="Number of frequencies.")] = 200,
    spacing: Annotated[Spacing, typer.Option(help="Spacing of the frequencies.")] = Spacing.LOG,
    at: Annotated[
        list[str] | None,
        typer.Option(metavar="FREQUENCY", help="Report the response here; may be repeated."),
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help='Speed such as "20 m/s"; the scenario\'s if absent.')
    ] = None,
    overrides: Overrides = None,
    result: Annotated[
        Path | None, typer.Option("--result", "-o", help="Result file (HDF5) to write.")
    ] = None,
    plots: Annotated[Path | None, typer.Option(help="Folder for Bode plots.")] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Compute frequency responses from inputs to outputs, linearised about a reference motion."""
    loaded = read_target(target, overrides)
    if result is not None:
        check_replacing(result, RESPONSE, overwrite=overwrite)
    if not outputs:
        raise InputError("--output: missing: name a channel; 'models show --json' lists them")
    if not inputs:
        raise InputError("--input: missing: name what is moved or loaded, such as steering")
    data = perform(
        vehicledyn.response,
        loaded,
        inputs,
        outputs,
        first=first,
        last=last,
        points=points,
        spacing=spacing.value,
        at=at or (),
        speed=speed,
        save_to=result,
        overwrite=True,
        plots=plots,
    )
    show(data, as_json=as_json, plots=plots)
