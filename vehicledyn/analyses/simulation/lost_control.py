"""When and where the driver of a run lost control of the car."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from vehicledyn.base.units import shown

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry

STATUS = "driver_lost"
"""How such a run ended; its result is whole."""

PATH_ERROR = "driver.path_error"
"""Channel of a run whose driver follows a path, which he may lose."""

_TIME, _PLACES = "lost_at_time", ("lost_at_x", "lost_at_distance")


def lost_control(summary: Iterable[SummaryEntry]) -> str:
    """Return when and where the driver lost the car by the summary; empty if he did not."""
    found = {entry.name: entry for entry in summary if entry.name in (_TIME, *_PLACES)}
    if _TIME not in found:
        return ""
    said = [f"{e.description}: {shown(e.value, e.unit)}" for e in found.values()]
    return f"{STATUS}: {'; '.join(said)}; what follows in the result is no drive along the path"
