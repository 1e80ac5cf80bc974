"""Verbs on the files that come with the program: list and copy them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.cli.completion import example_names
from vehicledyn.cli.options import Json, Quiet
from vehicledyn.cli.terminal import emit, tell, to_json
from vehicledyn.library import Kind, entries, find_entry, names_of

examples = typer.Typer(no_args_is_help=True, help="List and copy the scenarios of the library.")

_RUNNING: tuple[Kind, ...] = ("scenario", "study")
_COPIED: tuple[Kind, ...] = ("scenario", "study", "system", "profile")
_VERBS: dict[Kind, str] = {"scenario": "run", "study": "sweep", "system": "models show"}


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    app.add_typer(examples, name="examples")


@examples.command("list")
def list_examples(as_json: Json = False) -> None:
    """List scenarios and studies of the library, with their titles."""
    found = entries(*_RUNNING)
    if as_json:
        rows = [
            {"name": one.name, "kind": one.kind, "title": one.sentence(), "path": str(one.path)}
            for one in found
        ]
        emit(to_json(rows))
        return
    width = max(len(entry.name) for entry in found)
    for kind in _RUNNING:
        emit(f"vehicledyn {_VERBS[kind]} NAME")
        chosen = [entry for entry in found if entry.kind == kind]
        emit("\n".join(f"  {entry.name:{width}}  {entry.sentence()}" for entry in chosen))


@examples.command("copy")
def copy_example(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="Name of a scenario, study or system, or its place such as systems/bicycle.",
            autocompletion=example_names,
        ),
    ],
    *,
    folder: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="FOLDER", help="Target folder; the current one if absent."
        ),
    ] = Path(),
    quiet: Quiet = False,
) -> None:
    """Copy a library file and all files it refers to; never overwrites."""
    entry = find_entry(name, _COPIED)
    if entry is None:
        raise InputError(unknown_name("file of the library", name, names_of(*_COPIED)))
    from vehicledyn.library.copying import copy_entry

    copies = copy_entry(entry, folder)
    for path in copies:
        emit(str(path))
    if not quiet and entry.kind in _VERBS:
        tell(f"Next: vehicledyn {_VERBS[entry.kind]} {copies[0]}")
