"""What reads labelled arrays from a file, whatever the file's kind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol

from vehicledyn.results.labelled.array import LabelledArray
from vehicledyn.results.store.layout import EventRecord, SummaryEntry


class Head(NamedTuple):
    """What is known of a result besides its arrays."""

    kind: str
    title: str
    model: str
    status: str = "ok"
    message: str = ""
    attributes: Mapping[str, Any] = {}


class Source(Protocol):
    """Reads the arrays of one file."""

    @property
    def head(self) -> Head:
        """Kind, title, model and how it ended."""

    @property
    def names(self) -> Sequence[str]:
        """Names of the arrays, in the order of the model."""

    def read(self, names: Sequence[str]) -> list[LabelledArray]:
        """Return arrays by some of the names; the file is opened once for all."""

    def summary(self) -> Mapping[str, SummaryEntry]:
        """Return the key figures by name."""

    def events(self) -> tuple[EventRecord, ...]:
        """Return the events."""

    def notes(self) -> tuple[str, ...]:
        """Return remarks and warnings."""
