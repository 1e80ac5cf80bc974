"""Verbs that move a system along given paths: kinematics and inverse dynamics."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import vehicledyn
from vehicledyn.base.errors import InputError
from vehicledyn.cli.commands.analyses import read_target
from vehicledyn.cli.commands.files import read_scenario
from vehicledyn.cli.options import (
    Backend,
    BackendChoice,
    Json,
    Overrides,
    Quiet,
    ScenarioFile,
    Target,
)
from vehicledyn.cli.performing import conclude, perform
from vehicledyn.cli.replacing import RUN, Overwrite, Resume, check_replacing

Plots = Annotated[Path | None, typer.Option(help="Folder for the figures; RESULT_plots if absent.")]
NoPlots = Annotated[bool, typer.Option("--no-plots", help="Do not plot figures.")]


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    app.command()(kinematics)
    app.command()(inverse)
    app.command()(rig)


def kinematics(
    target: Target,
    *,
    drives: Annotated[
        list[str] | None,
        typer.Option(
            "--drive",
            metavar="NAME=FROM:TO:STEPS",
            help="Coordinate or sensor and its values, such as 'wheel.z=200 mm:400 mm:20', or one "
            "value; may be repeated. The scenario's section 'kinematics' if absent.",
        ),
    ] = None,
    together: Annotated[
        bool,
        typer.Option("--together", help="Move all drives together, not through all combinations."),
    ] = False,
    hold: Annotated[
        list[str] | None,
        typer.Option(metavar="COORDINATE", help="Hold this coordinate at its start value."),
    ] = None,
    columns: Annotated[
        list[str] | None,
        typer.Option("--channel", metavar="PATTERN", help="Show these channels in the table."),
    ] = None,
    overrides: Overrides = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Result file; NAME_kinematics.h5 if absent."),
    ] = None,
    plots: Plots = None,
    no_plots: NoPlots = False,
    resume: Resume = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Move a mechanism along driven paths: positions, velocity ratios, singularities."""
    ranges = dict(map(_drive, drives or []))
    if len(ranges) != len(drives or []):
        raise InputError("--drive: a channel is driven twice; name each once")
    loaded = read_target(target, overrides, ("scenario", "system"))
    result = output or Path(f"{Path(target).stem}_kinematics.h5")
    check_replacing(result, RUN, overwrite=overwrite, resume=resume)
    folder = None if no_plots else plots or result.parent / f"{result.stem}_plots"
    data = perform(
        vehicledyn.kinematics,
        loaded,
        ranges,
        together=together,
        hold=hold or (),
        channels=columns or (),
        save_to=result,
        overwrite=True,
        resume=resume,
        plots=folder,
        quiet=quiet,
    )
    conclude(data, plots=folder, as_json=as_json, quiet=quiet)


def inverse(
    scenario: ScenarioFile,
    *,
    motion: Annotated[
        Path | None,
        typer.Option(
            metavar="TABLE",
            help="CSV or result file with the motion; the scenario's section 'motion' if absent.",
        ),
    ] = None,
    overrides: Overrides = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Result file; NAME_inverse.h5 if absent.")
    ] = None,
    plots: Plots = None,
    no_plots: NoPlots = False,
    resume: Resume = False,
    overwrite: Overwrite = False,
    backend: BackendChoice = Backend.AUTO,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compute the forces required for a prescribed motion; write a result file and figures."""
    loaded = read_scenario(scenario, overrides)
    result = output or Path(f"{scenario.stem}_inverse.h5")
    check_replacing(result, RUN, overwrite=overwrite, resume=resume)
    folder = None if no_plots else plots or result.parent / f"{result.stem}_plots"
    data = perform(
        vehicledyn.inverse,
        loaded,
        motion=motion,
        save_to=result,
        overwrite=True,
        resume=resume,
        backend=backend.value,
        plots=folder,
        quiet=quiet,
    )
    conclude(data, plots=folder, as_json=as_json, quiet=quiet)


def _drive(text: str) -> tuple[str, str]:
    name, equals, values = text.partition("=")
    if not name.strip() or not equals or not values.strip():
        raise InputError(f"--drive {text}: write NAME=FROM:TO:STEPS or NAME=VALUE")
    return name.strip(), values.strip()


def rig(
    target: Target,
    *,
    test: Annotated[
        str,
        typer.Option(
            help="parallel, roll (wheels up and down), steer, lateral, longitudinal (forces at the "
            "contact points) or aligning (moment)."
        ),
    ] = "parallel",
    values: Annotated[
        str | None,
        typer.Option(
            metavar="FROM:TO:STEPS",
            help="Travel, roll angle, steering coordinate, force or moment, such as "
            "'-60 mm:60 mm:24'; a usual range if absent.",
        ),
    ] = None,
    travel: Annotated[
        str,
        typer.Option(help="Wheel travel while the wheels are steered or loaded, such as '20 mm'."),
    ] = "0 mm",
    steering: Annotated[
        str | None,
        typer.Option(
            metavar="COORDINATE", help="Steering coordinate; that of a body 'rack' if absent."
        ),
    ] = None,
    overrides: Overrides = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Result file; NAME_rig_TEST.h5 if absent.")
    ] = None,
    plots: Plots = None,
    no_plots: NoPlots = False,
    resume: Resume = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Measure kinematics and compliance of an axle on a suspension rig."""
    loaded = read_target(target, overrides, ("scenario", "system"))
    result = output or Path(f"{Path(target).stem}_rig_{test}.h5")
    check_replacing(result, RUN, overwrite=overwrite, resume=resume)
    folder = None if no_plots else plots or result.parent / f"{result.stem}_plots"
    data = perform(
        vehicledyn.rig,
        loaded,
        test,
        values,
        travel=travel,
        steering=steering,
        save_to=result,
        overwrite=True,
        resume=resume,
        plots=folder,
        quiet=quiet,
    )
    conclude(data, plots=folder, as_json=as_json, quiet=quiet)
