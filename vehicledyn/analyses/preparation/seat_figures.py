"""Vibration at the seats of a model as key figures of a run, by ISO 2631-1."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.multibody.model.system import System
from vehicledyn.road.manoeuvres.channel_recorder import Recording

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry

_DIRECTIONS = ("longitudinal", "lateral", "vertical")
_SHORTEST = 1.0
"""Length of a run below which vibration is not assessed [s]."""


def seat_channels(system: System) -> list[str]:
    """Return the channels that the figures of its seats are made from."""
    return [f"{name}.{word}" for name in _seats(system) for word in _DIRECTIONS]


def seat_figures(system: System, recording: Recording) -> list[SummaryEntry]:
    """Return the key figures of the seats of a run, and what limits them."""
    seats = _seats(system)
    if not seats:
        return []
    from vehicledyn.results.assessment.even_samples import even_samples
    from vehicledyn.results.assessment.summary import summarise_vibration
    from vehicledyn.results.assessment.vibration import assess_vibration, vibration_remarks
    from vehicledyn.results.store.layout import SummaryEntry

    columns = {name: recording.column(name) for name in seat_channels(system)}
    entries: list[SummaryEntry] = []
    remarks: list[str] = []
    if _duration(recording) < _SHORTEST:
        remarks.append(f"vibration at seats is left out: the run is shorter than {_SHORTEST:g} s")
    else:
        samples = even_samples(recording.column("time"), columns)
        for seat in seats:
            found = assess_vibration(seat, samples)
            entries += summarise_vibration(found)
            remarks += vibration_remarks(found, samples)
    if remarks:
        entries.append(SummaryEntry("vibration_remarks", "; ".join(remarks), "", ""))
    return entries


def _duration(recording: Recording) -> float:
    time, count = recording.column("time"), recording.count
    return float(time[count - 1 : count][0] - time[0:1][0]) if count else 0.0


def _seats(system: System) -> list[str]:
    return [part.name for part in system.parts if getattr(part, "is_seat", False)]
