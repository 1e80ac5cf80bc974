"""What varies in a study, resolved: axes in SI, and the values of any of its cases."""

from __future__ import annotations

import math
from array import array
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from vehicledyn.base.units import is_pure

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Kind = Literal["grid", "list", "latin_hypercube", "random"]


def quantity_text(number: float, unit: str) -> str | float:
    """Return a value in SI as files write it, to the last bit; a pure number is itself.

    >>> quantity_text(0.1, "rad/s"), quantity_text(2.0, "1")
    ('0.1 rad/s', 2.0)
    """
    value = float(number)
    return value if is_pure(unit) else f"{value!r} {unit}"


@dataclass(frozen=True)
class Axis:
    """One key of the scenario that varies.

    A quantity has a ``unit`` and, except where it is random, its ``values`` in SI. Anything
    else is a choice: ``choices`` as the file gives them, and ``values`` are their numbers. A
    random axis goes from ``low`` to ``high``, evenly in the logarithm if ``is_log``.
    """

    key: str
    unit: str = ""
    values: array[float] = field(default_factory=lambda: array("d"))
    choices: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 0.0
    is_log: bool = False

    @property
    def is_choice(self) -> bool:
        """Whether it is no quantity."""
        return bool(self.choices)

    def value(self, number: float) -> Any:
        """Return what the scenario is given for a value in SI or the number of a choice."""
        return self.choices[int(number)] if self.choices else quantity_text(number, self.unit)

    def between(self, part: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values at parts of the range between 0 and 1."""
        import numpy as np

        if self.is_log:
            return np.asarray(np.exp(math.log(self.low) + part * math.log(self.high / self.low)))
        return self.low + part * (self.high - self.low)


@dataclass(frozen=True)
class Design:
    """Axes and the way they make cases; every case is found from its number alone."""

    kind: Kind
    axes: tuple[Axis, ...]
    count: int
    seed: int = 0

    def cases(self, first: int, stop: int) -> NDArray[np.float64]:
        """Return values of the cases ``first:stop``, (n, n_axes): SI, or numbers of choices."""
        import numpy as np

        index = np.arange(first, stop, dtype=np.int64)
        table = np.empty((len(index), len(self.axes)))
        parts = self._parts(index)
        for column, axis in enumerate(self.axes):
            given = None if parts is None else axis.between(parts[:, column])
            table[:, column] = self._listed(column, axis, index) if given is None else given
        return table

    def _parts(self, index: Any) -> Any:
        """Return where in the range of each axis cases lie, (n, n_axes); None where not drawn."""
        import numpy as np

        from vehicledyn.studies import indexed_random as scatter

        streams, rows = np.arange(len(self.axes)), index[:, None]
        if self.kind == "latin_hypercube":
            return scatter.latin_hypercube(self.seed, streams, rows, self.count)
        return scatter.uniform(self.seed, streams, rows) if self.kind == "random" else None

    def _listed(self, column: int, axis: Axis, index: Any) -> Any:
        """Return the values of an axis of a list or a grid."""
        import numpy as np

        values = np.frombuffer(axis.values)
        if self.kind == "list":
            return values[index]
        inner = math.prod(len(other.values) for other in self.axes[column + 1 :])
        return values[index // inner % len(values)]
