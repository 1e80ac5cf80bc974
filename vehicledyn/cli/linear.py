"""Verbs on linearised models: frequency responses."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from vehicledyn.base.errors import InputError
from vehicledyn.cli.analyses import read_target
from vehicledyn.cli.options import Json, Overrides, Target, frequency_in_hz, speed_in_si
from vehicledyn.cli.terminal import emit_report, show_progress


class Spacing(StrEnum):
    """How frequencies are spaced."""

    LOG = "log"
    LINEAR = "linear"


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    app.command()(response)


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
        typer.Option("--output", "-y", metavar="CHANNEL", help="Channel; may be repeated."),
    ] = None,
    first: Annotated[str, typer.Option("--from", metavar="FREQUENCY", help="In Hz.")] = "0.1",
    last: Annotated[str, typer.Option("--to", metavar="FREQUENCY", help="In Hz.")] = "30",
    points: Annotated[int, typer.Option(help="Number of frequencies.")] = 200,
    spacing: Annotated[Spacing, typer.Option(help="How they are spaced.")] = Spacing.LOG,
    at: Annotated[
        list[str] | None,
        typer.Option(metavar="FREQUENCY", help="Tell the response here; may be repeated."),
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help='Speed such as "20 m/s"; the scenario\'s if absent.')
    ] = None,
    overrides: Overrides = None,
    result: Annotated[
        Path | None, typer.Option("--result", "-o", help="Result file (HDF5) to write.")
    ] = None,
    plots: Annotated[Path | None, typer.Option(help="Folder for Bode figures.")] = None,
    as_json: Json = False,
) -> None:
    """Find the frequency response of outputs to inputs, linearised about a reference motion."""
    loaded = read_target(target, overrides)
    if not outputs:
        raise InputError("--output: missing: name a channel; 'models show --json' lists them")
    if not inputs:
        raise InputError("--input: missing: name what is moved or loaded, such as steering")
    span = (frequency_in_hz("--from", first), frequency_in_hz("--to", last))
    wanted = [frequency_in_hz("--at", text) for text in at or []]
    from vehicledyn.run.frequency_grid import FrequencyGrid
    from vehicledyn.run.response import find_response

    grid = FrequencyGrid(*span, points, spacing.value)
    with show_progress() as progress:
        report = find_response(
            loaded,
            inputs=inputs,
            outputs=outputs,
            grid=grid,
            at=wanted,
            speed=None if speed is None else speed_in_si(speed),
            output=result,
            plots=plots,
            progress=progress,
        )
    emit_report(report, as_json=as_json)
