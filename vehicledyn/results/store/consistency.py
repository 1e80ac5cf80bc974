"""Whether the arrays of a file fit together: sizes that they share, and numbers that are some.

What is read here can be relied on afterwards. All functions raise ValueError, which the readers
of files turn into the message that the file is damaged.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import h5py
import numpy as np

from vehicledyn.results.hdf5.opening import OpenFile
from vehicledyn.results.hdf5.text_lengths import require_lengths
from vehicledyn.results.store.decimation import promises_too_much

LARGEST = 1e100
"""Numbers beyond this come from no computation that went well; pictures of them overflow."""


@dataclass
class Sizes:
    """Sizes by name that the arrays of one table share, such as "modes"; given or first found."""

    known: dict[str, int] = field(default_factory=dict)

    def read(
        self,
        group: h5py.Group,
        name: str,
        *axes: str | int,
        infinite: bool = False,
        gaps: bool = True,
    ) -> Any:
        """Return a dataset of numbers as :meth:`fit` does, by default with missing ones.

        ``infinite`` says whether a computation may have come to infinite ones.
        """
        values = group[name][()]
        if infinite and values.dtype.kind == "f":
            self.fit(name, np.where(np.isinf(values), 0.0, values), *axes, gaps=True)
            return values
        return self.fit(name, values, *axes, gaps=gaps)

    def fit(self, name: str, values: Any, *axes: str | int, gaps: bool = False) -> Any:
        """Return an array of numbers whose axes have the named sizes.

        Parameters
        ----------
        name
            What the array is called in messages.
        values
            The array.
        axes
            Of each axis its size, or the name of one; an unknown name is learnt.
        gaps
            Whether values may be missing (not a number); infinite ones are none either way.

        Raises
        ------
        ValueError
            If the shape is another, or a value is no number of a computation.
        """
        array = np.asarray(values)
        if array.dtype.kind not in "fiucb":
            raise ValueError(f"{name} holds no numbers")
        if array.ndim != len(axes):
            raise ValueError(f"{name} has {array.ndim} axes, not {len(axes)}")
        for size, axis in zip(array.shape, axes, strict=True):
            wanted = self.known.setdefault(axis, size) if isinstance(axis, str) else axis
            if size != wanted:
                what = f"{axis}" if isinstance(axis, str) else "values"
                raise ValueError(f"{name} has {size} {what}, not {wanted}")
        sizes = np.abs(array[~np.isnan(array)] if gaps else array)
        if not np.all(sizes <= LARGEST):
            raise ValueError(f"{name} holds values that are no finite numbers")
        return array

    def count(self, name: str, values: Iterable[Any], axis: str) -> None:
        """Raise ValueError unless a list has a named size."""
        number = len(list(values))
        wanted = self.known.setdefault(axis, number)
        if number != wanted:
            raise ValueError(f"{name} has {number} {axis}, not {wanted}")


def require_groups(file: h5py.Group, names: Iterable[str]) -> None:
    """Raise ValueError if one of some names that a file may have is no group.

    To look for a name in a dataset is to read it whole, however long it says to be.
    """
    for name in names:
        if name in file and not isinstance(file[name], h5py.Group):
            raise ValueError(f"{name} is no group")


def require_stored(group: h5py.Group) -> None:
    """Raise ValueError if a dataset below a group says to hold far more than is stored.

    Of a whole file the texts are looked at too.
    """

    def look(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            if promises_too_much(item):
                raise ValueError(f"{name} is not in the file")
            if isinstance(group, OpenFile):
                require_lengths(group, name, item)

    group.visititems(look)


def require_columns(columns: Iterable[str], names: Iterable[str]) -> None:
    """Raise ValueError for the first name that is not among some columns."""
    known = set(columns)
    for name in names:
        if name not in known:
            raise ValueError(f"{name} is not there")


def require_known(name: str, values: Iterable[str], known: Iterable[str]) -> None:
    """Raise ValueError for the first value that is not among the known ones."""
    allowed = set(known)
    for value in values:
        if value not in allowed:
            raise ValueError(f"{name}: '{value[:40]}' is unknown")
