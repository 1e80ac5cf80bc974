"""What study files have in common: keys that are checked, scenarios that are found."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Place
from vehicledyn.base.yaml import Document, read_yaml
from vehicledyn.files.scenario.load import LoadedScenario, examine_scenario
from vehicledyn.files.scenario.overrides import Change, read_override
from vehicledyn.files.scenario.settings import override_texts
from vehicledyn.studies.mistakes import Mistakes

LARGEST = 1e9
"""Largest number of a study that no other limit is given for."""


@dataclass(frozen=True)
class StudyForm:
    """A study file as plain data, and what is wrong with it so far."""

    path: Path
    document: Document
    mistakes: Mistakes = field(repr=False, compare=False)

    @staticmethod
    def read(path: Path, *, required: Sequence[str], optional: Sequence[str]) -> StudyForm:
        """Read a file and check its keys.

        Raises
        ------
        InputError
            If it cannot be read or is no mapping.
        """
        document = read_yaml(path)
        form = StudyForm(path, document, Mistakes(document, list(document.problems)))
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

    def identity(self, *without: str) -> str:
        """Return a text that is equal for equal content, some keys of the study aside.

        Those are keys that no step of the computation depends on, so that it may go on with
        another value of them.
        """
        return repr({key: item for key, item in self.data.items() if key not in without})

    def wrong(self, place: Place, words: str, *, at_key: bool = False) -> None:
        """Note a problem at a place."""
        self.mistakes.wrong(place, words, at_key=at_key)

    def refuse(self) -> None:
        """Raise InputError if anything is wrong."""
        self.mistakes.refuse()

    def check(self, place: Place, item: Any, keys: Collection[str]) -> bool:
        """Note keys that mean nothing; return whether the item is a mapping."""
        if not isinstance(item, dict):
            self.wrong(place, f"expected a mapping with {', '.join(keys)}")
            return False
        self.mistakes.check_keys(place, item, keys)
        return True

    def entries(
        self, place: Place, keys: Sequence[str] = (), needed: Sequence[str] = ()
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
            if needed and not isinstance(item, dict):
                self.wrong(here, f"expected a mapping with {', '.join(needed)}")
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

    def scenario(
        self,
        place: Place,
        given: Any,
        changes: Any,
        overrides: Sequence[str] = (),
        *,
        groups: Sequence[Place] = (("set",),),
    ) -> LoadedScenario | None:
        """Return a scenario beside the study or of the library, None and problems if it is wrong.

        Parameters
        ----------
        place
            Place of its path or name.
        given
            Its path or name.
        changes
            Changes by dotted keys that the study makes, None for none.
        overrides
            Further changes ``key=value``.
        groups
            Places of the mappings that the changes stand in, the last first.
        """
        if not isinstance(given, str):
            self.wrong(place, "expected the path or name of a scenario")
            return None
        if changes is not None and not isinstance(changes, Mapping):
            self.wrong(groups[-1], "expected a mapping of changes")
            return None
        try:
            path = located(self.path, given)
            document = read_yaml(path)
            texts = [*override_texts(changes or {}, {}), *overrides]
        except InputError as error:
            self.wrong(place, str(error).splitlines()[0])
            return None
        loaded, problems = examine_scenario(document, path, texts)
        if loaded is None:
            own = [
                Change(key, item, self._origin(key, groups))
                for key, item in (changes or {}).items()
            ]
            own += [item for item in map(read_override, overrides) if isinstance(item, Change)]
            problems = examine_scenario(document, path, (), own)[1] or problems
            self.mistakes.problems += [p for p in problems if p not in self.mistakes.problems]
        return loaded

    def only_scenario(
        self, place: Place, given: Any, changes: Any, overrides: Sequence[str] = ()
    ) -> LoadedScenario:
        """Return a scenario as :meth:`scenario` does.

        Raises
        ------
        InputError
            If anything in it, or in the study so far, is wrong.
        """
        loaded = self.scenario(place, given, changes, overrides)
        self.refuse()
        assert loaded is not None  # what is wrong with it was refused
        return loaded

    def _origin(self, key: str, groups: Sequence[Place]) -> str:
        """Return the line of a change of a scenario, for messages."""
        known = ((*group, key) for group in groups if (*group, key) in self.document.values)
        return str(self.mistakes.problem(next(known, groups[-1]), ""))


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
