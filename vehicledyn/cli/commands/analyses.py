"""Verbs on models: list and show them, find their equilibrium."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import vehicledyn
from vehicledyn.cli.completion import model_names
from vehicledyn.cli.finding import find_file
from vehicledyn.cli.options import (
    Backend,
    BackendChoice,
    Json,
    Overrides,
    Target,
    is_result_name,
)
from vehicledyn.cli.performing import perform, show
from vehicledyn.cli.replacing import EQUILIBRIUM, Overwrite, check_replacing
from vehicledyn.cli.terminal import emit, emit_report, show_progress, to_json
from vehicledyn.library import Kind

if TYPE_CHECKING:
    from vehicledyn.files.scenario import LoadedModel, LoadedScenario

models = typer.Typer(no_args_is_help=True, help="List and show the models of the catalogue.")


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    app.add_typer(models, name="models")
    app.command()(equilibrium)


@models.command("list")
def list_models(as_json: Json = False) -> None:
    """List the models."""
    entries = vehicledyn.models()
    if as_json:
        emit(to_json(entries))
    else:
        width = max(map(len, entries), default=0)
        emit("\n".join(f"{name:{width}}  {line}" for name, line in entries.items()))


@models.command("show")
def show_model(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME|FILE",
            help="Name of the model, system or scenario file.",
            autocompletion=model_names,
        ),
    ],
    *,
    overrides: Overrides = None,
    backend: BackendChoice = Backend.AUTO,
    as_yaml: Annotated[
        bool, typer.Option("--yaml", help="Write the model as a system file instead.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Show a model: bodies, coordinates, parameters, channels, operation counts."""
    from vehicledyn.analyses import describe_model, write_system
    from vehicledyn.interface.targets import read_described

    loaded = read_described(read_target(name, None), overrides or ())

    if as_yaml:
        emit(write_system(loaded))
        return
    with show_progress() as progress:
        report = describe_model(loaded, backend=backend.value, progress=progress)
    emit_report(report, as_json=as_json)


def equilibrium(
    target: Target,
    *,
    overrides: Overrides = None,
    speed: Annotated[
        str | None, typer.Option(help='Speed such as "20 m/s"; the scenario\'s if absent.')
    ] = None,
    backend: BackendChoice = Backend.AUTO,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="File to write: a result (.h5), or JSON (others)."),
    ] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Compute the equilibrium of a vehicle at rest or running straight ahead, or of a system."""
    loaded = read_target(target, overrides)
    as_result = output is not None and is_result_name(output)
    if output is not None and as_result:
        check_replacing(output, EQUILIBRIUM, overwrite=overwrite)
    data = perform(
        vehicledyn.equilibrium,
        loaded,
        speed=speed,
        backend=backend.value,
        save_to=output if as_result else None,
        overwrite=True,
    )
    show(data, as_json=as_json, file=None if as_result else output)


def read_target(
    target: str,
    overrides: list[str] | None,
    kinds_of_file: tuple[Kind, Kind] = ("system", "scenario"),
) -> LoadedScenario | LoadedModel:
    """Return the model or scenario that a path or name means.

    Where a system and a scenario of the library have the name, the first of ``kinds_of_file`` is
    meant.
    """
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.base.registry import kinds
    from vehicledyn.files.scenario import is_system_file, load_model, load_scenario

    if target in kinds("model") and not Path(f"{target}.yaml").is_file():
        return load_model(target, overrides or ())
    path = find_file(target, *kinds_of_file, others=kinds("model"))
    if is_system_file(path):
        return load_model(str(path), overrides or ())
    return load_scenario(path, overrides or ())
