"""What analyses are asked about: a scenario, or a model by itself."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from vehicledyn.files.scenario.settings import Settings, override_texts

if TYPE_CHECKING:
    from vehicledyn.files.scenario.python_models import PythonModel
    from vehicledyn.files.scenario.sets import Scenario
    from vehicledyn.files.scenario.system_models import WrittenModel


class Target(ABC):
    """A model and, where there is one, the scenario that it stands in.

    ``overrides`` are what changed its file.
    ``written`` is the model with its parameters, and ``built`` that as it was built in Python,
    before any change. ``text`` is the scenario's and ``resolved`` everything that will be used; a
    model by itself has neither.
    """

    written: WrittenModel
    text: str
    resolved: dict[str, Any]
    overrides: tuple[str, ...]
    built: PythonModel | None

    @property
    @abstractmethod
    def choices(self) -> Scenario | None:
        """What the scenario chooses, None for a model by itself."""

    @property
    @abstractmethod
    def title(self) -> str:
        """Title of what is computed of it, which holds what was changed."""

    @property
    @abstractmethod
    def model_name(self) -> str:
        """Name of the model."""

    @property
    @abstractmethod
    def origin(self) -> Path:
        """Its file, or the name of the model in its place; files it names are beside it."""

    @property
    @abstractmethod
    def file_stem(self) -> str:
        """Beginning of the names of files about it."""

    @abstractmethod
    def with_overrides(self, overrides: Sequence[str], *, first: Sequence[str] = ()) -> Self:
        """Return it with further changes, made after those it has, but for some made ``first``.

        Raises
        ------
        InputError
            If a change means nothing or does not fit.
        """

    def changed(self, changes: Settings | None = None, **fields: Any) -> Self:
        """Return it with other values.

        Parameters
        ----------
        changes
            Values by dotted keys, such as ``{"solver.step": "1 ms"}``.
        fields
            Values by the fields of a scenario, such as ``speed="20 m/s"``, or by groups of the
            model's parameters.

        Raises
        ------
        InputError
            If a change means nothing or does not fit.
        """
        return self.with_overrides(override_texts(changes, fields))
