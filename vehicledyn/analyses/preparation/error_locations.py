"""Say where in a file the parts or names stand that an error of the equations is about."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

from vehicledyn.base.argument_names import setting
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.problems import Problem, refusal
from vehicledyn.base.yaml import parse_yaml
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.files.scenario.sources import Sources
from vehicledyn.files.scenario.target import Target


@contextmanager
def errors_with_locations(target: Target) -> Iterator[None]:
    """Give the errors of a block the lines of the parts they are about, where there is a file.

    Raises
    ------
    InputError, NumericalError
        The block's own, as ``file:line:column: field: message``.
    """
    try:
        yield
    except (InputError, NumericalError) as error:
        places = target.written.places
        known = [name for name in dict.fromkeys(error.about) if name in places]
        if not known:
            raise
        kind = InputError if isinstance(error, InputError) else NumericalError
        raise kind(_with_places(str(error), known, places)) from None


def _with_places(text: str, names: list[str], places: Mapping[str, Problem]) -> str:
    first, lines = places[names[0]], [places[name].mark for name in names]
    others = [
        f"'{name}' is in line {mark.line}"
        for name, mark in zip(names, lines, strict=True)
        if mark is not None and mark != lines[0]
    ]
    head, line, rest = text.partition("\n")
    listed = f"{head} ({', '.join(others)})" if others else head
    return str(first._replace(message=f"{listed}{line}{rest}"))


def wrong_output(
    loaded: LoadedScenario, field: str, problems: Sequence[tuple[str, str]]
) -> InputError:
    """Return the error of names under ``output`` that mean nothing.

    Parameters
    ----------
    loaded
        The scenario.
    field
        "channels" or "plots".
    problems
        Wrong names with what is wrong.
    """
    name = str(loaded.path)
    sources = Sources(parse_yaml(loaded.text, name))
    given: Sequence[str] = getattr(loaded.scenario.output, field) or ()
    for override in loaded.overrides:
        key = override.partition("=")[0].strip()
        if key == f"output.{field}":
            sources.override(("output", field), setting(key))
    listed = [
        sources.problem(("output", field, given.index(wrong)), words) for wrong, words in problems
    ]
    return refusal(listed, name)
