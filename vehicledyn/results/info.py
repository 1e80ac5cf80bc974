"""What a result file holds, for people and for programs."""

from __future__ import annotations

from dataclasses import asdict, astuple, dataclass
from pathlib import Path
from typing import Any

from vehicledyn.base.units import shown
from vehicledyn.results.store.layout import EventRecord, SummaryEntry
from vehicledyn.results.store.reader import ENDS, Result, open_result

_MOST_EVENTS = 20
"""Events that are shown to a person."""


@dataclass(frozen=True)
class ChannelRange:
    """A channel with its smallest and largest value; both are None without finite samples."""

    name: str
    unit: str
    description: str
    frame: str
    smallest: float | None
    largest: float | None
    not_finite: int


@dataclass(frozen=True)
class ResultDescription:
    """What a result file holds. Times are in seconds."""

    path: str
    title: str
    status: str
    state_of_run: str
    whole: bool
    model: str
    model_hash: str
    created: str
    program_version: str
    versions: dict[str, str]
    samples: int
    timed: bool
    start: float | None
    end: float | None
    summary: tuple[SummaryEntry, ...]
    channels: tuple[ChannelRange, ...]
    states: int
    solver: dict[str, Any]
    plots: tuple[str, ...]
    events: tuple[EventRecord, ...] = ()
    pictures: int = 0
    notes: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Return plain data that JSON can hold."""
        return asdict(self)

    def as_text(self) -> str:
        """Return lines for a person; a partial file says so first."""
        tables = (
            self._summary(), self._notes(), self._events(), self._solver(), self._channels()
        )  # fmt: skip
        return "\n".join([*self._heading(), *(line for table in tables for line in table)])

    def _heading(self) -> list[str]:
        unit = "s" if self.timed else "counted"
        span = "no samples" if self.start is None else f"{self.start:.6g} to {self.end:.6g} {unit}"
        versions = ", ".join(f"{name} {version}" for name, version in self.versions.items())
        model = f"{self.model} ({self.model_hash[:12]})" if self.model_hash else self.model
        return [
            *(
                []
                if self.whole
                else [self.state_of_run.replace("partial", "PARTIAL RESULT", 1), ""]
            ),
            f"{self.path}: {self.title}",
            f"  status    {self.status}",
            f"  model     {model}",
            f"  time      {span}, {self.samples} samples",
            f"  holds     {len(self.channels)} channels, {self.states} states{self._pictures()}",
            f"  plots     {', '.join(self.plots) or 'none described'}",
            f"  created   {self.created} by vehicledyn {self.program_version} ({versions})",
        ]

    def _pictures(self) -> str:
        return f", {self.pictures} pictures to animate" if self.pictures else ""

    def _summary(self) -> list[str]:
        rows = [
            (entry.description or entry.name, _reading(entry.value, entry.unit))
            for entry in self.summary
        ]
        return _table("Summary", rows)

    def _notes(self) -> list[str]:
        """Return what the run warned of and assumed, a line each."""
        return ["", "Notes", *(f"  {note}" for note in self.notes)] if self.notes else []

    def _events(self) -> list[str]:
        """Return the first events with their times, and how many more there are."""
        rows = [(event.name, f"{event.time:.9g} s") for event in self.events[:_MOST_EVENTS]]
        more = len(self.events) - len(rows)
        return _table("Events", [*rows, *([("...", f"{more} more")] if more else [])])

    def _solver(self) -> list[str]:
        rows = [(name, _reading(value, "1")) for name, value in self.solver.items()]
        return _table("Solver", rows)

    def _channels(self) -> list[str]:
        rows = [
            (
                channel.name,
                f"{_span(channel):<26}  {channel.unit:<8} {channel.description}".rstrip(),
            )
            for channel in self.channels
        ]
        return _table("Channels", rows)


def describe_result(path: str | Path) -> ResultDescription:
    """Return what a result file holds.

    Raises
    ------
    InputError
        If the file cannot be read as a result.
    """
    with open_result(path, ENDS) as result:
        return ResultDescription(
            path=str(path),
            title=result.title,
            status=result.status,
            state_of_run=result.state_of_run,
            whole=result.is_whole,
            model=result.model,
            model_hash=result.model_hash,
            created=result.created,
            program_version=result.program_version,
            versions=result.versions,
            samples=result.samples,
            timed=result.is_timed,
            start=float(result.time[0]) if len(result.time) else None,
            end=float(result.time[-1]) if len(result.time) else None,
            summary=tuple(result.summary.values()),
            channels=channel_ranges(result),
            states=len(result.state_names),
            solver=result.solver,
            plots=tuple(str(plot.get("name", "?")) for plot in result.plots),
            events=tuple(result.events),
            pictures=result.pictures,
            notes=result.notes,
        )


def channel_ranges(result: Result) -> tuple[ChannelRange, ...]:
    """Return what the channels of a result mean and their ranges over all samples."""
    return tuple(
        ChannelRange(name, *result.facts(name), *astuple(result.range(name)))
        for name in result.channels
    )


def _span(channel: ChannelRange) -> str:
    if channel.smallest is None:
        return "no values"
    # Adding zero turns -0.0 into 0.0.
    text = f"{channel.smallest + 0.0:.6g} .. {(channel.largest or 0.0) + 0.0:.6g}"
    return text + (f" ({channel.not_finite} not finite)" if channel.not_finite else "")


def _reading(value: Any, unit: str) -> str:
    return ("yes" if value else "no") if isinstance(value, bool) else shown(value, unit)


def _table(heading: str, rows: list[tuple[str, str]]) -> list[str]:
    if not rows:
        return []
    width = max(len(name) for name, _ in rows)
    return ["", heading, *(f"  {name:<{width}}  {text}" for name, text in rows)]
