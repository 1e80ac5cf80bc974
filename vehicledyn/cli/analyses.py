"""Verbs on models: list and show them, their equilibrium and their eigenmodes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.cli.files import read_scenario
from vehicledyn.cli.options import (
    Backend,
    BackendChoice,
    Json,
    Overrides,
    Target,
    speed_in_si,
)
from vehicledyn.cli.terminal import emit, emit_report, show_progress, to_json

if TYPE_CHECKING:
    from vehicledyn.scenario import LoadedModel, LoadedScenario

models = typer.Typer(no_args_is_help=True, help="List and show the models of the catalogue.")
ReportFile = Annotated[
    Path | None, typer.Option("--output", "-o", help="File to write as JSON as well.")
]


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    app.add_typer(models, name="models")
    app.command()(equilibrium)
    app.command()(eig)


@models.command("list")
def list_models(as_json: Json = False) -> None:
    """List the models."""
    from vehicledyn.catalogue import first_lines

    entries = first_lines("model")
    if as_json:
        emit(to_json(entries))
    else:
        width = max(map(len, entries), default=0)
        emit("\n".join(f"{name:{width}}  {line}" for name, line in entries.items()))


@models.command("show")
def show_model(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the model.")],
    backend: BackendChoice = Backend.AUTO,
    as_json: Json = False,
) -> None:
    """Show a model: bodies, coordinates, parameters, channels, operation counts."""
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.base.registry import find

    find("model", name)
    from vehicledyn.run import describe_model

    with show_progress() as progress:
        report = describe_model(name, backend=backend.value, progress=progress)
    emit_report(report, as_json=as_json)


def equilibrium(
    target: Target,
    *,
    overrides: Overrides = None,
    speed: Annotated[
        str | None, typer.Option(help='Speed such as "20 m/s"; the scenario\'s if absent.')
    ] = None,
    backend: BackendChoice = Backend.AUTO,
    output: ReportFile = None,
    as_json: Json = False,
) -> None:
    """Find the equilibrium of a vehicle that stands or runs straight ahead."""
    loaded, wanted = read_target(target, overrides), None if speed is None else speed_in_si(speed)
    from vehicledyn.run import find_equilibrium

    with show_progress() as progress:
        report = find_equilibrium(loaded, speed=wanted, backend=backend.value, progress=progress)
    emit_report(report, as_json=as_json, file=output)


def eig(
    target: Target,
    *,
    speed: Annotated[
        list[str] | None,
        typer.Option(help='Speed such as "20 m/s"; may be repeated, the scenario\'s if absent.'),
    ] = None,
    overrides: Overrides = None,
    backend: BackendChoice = Backend.AUTO,
    output: ReportFile = None,
    as_json: Json = False,
) -> None:
    """Find the eigenmodes of the motion about straight running."""
    loaded, speeds = read_target(target, overrides), [speed_in_si(text) for text in speed or []]
    from vehicledyn.run import find_modes

    with show_progress() as progress:
        report = find_modes(loaded, speeds=speeds, backend=backend.value, progress=progress)
    emit_report(report, as_json=as_json, file=output)


def read_target(target: str, overrides: list[str] | None) -> LoadedScenario | LoadedModel:
    """Return the model of this name, or else the scenario in this file."""
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.base.registry import kinds
    from vehicledyn.scenario import load_model

    if target in kinds("model"):
        return load_model(target, overrides or ())
    if Path(target).suffix == "" and not Path(target).exists():
        guess = nearest_name(target, kinds("model"))
        hint = f"; did you mean '{guess}'?" if guess else ""
        known = ", ".join(kinds("model"))
        raise InputError(f"'{target}' is neither a file nor a model{hint} Known models: {known}")
    return read_scenario(Path(target), overrides)
