"""The verb "linearise": a linearised model in state space, to take elsewhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import vehicledyn
from vehicledyn.base.errors import InputError
from vehicledyn.cli.commands.analyses import read_target
from vehicledyn.cli.options import Json, Overrides
from vehicledyn.cli.terminal import emit_report, show_progress


def add_verbs(app: typer.Typer) -> None:
    """Add the verb of this module to the command line."""
    app.command()(linearise)


def linearise(
    target: Annotated[str, typer.Argument(metavar="SCENARIO|MODEL", help="What to linearise.")],
    *,
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--input", "-u", metavar="NAME", help="Input, as for 'response'; may be repeated."
        ),
    ] = None,
    outputs: Annotated[
        list[str] | None,
        typer.Option("--output", "-y", metavar="CHANNEL", help="Output channel; may be repeated."),
    ] = None,
    order: Annotated[
        int | None, typer.Option(help="States to keep, by balanced truncation; all if absent.")
    ] = None,
    to: Annotated[
        list[str] | None,
        typer.Option(
            "--to",
            metavar="PATTERN",
            help="Differentiate A, B, C and D with respect to these parameters, such as 'front.*'; "
            "may be repeated, none if absent.",
        ),
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help='Speed such as "20 m/s"; the scenario\'s if absent.')
    ] = None,
    overrides: Overrides = None,
    result: Annotated[
        Path | None, typer.Option("--result", "-o", help="File to write: .mat or .npz.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Linearise a model about its reference motion; write a state-space model."""
    loaded = read_target(target, overrides)
    if not inputs or not outputs:
        missing = "--input" if not inputs else "--output"
        raise InputError(f"{missing}: missing: name what is moved, and channels")
    with show_progress() as progress:
        model = vehicledyn.linearise(
            loaded, inputs, outputs, order=order, to=to or None, speed=speed, progress=progress
        )
    if result is not None:
        model.save(result)
    emit_report(model, as_json=as_json)
