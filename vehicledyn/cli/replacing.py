"""What a verb may write over: results that it can compute again, and says so; nothing else."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vehicledyn.base.errors import InputError
from vehicledyn.cli.terminal import is_quiet, tell

Overwrite = Annotated[
    bool,
    typer.Option("--overwrite", help="Replace any existing result, even an unfinished one."),
]

Resume = Annotated[
    bool,
    typer.Option("--resume", help="Continue an interrupted computation."),
]

RUN, STUDY, HUNT = "vehicledyn-result", "vehicledyn-study", "vehicledyn-hunt"
HANDLING = "vehicledyn-handling"
MODES, RESPONSE, PROFILES = "vehicledyn-modes", "vehicledyn-response", "vehicledyn-profiles"
OPTIMUM, MANOEUVRE = "vehicledyn-optimum", "vehicledyn-manoeuvre"
IDENTIFICATION, UNCERTAINTY = "vehicledyn-identification", "vehicledyn-uncertainty"
EQUILIBRIUM, SENSITIVITY = "vehicledyn-equilibrium", "vehicledyn-sensitivity"

_STUDIES = (STUDY, HUNT)
_ENDED = ("ok", "failed")
"""States of results with which nothing is left to go on."""


def check_replacing(
    output: Path,
    kind: str,
    *,
    overwrite: bool = False,
    resume: bool = False,
    goes_on_by: str = "",
) -> None:
    """Refuse to replace a file that the verb cannot compute again in one go.

    A finished or failed result of the same kind is replaced, which a message says. Kept are
    results of other kinds, interrupted ones, and studies, which may hold hours of work.

    Parameters
    ----------
    output
        Where the verb writes; whether it is a file that may be written is checked elsewhere.
    kind
        Format of the results that the verb writes.
    overwrite
        Whether the user allows to replace any result.
    resume
        Whether the user goes on with what is there.
    goes_on_by
        Option by which the verb goes on with an unfinished run, empty for one that cannot.

    Raises
    ------
    InputError
        If the file is to be kept, or both are asked for.
    """
    if resume and overwrite:
        raise InputError("--resume continues a result, --overwrite replaces it; choose one")
    if overwrite or not output.is_file() or output.stat().st_size == 0:
        return
    if resume and (kind in _STUDIES or _facts(output).get("status") not in _ENDED):
        return
    from vehicledyn.results.hdf5.output import check_output

    check_output(output)
    facts = _facts(output)
    reason = _reason(output, kind, facts, goes_on_by)
    if reason:
        raise InputError(f"{output}: {reason}; choose another output with -o, or use --overwrite")
    if not is_quiet():
        tell(f"{output}: replacing the result of {facts['created']}, '{facts['title']}'")


def is_same(one: Path | None, other: Path) -> bool:
    """Return whether two paths name one file."""
    return one is not None and one.resolve() == other.resolve()


def _reason(output: Path, kind: str, facts: dict[str, str], goes_on_by: str) -> str:
    """Return why a file is kept, empty if it may be replaced."""
    from vehicledyn.results.tables.kinds import held

    found = facts.get("format", "")
    if not found:
        return "exists and is not a readable result"
    if found != kind:
        return f"holds {held(found)}, not {held(kind)}"
    if kind in _STUDIES:
        return "holds a study; continue it with --resume"
    if facts["status"] in ("running", "interrupted") and facts["samples"] != "0":
        advice = f"; continue it with '{goes_on_by} {output}'" if goes_on_by else ""
        return f"holds an unfinished run{advice}"
    return ""


def _facts(output: Path) -> dict[str, str]:
    """Return what the head of a result says, nothing where it cannot be read."""
    from vehicledyn.results.hdf5.opening import open_file

    try:
        with open_file(output) as file:
            names = ("format", "created", "title", "status")
            samples = str(len(file["time"])) if "time" in file else ""
            return {name: str(file.attrs.get(name, "")) for name in names} | {"samples": samples}
    except (InputError, OSError, RuntimeError, KeyError, ValueError):
        return {}
