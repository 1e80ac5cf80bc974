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
        str, typer.Option("--parameter", "-p", metavar="NAME", help="Parameter to vary.")
    ] = "speed",
    points: Annotated[
        int | None,
        typer.Option(
            min=2,
            max=10000,
            help="Approximate number of cycles per pass through the range; 60 if absent, fewer "
            "where cycles are expensive.",
        ),
    ] = None,
    channels: Annotated[
        list[str] | None,
        typer.Option(
            "--channel",
            metavar="CHANNEL",
            help="Report the amplitude of this channel; simulations monitor the first one.",
        ),
    ] = None,
    amplitude: Annotated[
        float, typer.Option(help="Initial amplitude of a branch, in m or rad.")
    ] = 1e-4,
    disturbance: Annotated[
        float, typer.Option(help="Initial disturbance of simulations, in m or rad.")
    ] = 1e-3,
    no_simulation: Annotated[
        bool, typer.Option("--no-simulation", help="Skip the check by simulation.")
    ] = False,
    simulated: Annotated[
        str | None,
        typer.Option(
            metavar="TIME",
            help='Longest motion simulated for the check, such as "500 s"; about half a minute of '
            "computing if absent.",
        ),
    ] = None,
    secondary: Annotated[
        bool | None,
        typer.Option(
            "--secondary/--no-secondary",
            help="Follow asymmetric cycles from branch points; if absent, only where no stable "
            "cycle is found.",
        ),
    ] = None,
    overrides: Overrides = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Result file; NAME_hunt.h5 if absent.")
    ] = None,
    plots: Annotated[
        Path | None, typer.Option(help="Folder for the figures; RESULT_plots if absent.")
    ] = None,
    resume: Resume = False,
    overwrite: Overwrite = False,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Do not plot figures.")] = False,
    backend: BackendChoice = Backend.AUTO,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compute critical speeds, and limit cycles over speed or any other parameter."""
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
