"""Page of the command line, from the typer app."""

from __future__ import annotations

from typing import Any

import typer

from sphinx_parts.tables import table


def pages() -> dict[str, tuple[str, str]]:
    """Return the page of all verbs."""
    from vehicledyn.cli.verbs import command_line

    group: Any = typer.main.get_command(command_line())
    text = "\n\n".join([_HEAD, *(_verb(name, group.commands[name]) for name in group.commands)])
    return {"commands": (text + "\n", "every verb with its arguments and options.")}


_HEAD = """# Command line

Results go to standard output, progress and messages to standard error. Exit codes: 0 ok;
1 negative result; 2 invalid input or usage; 3 numerical failure, what was computed is kept;
4 an optional part is missing; 5 some cases of a study failed; 70 a bug of vehicledyn;
130 interrupted, what was computed is kept."""


def _verb(name: str, command: Any, parent: str = "vehicledyn") -> str:
    whole = f"{parent} {name}"
    parts = [f"{'##' if parent == 'vehicledyn' else '###'} {whole}", _help(command)]
    inner = getattr(command, "commands", None)
    if inner is not None:
        parts += [_verb(each, inner[each], whole) for each in inner]
        return "\n\n".join(parts)
    context = typer.Context(command, info_name=whole)
    usage = " ".join([whole, *command.collect_usage_pieces(context)])
    parts.append(f"```text\n{usage}\n```")
    rows = [row for each in command.params if (row := _row(each, context))]
    if rows:
        parts.append(table(("argument or option", "meaning"), rows))
    return "\n\n".join(parts)


def _help(command: Any) -> str:
    return "\n\n".join(" ".join(p.split()) for p in (command.help or "").split("\n\n"))


def _row(parameter: Any, context: Any) -> tuple[str, str] | None:
    record = parameter.get_help_record(context)
    if record is None or "--help" in record[0]:
        return None
    return f"`{record[0].strip()}`", " ".join(record[1].split())
