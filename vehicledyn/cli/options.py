"""Options that several verbs share."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from vehicledyn.base.errors import InputError
from vehicledyn.cli.completion import model_names, scenario_names
from vehicledyn.cli.terminal import set_quiet
from vehicledyn.interface.quantities import speed_in_si

MOST_SPEEDS = 1000


class Backend(StrEnum):
    """How the equations are evaluated."""

    AUTO = "auto"
    COMPILED = "compiled"
    INTERPRETED = "interpreted"


class Format(StrEnum):
    """File formats of figures."""

    PNG = "png"
    SVG = "svg"


class FileKind(StrEnum):
    """Kinds of input files."""

    SCENARIO = "scenario"
    SYSTEM = "system"
    STUDY = "study"


ScenarioFile = Annotated[
    Path,
    typer.Argument(
        metavar="SCENARIO",
        help="Scenario file, or its name in the library ('examples list').",
        autocompletion=scenario_names,
    ),
]
ResultFile = Annotated[Path, typer.Argument(metavar="RESULT", help="Result file.")]
Target = Annotated[
    str,
    typer.Argument(
        metavar="SCENARIO|MODEL",
        help="Scenario or system file, or name of a model or scenario of the library.",
        autocompletion=model_names,
    ),
]
Overrides = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Change a value of the scenario; may be repeated."
    ),
]
BackendChoice = Annotated[
    Backend,
    typer.Option(
        "--backend", help="Compiled C code, CasADi's interpreter, or the better one available."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Write JSON to standard output.")]
Quiet = Annotated[
    bool,
    typer.Option("--quiet", "-q", help="Show errors only.", is_eager=True, callback=set_quiet),
]
Verbose = Annotated[
    bool, typer.Option("--verbose", "-v", help="Show more details of the progress.")
]


def speeds_in_si(text: str) -> list[float]:
    """Return the speeds that "20 m/s" or FROM:TO:COUNT, "2 m/s:10 m/s:33", means, in m/s."""
    first, colon, rest = text.partition(":")
    if not colon:
        return [speed_in_si(text)]
    last, _, number = rest.partition(":")
    count = int(number) if number.strip().isdecimal() else 0
    if not 2 <= count <= MOST_SPEEDS:
        raise InputError(
            f"--speed {text}: write FROM:TO:COUNT with a count from 2 to {MOST_SPEEDS}, "
            "such as '2 m/s:10 m/s:33'"
        )
    begin, end = speed_in_si(first), speed_in_si(last)
    return [begin + (end - begin) * k / (count - 1) for k in range(count)]


def is_result_name(path: Path) -> bool:
    """Return whether a file to write is to be a result, not a JSON report."""
    return path.suffix in (".h5", ".hdf5", ".nc")


def tolerance_of_channels(texts: list[str]) -> dict[str, float]:
    """Return the tolerances that options ``PATTERN=VALUE`` give."""
    tolerances = {}
    for text in texts:
        pattern, equals, value = text.rpartition("=")
        try:
            tolerances[pattern] = float(value)
        except ValueError:
            equals = ""
        if not equals or not pattern or not tolerances[pattern] >= 0.0:
            raise InputError(f"--tolerance {text}: write PATTERN=VALUE, such as 'chassis.*=1e-4'")
    return tolerances
