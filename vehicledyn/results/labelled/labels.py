"""What conversions and figures need to know of labelled arrays and of sets of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from numpy.typing import NDArray

from vehicledyn.results.store.layout import SummaryEntry


class Labelled(Protocol):
    """An array with labels, see :class:`vehicledyn.results.labelled.array.LabelledArray`."""

    @property
    def name(self) -> str:
        """Dotted name from whole to part."""

    @property
    def values(self) -> NDArray[Any]:
        """The numbers, or texts."""

    @property
    def dims(self) -> tuple[str, ...]:
        """Name of each dimension."""

    @property
    def unit(self) -> str:
        """Unit of the values."""

    @property
    def description(self) -> str:
        """Meaning in a phrase."""

    @property
    def frame(self) -> str:
        """Frame that the values are expressed in."""

    @property
    def coords(self) -> Mapping[str, Labelled]:
        """Labels along the dimensions."""

    @property
    def size_in_words(self) -> str:
        """Dimensions with their lengths."""


class LabelledSet(Protocol):
    """Arrays by name, see :class:`vehicledyn.results.labelled.data.LabelledData`."""

    kind: str
    title: str
    model: str
    status: str
    status_message: str
    attributes: Mapping[str, Any]

    @property
    def path(self) -> Path:
        """The file."""

    @property
    def summary(self) -> Mapping[str, SummaryEntry]:
        """Key figures by name."""

    def names(self, *patterns: str) -> list[str]:
        """Return the names that match patterns."""

    def arrays(self, *patterns: str) -> Sequence[Labelled]:
        """Return the arrays that match patterns."""

    def __getitem__(self, name: str) -> Labelled:
        """Return an array."""

    def __iter__(self) -> Iterator[str]:
        """Yield the names."""

    def __len__(self) -> int:
        """Return the number of arrays."""
