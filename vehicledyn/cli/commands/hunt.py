"""The verb "hunt": limit cycles along a parameter."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import vehicledyn
from vehicledyn.cli.commands.analyses import read_target
from vehicledyn.cli.options import Backend, BackendChoice, Json, Overrides, Quiet, Target
from vehicledyn.cli.performing import conclude, perform
from vehicledyn.cli.replacing import HUNT, Overwrite, Resume, check_replacing


def add_verbs(app: typer.Typer) -> None:
    """Add the verb of this module to the command line."""
    app.command()(hunt)


def hunt(
    target: Target,
    *,
    first: Annotated[
        str,
        typer.Option(
            "--from", metavar="VALUE", help='Lowest value, such as "5 m/s"; numbers are in SI.'
        ),
    ],
    last: Annotated[str, typer.Option("--to", metavar="VALUE", help="Highest value.")],
    parameter: Annotated[
        str, typer.Option("--parameter", "-p", metavar="NAME", help="What is varied.")
    ] = "speed",
    points: Annotated[
        int | None,
        typer.Option(
            min=2,
            max=10000,
            help="About as many cycles on each way through the range; 60, fewer where cycles take "
            "long, if left out.",
        ),
    ] = None,
    channels: Annotated[
        list[str] | None,
        typer.Option(
            "--channel",
            metavar="CHANNEL",
            help="Report amplitudes of this; the first one is watched in simulations.",
        ),
    ] = None,
    amplitude: Annotated[
        float, typer.Option(help="First amplitude of a branch, in m or rad, of the leading one.")
    ] = 1e-4,
    disturbance: Annotated[
        float, typer.Option(help="With which simulations start, in m or rad.")
    ] = 1e-3,
    no_simulation: Annotated[
        bool, typer.Option("--no-simulation", help="Leave out the check by simulation.")
    ] = False,
    simulated: Annotated[
        str | None,
        typer.Option(
            metavar="TIME",
            help='Motion simulated at most for the check, such as "500 s"; about as much as half a '
            "minute computes if left out.",
        ),
    ] = None,
    secondary: Annotated[
        bool | None,
        typer.Option(
            "--secondary/--no-secondary",
            help="Follow cycles that branch off at branch points, more to one side than to the "
            "other; if not given, where no stable cycle is found.",
        ),
    ] = None,
    overrides: Overrides = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Result file; NAME_hunt.h5.")
    ] = None,
    plots: Annotated[
        Path | None, typer.Option(help="Folder of the figures; the result's name with _plots.")
    ] = None,
    resume: Resume = False,
    overwrite: Overwrite = False,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Draw nothing.")] = False,
    backend: BackendChoice = Backend.AUTO,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find critical speeds and limit cycles along a speed or any other parameter."""
    loaded = read_target(target, overrides)
    result = output or Path(f"{Path(target).stem}_hunt.h5")
    check_replacing(result, HUNT, overwrite=overwrite, resume=resume)
    folder = None if no_plots else plots or result.parent / f"{result.stem}_plots"
    data = perform(
        vehicledyn.hunt,
        loaded,
        first,
        last,
        parameter=parameter,
        points=points,
        channels=channels or (),
        amplitude=amplitude,
        disturbance=disturbance,
        simulate=not no_simulation,
        simulated=simulated,
        secondary=secondary,
        backend=backend.value,
        save_to=result,
        overwrite=True,
        resume=resume,
        plots=folder,
        quiet=quiet,
    )
    conclude(data, plots=folder, as_json=as_json, quiet=quiet)
