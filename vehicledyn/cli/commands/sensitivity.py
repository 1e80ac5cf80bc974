"""The verb that finds derivatives of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import vehicledyn
from vehicledyn.cli.options import Json, Overrides, Target, is_result_name
from vehicledyn.cli.performing import perform, show
from vehicledyn.cli.replacing import SENSITIVITY, Overwrite, Resume, check_replacing


def add_verbs(app: typer.Typer) -> None:
    """Add the verb to the command line."""
    app.command()(sensitivity)


def sensitivity(
    target: Target,
    *,
    of: Annotated[
        list[str],
        typer.Option(
            "--of",
            metavar="NAME",
            help="Key figure, channel, or figure of a channel such as 'max(chassis.roll)'; or "
            "'eigenvalues', 'mode_shapes', 'critical_speed', 'nonlinear_critical_speed', "
            "'cycle_amplitude(CHANNEL)', 'cycle_period', 'equilibrium.COORDINATE', "
            "'gain(OUTPUT, INPUT, 1.5 Hz)', 'phase(...)', 'kinematics(CHANNEL, DRIVE, VALUES)', "
            "'inverse(CHANNEL)', 'rig(QUANTITY, TEST, VALUES)', "
            "'steady(QUANTITY, METHOD, VALUES)', of a tyre file 'tyre(FORCE, LOAD, "
            "slip_angle=4 deg)', of a wheel profile 'profiles(roll, 2 mm, rail=60E1)', "
            "of a cam 'cam(lift, 30 deg)'; "
            "may be repeated.",
        ),
    ],
    to: Annotated[
        list[str] | None,
        typer.Option(
            "--to",
            metavar="PATTERN",
            help="Parameters, such as 'parameters.front.*', or start values, such as "
            "'start.chassis.y'; may be repeated, all parameters if absent.",
        ),
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help='Speed such as "20 m/s", of linear models and limit cycles.')
    ] = None,
    overrides: Overrides = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="File to write: a result (.h5), or JSON (others)."),
    ] = None,
    plots: Annotated[Path | None, typer.Option(help="Folder for tornado plots and curves.")] = None,
    resume: Resume = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Compute and rank exact derivatives of channels and key figures by parameters."""
    from vehicledyn.analyses.sensitivity.known_analyses import ANALYSES, analysis_of
    from vehicledyn.cli.commands.analyses import read_target

    is_file = ANALYSES[analysis_of(of[0])].subject == "file"
    loaded = target if is_file else read_target(target, overrides, ("scenario", "system"))
    is_result = output is not None and is_result_name(output)
    if output is not None and is_result:
        check_replacing(output, SENSITIVITY, overwrite=overwrite, resume=resume)
    data = perform(
        vehicledyn.sensitivity,
        loaded,
        of,
        to or ["parameters.*"],
        speed=speed,
        set=dict(item.partition("=")[::2] for item in overrides or ()) if is_file else None,
        save_to=output if is_result else None,
        overwrite=True,
        resume=resume,
        plots=plots,
    )
    show(data, as_json=as_json, plots=plots, file=None if is_result else output)
