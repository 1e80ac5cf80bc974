"""Whether dependent coordinates stay determined, by determinants at the samples of a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vehicledyn.kernel.engine import WEAK_PIVOT, Vector


@dataclass(frozen=True)
class RateMonitor:
    """Says how well constraints determine rates that no loop determines, as rolling does.

    ``determinants`` maps times (n,) and the values of some ``channels`` (n, n_channels) to the
    determinant at each sample (n,).
    """

    channels: Sequence[int]
    determinants: Callable[[Vector, Vector], Vector]


class Soundness:
    """Looks at determinants sample by sample, as compiled lanes look at those of blocks."""

    def __init__(self) -> None:
        """Begin with none known."""
        self._before: Vector | None = None
        self._largest: Vector | float = 0.0

    def holds(self, rows: Vector) -> bool:
        """Return whether no determinant became weak or changed its sign.

        Parameters
        ----------
        rows
            The determinants at further samples, shape (n_samples, n_determinants).
        """
        for values in rows:
            sizes = np.abs(values)
            self._largest = np.maximum(self._largest, sizes)
            before = values if self._before is None else self._before
            if not ((sizes >= WEAK_PIVOT * self._largest) & (values * before > 0.0)).all():
                return False
            self._before = values
        return True
