"""The verbs of the command line."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from vehicledyn.base.argument_names import arguments_named
from vehicledyn.base.errors import InputError, StoppedError
from vehicledyn.base.schema_line import schema_line
from vehicledyn.base.version import VERSION
from vehicledyn.cli.commands import files
from vehicledyn.cli.exit_codes import OK, code_of_error
from vehicledyn.cli.option_names import OptionNaming
from vehicledyn.cli.options import (
    Backend,
    BackendChoice,
    FileKind,
    Json,
    Overrides,
    Quiet,
    ScenarioFile,
    Verbose,
)
from vehicledyn.cli.performing import conclude, perform
from vehicledyn.cli.plugins import (
    PLUGIN_HELP,
    TAKE_PLUGINS,
    load_plugins,
    take_plugins,
)
from vehicledyn.cli.replacing import RUN, Overwrite, check_replacing, is_same
from vehicledyn.cli.terminal import (
    emit,
    emit_report,
    listen,
    set_quiet,
    tell,
    to_json,
    write_text,
)


class _Verbs(TyperGroup):
    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a verb; those that load models take plugins after their name, too."""
        command = super().get_command(ctx, cmd_name)
        if command is not None and cmd_name in TAKE_PLUGINS:
            take_plugins(self, command)
        return command

    def invoke(self, ctx: Any) -> Any:
        """Run a verb; messages name its options, Ctrl-C becomes an error with a message."""
        set_quiet(False)
        try:
            with arguments_named(OptionNaming()):
                return super().invoke(ctx)
        except typer.BadParameter as error:
            error.message = error.message.removeprefix(_IN_FRONT)
            raise
        except KeyboardInterrupt:
            raise StoppedError("interrupted") from None


_IN_FRONT = "Value error, "
"""What pydantic puts in front of the message for a wrong choice."""

HOMES = {
    "files": ("compare", "plot", "info", "assess"),
    "analyses": ("models", "equilibrium"),
    "linear": ("eig", "response"),
    "linearise": ("linearise",),
    "exports": ("export",),
    "export_data": ("export-data",),
    "paths": ("kinematics", "inverse", "rig"),
    "rail": ("profiles",),
    "sweep": ("sweep",),
    "hunt": ("hunt",),
    "sensitivity": ("sensitivity",),
    "studies": ("optimise", "optimise-manoeuvre", "identify", "uncertainty"),
    "report": ("report",),
    "animate": ("animate",),
    "start": ("init",),
    "examples": ("examples",),
    "track": ("track",),
    "tyre": ("tyre",),
    "cam": ("cam",),
    "handling": ("steady", "handling"),
}
"""Commands by the module of `commands` they stand in, in the order in which help lists them."""


def command_line(words: Sequence[str] = ()) -> typer.Typer:
    """Return the command line with all verbs, or with the one that is asked for.

    Parameters
    ----------
    words
        What follows the name of the program. Where they begin with a verb only its module is
        loaded; help, completion and mistakes need all of them.
    """
    app = typer.Typer(
        name="vehicledyn",
        cls=_Verbs,
        help="Vehicle dynamics from symbolic multibody equations: scenario in, result file out.",
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
    )
    app.callback()(common)
    for function in _OWN.values():
        app.command()(function)
    verb = _verb_of(words)
    for home, verbs in HOMES.items():
        if not verb or verb in verbs:
            import_module(f"vehicledyn.cli.commands.{home}").add_verbs(app)
    if verb:
        app.registered_commands = [
            item
            for item in app.registered_commands
            if verb == (item.name or getattr(item.callback, "__name__", ""))
        ]
    return app


def command_for(words: Sequence[str]) -> Any:
    """Return what runs these words; a process makes the command of a verb once."""
    return _command_of(_verb_of(words))


@cache
def _command_of(verb: str) -> Any:
    return typer.main.get_command(command_line([verb]))


def _verb_of(words: Sequence[str]) -> str:
    """Return the verb that words begin with, empty where that is none."""
    first = words[0] if words else ""
    return first if first in _OWN or any(first in verbs for verbs in HOMES.values()) else ""


def _show_version(wanted: bool) -> None:
    if wanted:
        emit(f"vehicledyn {VERSION}")
        raise typer.Exit


def common(
    version: Annotated[
        bool,
        typer.Option("--version", is_eager=True, callback=_show_version, help="Show the version."),
    ] = False,
    plugins: Annotated[
        list[Path] | None,
        typer.Option(
            "--plugin",
            metavar="FILE.py",
            is_eager=True,
            callback=load_plugins,
            help=PLUGIN_HELP,
        ),
    ] = None,
) -> None:
    """Vehicle dynamics from symbolic multibody equations: scenario in, result file out."""


def run(
    scenario: ScenarioFile,
    *,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Result file; SCENARIO.h5 if absent."),
    ] = None,
    overrides: Overrides = None,
    plots: Annotated[
        Path | None, typer.Option(help="Folder for the figures; RESULT_plots if absent.")
    ] = None,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Do not plot figures.")] = False,
    restart: Annotated[
        Path | None,
        typer.Option(metavar="RESULT", help="Partial or complete result to continue from."),
    ] = None,
    overwrite: Overwrite = False,
    backend: BackendChoice = Backend.AUTO,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Simulate a scenario; write a result file and figures."""
    from vehicledyn.results.plots.drawing_process import drawing_process

    with drawing_process(wanted=not no_plots) as draw:
        loaded = files.read_scenario(scenario, overrides)
        from vehicledyn import simulate

        listen(quiet=quiet, verbose=verbose)
        result = output or Path(f"{scenario.stem}.h5")
        check_replacing(
            result,
            RUN,
            overwrite=overwrite or is_same(restart, result),
            goes_on_by="--restart",
        )
        folder = None if no_plots else plots or result.parent / f"{result.stem}_plots"
        data = perform(
            simulate,
            loaded,
            save_to=result,
            overwrite=True,
            restart=restart,
            backend=backend.value,
            plots=folder,
            quiet=quiet,
            verbose=verbose,
        )
        conclude(data, plots=folder, as_json=as_json, quiet=quiet, draw=draw)


def validate(
    scenarios: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Scenario, system or study files.")
    ],
    overrides: Overrides = None,
) -> None:
    """Check scenario, system and study files without running them."""
    wrong = OK
    for scenario in scenarios:
        try:
            warnings = files.read_file(scenario, overrides)
        except InputError as error:
            tell(str(error))
            wrong = code_of_error(error)
        else:
            for warning in warnings:
                tell(f"{scenario}: {warning}")
            emit(f"{scenario}: ok")
    raise typer.Exit(wrong)


def schema(
    output: Annotated[Path | None, typer.Option("--output", "-o", help="File to write.")] = None,
    of: Annotated[FileKind, typer.Option("--of", help="Kind of files.")] = FileKind.SCENARIO,
) -> None:
    """Write the JSON schema of scenario, system or study files for editors."""
    import vehicledyn.catalogue  # noqa: F401

    text = to_json(_schema_of(of))
    if output is None:
        emit(text)
    else:
        write_text(output, text)
        line = schema_line(output.name).rstrip()
        tell(f"Files in its folder use it when their first line is: {line}")


def _schema_of(kind: FileKind) -> dict[str, Any]:
    """Return a schema; its maker alone is loaded."""
    if kind is FileKind.SYSTEM:
        from vehicledyn.files.system.schema import system_schema

        return system_schema()
    if kind is FileKind.STUDY:
        from vehicledyn.studies import study_schema

        return study_schema()
    from vehicledyn.files.scenario import scenario_schema

    return scenario_schema()


def doctor(as_json: Json = False) -> None:
    """Show versions, C compiler, cache and catalogues of the installation."""
    from vehicledyn.cli.commands.doctor import examine

    emit_report(examine(), as_json=as_json)


_OWN = {function.__name__: function for function in (run, validate, schema, doctor)}
"""Commands that stand in this module."""
