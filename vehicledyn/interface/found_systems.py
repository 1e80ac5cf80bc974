"""Systems with the parameters that a search found, written as files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from vehicledyn.base.argument_names import argument, given
from vehicledyn.base.errors import InputError
from vehicledyn.base.files.whole_file import whole_file
from vehicledyn.files.scenario.target import Target


def only_model(targets: Iterable[Target], path: str | Path, values: Mapping[str, object]) -> Target:
    """Return the scenario of the model that a search changes, before the search begins.

    ``values`` are any that the parameters sought may have, by name, as texts with units.

    Raises
    ------
    InputError
        If the scenarios have different models, the file to write exists, or cannot hold a
        parameter, such as that of the tyre of one wheel.
    """
    found = list(targets)
    names = sorted({target.model_name for target in found})
    if len(names) > 1:
        raise InputError(
            f"{argument('system_file')}: the scenarios have several models: {', '.join(names)}; "
            "write them one by one with the values that are reported"
        )
    if Path(path).exists():
        raise InputError(f"{given('system_file', str(path))}: exists; choose another path")
    for name, value in values.items():
        if name.startswith("start."):
            continue
        key = f"parameters.{name.removeprefix('parameters.')}"
        try:
            found[0].with_overrides([f"{key}={value}"])
        except InputError as error:
            raise InputError(
                f"{argument('system_file')}: a system file cannot hold '{name}': "
                f"{str(error).splitlines()[0]}; seek another parameter, or write no file"
            ) from None
    return found[0]


def write_found_system(path: str | Path, target: Target, values: Mapping[str, str]) -> None:
    """Write the system of a scenario with values by dotted keys, texts with units.

    Values of starts, which are no part of a system, are left out.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    from vehicledyn.analyses import write_system

    changes = [f"{key}={value}" for key, value in values.items() if key.startswith("parameters.")]
    text = write_system(target.with_overrides(changes))
    try:
        with whole_file(Path(path)) as scratch:
            scratch.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from None
