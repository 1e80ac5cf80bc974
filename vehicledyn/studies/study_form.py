"""What study files have in common: keys that are checked, scenarios that are found."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.problems import START, Problem, dotted, refusal
from vehicledyn.base.yaml import Document, read_yaml
from vehicledyn.files.scenario import LoadedScenario, load_scenario
from vehicledyn.files.scenario.settings import override_texts

LARGEST = 1e9
"""Largest number of a study that no other limit is given for."""


@dataclass
class StudyForm:
    """A study file as plain data, and what is wrong with it so far."""

    path: Path
    document: Document
    problems: list[Problem]

    @staticmethod
    def read(path: Path, *, required: Sequence[str], optional: Sequence[str]) -> StudyForm:
        """Read a file and check its keys.

        Raises
        ------
        InputError
            If it cannot be read or is no mapping.
        """
        document = read_yaml(path)
        form = StudyForm(path, document, list(document.problems))
        if not isinstance(document.data, dict):
            form.wrong((), f"a study is a mapping with {', '.join(required)}")
            form.refuse()
        form.check((), document.data, (*required, *optional))
        for key in required:
            if key not in document.data or document.data[key] in (None, {}, [], ""):
                form.wrong((key,), "missing")
        return form

    @property
    def data(self) -> dict[str, Any]:
        """The content."""
        found: dict[str, Any] = self.document.data
        return found

    def wrong(self, place: tuple[str | int, ...], words: str) -> None:
        """Note a problem at a place."""
        marks = self.document
        mark = marks.values.get(place) or marks.keys.get(place) or START
        found = Problem(marks.name, mark, ".".join(map(str, place)) or "file", words)
        if found not in self.problems:
            self.problems.append(found)

    def refuse(self) -> None:
        """Raise InputError if anything is wrong."""
        if self.problems:
            raise refusal(self.problems, self.document.name)

    def check(self, place: tuple[str | int, ...], item: Any, keys: Collection[str]) -> bool:
        """Note keys that mean nothing; return whether the item is a mapping."""
        if not isinstance(item, dict):
            self.wrong(place, f"expected a mapping with {', '.join(keys)}")
            return False
        for key in item:
            if key not in keys:
                guess = nearest_name(str(key), keys)
                hint = f"; did you mean '{guess}'?" if guess else ""
                self.wrong((*place, key), f"unknown key{hint} Known: {', '.join(keys)}")
        return True

    def entries(
        self, place: tuple[str | int, ...], keys: Sequence[str] = (), needed: Sequence[str] = ()
    ) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield the mappings of a mapping by name, those that have the needed keys."""
        group: Any = self.data
        for step in place:
            group = group.get(step) if isinstance(group, dict) else None
        if group is None:
            return
        if not isinstance(group, dict):
            self.wrong(place, "expected a mapping")
            return
        for name, item in group.items():
            here = (*place, name)
            if keys and not self.check(here, item, keys):
                continue
            missing = [key for key in needed if item.get(key) is None]
            if missing:
                self.wrong(here, f"needs {', '.join(missing)}")
                continue
            yield str(name), item

    def number(
        self, key: str, default: float, *, least: float, most: float = LARGEST, whole: bool = False
    ) -> float:
        """Return a number of the study, noted as wrong if it is none, too small or too large."""
        value = self.data.get(key, default)
        kinds = int if whole else int | float
        if isinstance(value, bool) or not isinstance(value, kinds) or not least <= value <= most:
            what = "a whole number" if whole else "a number"
            is_large = isinstance(value, kinds) and value > most
            limit = f"most {most:g}" if is_large else f"least {least:g}"
            self.wrong((key,), f"expected {what} of at {limit}")
            return default
        return float(value)

    def choice(self, key: str, default: str, known: Collection[str]) -> str:
        """Return one of the known words of the study, noted as wrong if it is none."""
        value = self.data.get(key, default)
        if isinstance(value, str) and value in known:
            return value
        self.wrong((key,), f"'{value!s:.40}' is unknown; known: {', '.join(known)}")
        return default

    def placed(self, error: InputError) -> InputError:
        """Return an error about a key of the study, which it names, with file, line and column."""
        places = {dotted(place): place for place in self.document.values}
        field = next((name for name in error.about if name in places), None)
        if field is None:
            return InputError(f"{self.path}: {error}")
        mark = self.document.values[places[field]]
        words = str(error).removeprefix(f"{field}: ")
        return InputError(str(Problem(self.document.name, mark, field, words)))

    def scenario(
        self, place: tuple[str | int, ...], given: Any, changes: Any, overrides: Sequence[str] = ()
    ) -> LoadedScenario:
        """Return a scenario beside the study or of the library, with changes.

        Raises
        ------
        InputError
            If there is none of this name, or anything in it is wrong.
        """
        if not isinstance(given, str):
            self.wrong(place, "expected the path or name of a scenario")
            self.refuse()
        if changes is not None and not isinstance(changes, Mapping):
            self.wrong((*place[:-1], "set"), "expected a mapping of changes")
            self.refuse()
        texts = [*override_texts(changes or {}, {}), *overrides]
        return load_scenario(located(self.path, given), texts)


def is_there(path: Path) -> bool:
    """Return whether there is a file of a name, which may be too long for one."""
    try:
        return path.exists() and not path.is_dir()
    except OSError:
        return False


def located(path: Path, place: str) -> Path:
    """Return a scenario's path: beside the study, or of the library."""
    beside = path.parent / place
    if is_there(beside):
        return beside
    from vehicledyn.library import locate

    return locate(place, ("scenario",))
