"""Lines of a summary, left out where a quantity does not exist in a run."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry


def entry(
    name: str, value: float | bool | str, unit: str, description: str
) -> Iterator[SummaryEntry]:
    """Yield one line; none for a number that is not finite."""
    from vehicledyn.results.store.layout import SummaryEntry

    if isinstance(value, bool | str) or math.isfinite(value):
        yield SummaryEntry(name, value, unit, description)
