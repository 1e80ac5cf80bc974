"""The verb "kinematics": a system along driven paths, without forces; result file and figures."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.continuation import PathOutcome, SingularPlace
from vehicledyn.analyses.mechanism.axle_characteristics import axle_columns
from vehicledyn.analyses.mechanism.driven_mechanism import Mechanism, mechanism
from vehicledyn.analyses.mechanism.instant_axes import (
    WheelColumns,
    axis_channels,
    axis_values,
    swing_channels,
    swing_values,
    wheel_columns,
)
from vehicledyn.analyses.mechanism.kinematics_report import SHOWN, KinematicsReport
from vehicledyn.analyses.mechanism.mechanism_path import PathDrive, Sweep, run_sweep
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.preparation.target_digest import digests_to_keep
from vehicledyn.base.argument_names import argument, given
from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.ranges import read_range
from vehicledyn.files.scenario.target import Target
from vehicledyn.multibody.elements.wheel_angles import WheelAngles
from vehicledyn.multibody.loops.position_level import Positions
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.hdf5.output import check_output
from vehicledyn.results.store.layout import ResultHeader, SampleAxis, SummaryEntry
from vehicledyn.results.store.writer import ResultWriter
from vehicledyn.symbolic.equations import Channel

Array = NDArray[np.float64]
_COLUMNS = 7
_PANELS = 4
_MOST_FIGURES = 12
_FLAT = 1e-12


@dataclass(frozen=True)
class Request:
    """What to sweep: ranges of drives as texts by channel, at once or all combinations.

    ``hold`` names coordinates that stay at their start, ``columns`` patterns of the channels
    that the table shows; empty for some that matter.
    """

    drives: Mapping[str, str]
    together: bool = False
    hold: tuple[str, ...] = ()
    columns: tuple[str, ...] = ()


def sweep_kinematics(
    target: Target,
    request: Request,
    *,
    output: Path,
    progress: Progress,
    kept: KeptWork | None = None,
) -> KinematicsReport:
    """Sweep a system and write the result file.

    Parameters
    ----------
    target
        A scenario or a model; time-dependent drives of its own stay at time zero.
    request
        What to sweep; without drives what the scenario's section "kinematics" says.
    output
        Result file; checked before anything is computed.
    progress
        Called with what is going on.
    kept
        What is kept of it meanwhile.

    Raises
    ------
    InputError
        If a name or range is wrong, or a drive cannot move anything.
    NumericalError
        If the loops cannot be assembled at the start.
    """
    check_output(output)
    own, request = request, _complete(target, request)
    progress("assembling the loops", None)
    system = build_subject(target).system
    positions = Positions(system)
    _check_names(positions, own)
    machine = mechanism(positions, list(request.drives), request.hold)
    drives = _drives(positions, request)
    sensors = [part for part in system.parts if isinstance(part, WheelAngles)]
    book = _Columns(machine, moving_wheels(sensors, positions), [s.name for s in sensors])
    shown = book.shown(request.columns)
    kept = kept or KeptWork()
    facts = "kinematics", digests_to_keep(kept, [target]), request
    memory = kept.memory(*facts, kinds=(PathOutcome, SingularPlace))
    swept = run_sweep(machine, drives, together=request.together, progress=progress, memory=memory)
    files = _Files(target, system.name, output, _left_out(positions))
    return files.write(book, swept, shown)


def _left_out(positions: Positions) -> list[str]:
    """Return a note on the sensors that have no channels, if there are any."""
    names = positions.without_channels
    if not names:
        return []
    listed = ", ".join(f"'{name}'" for name in names)
    return [f"left out: {listed}, since a motion along a path knows no forces"]


def moving_wheels(sensors: Sequence[WheelAngles], positions: Positions) -> list[WheelColumns]:
    """Return the wheel sensors that move."""
    channels, speeds = ([c.name for c in g] for g in (positions.channels, positions.speeds))
    found = [wheel_columns(s.name, s.side == "left", channels, speeds) for s in sensors]
    return [columns for columns in found if columns is not None]


def _complete(target: Target, request: Request) -> Request:
    """Return a request with drives, those of the scenario where it has none of its own."""
    if request.drives:
        return request
    section = None if target.choices is None else target.choices.kinematics
    if section is None:
        raise InputError(
            f"nothing is driven; give {argument('drives')} with values FROM:TO:STEPS of a "
            "coordinate, or the section 'kinematics' "
            "of a scenario"
        )
    return Request(
        section.drives,
        request.together or section.together,
        (*request.hold, *section.hold),
        request.columns or section.columns,
    )


def _check_names(positions: Positions, request: Request) -> None:
    """Refuse drives and held coordinates that a caller gives and the model does not have."""
    channels = [channel.name for channel in positions.channels]
    coordinates = [coordinate.name for coordinate in positions.coordinates]
    for name in request.drives:
        if name not in channels:
            words = unknown_name("coordinate or sensor of positions", name, channels)
            raise InputError(f"{argument('drives')}: {words}")
    for name in request.hold:
        if name not in coordinates:
            raise InputError(f"{argument('hold')}: {unknown_name('coordinate', name, coordinates)}")


def _drives(positions: Positions, request: Request) -> list[PathDrive]:
    units = {c.name: c.unit for c in positions.channels}
    found = []
    for name, text in request.drives.items():
        try:
            found.append(PathDrive(name, read_range(text).values(units[name])))
        except InputError as error:
            raise InputError(f"drive of '{name}': {error}") from None
    lengths = {len(drive.values) for drive in found if len(drive.values) > 1}
    if not request.together:
        return found
    if len(lengths) > 1:
        listed = ", ".join(str(length - 1) for length in sorted(lengths))
        raise InputError(f"drives that move together need the same number of steps, not {listed}")
    count = max(lengths, default=1)
    return [
        PathDrive(d.channel, d.values * count if len(d.values) == 1 else d.values) for d in found
    ]


class _Columns:
    """Columns of the result: channels, velocity ratios by drive, instant axes by drive."""

    def __init__(
        self, machine: Mechanism, wheels: Sequence[WheelColumns], sensors: Sequence[str]
    ) -> None:
        p = machine.positions
        self.machine, self.wheels = machine, wheels
        self.driven = [p.channels[k] for k in machine.drives]
        moving = {p.coordinates[k].name for k in machine.moving}
        coordinates = {c.name for c in p.coordinates}
        self.kept = [
            k
            for k, c in enumerate(p.channels)
            if c.name in moving or c.name not in coordinates or k in machine.drives
        ]
        self.axles = axle_columns(sensors, p.channels, p.speeds)
        self.swinging = list(wheels) if len(self.driven) == 2 else []
        first = len(p.channels)
        self.rated = [k for k in self.kept if k not in machine.drives]
        self.rated += range(first, first + len(p.speeds))
        everything = (*p.channels, *p.speeds)
        self.channels = (
            *(p.channels[k] for k in self.kept),
            *(ratio_channel(d, everything[k]) for d in self.driven for k in self.rated),
            *(c for d in self.driven for w in wheels for c in axis_channels(d.name, w)),
            *(c for w in self.swinging for c in swing_channels(w)),
            *(c for d in self.driven for c in self.axles.channels(d.name)),
        )

    def table(self, swept: Sweep) -> Array:
        """Return the values of all columns, shape (n_samples, n_columns)."""
        rows = []
        for sample in swept.samples:
            values, ratios = sample.values, sample.ratios
            axes = [x for r in ratios for w in self.wheels for x in axis_values(w, values, r)]
            swings = [x for w in self.swinging for x in swing_values(w, values, *ratios)]
            axles = [x for r in ratios for x in self.axles.values(values, r)]
            parts = (values[self.kept], ratios[:, self.rated].ravel(), axes, swings, axles)
            rows.append(np.concatenate(parts))
        return np.array(rows).reshape(len(rows), len(self.channels))

    def shown(self, patterns: Sequence[str]) -> tuple[int, ...]:
        """Return the columns that the table shows: drives first, then those that match."""
        names = [c.name for c in self.channels]
        first = [names.index(d.name) for d in self.driven]
        if patterns:
            for pattern in patterns:
                if not fnmatch.filter(names, pattern):
                    raise InputError(
                        f"{given('channels', pattern)}: matches no channel of this sweep"
                    )
            chosen = [
                k for k, n in enumerate(names) if any(fnmatch.fnmatchcase(n, p) for p in patterns)
            ]
            return tuple(dict.fromkeys([*first, *chosen]))
        coordinates = {c.name for c in self.machine.positions.coordinates}
        sensors = [k for k in range(len(self.kept)) if names[k] not in coordinates]
        others = [k for k in range(len(self.kept)) if names[k] in coordinates]
        return tuple(dict.fromkeys([*first, *sensors, *others]))[:_COLUMNS]

    def plots(self, table: Array) -> list[dict[str, Any]]:
        """Return figures of the channels that move, against the first drive that does."""
        spans = np.ptp(table, axis=0) if len(table) else np.zeros(len(self.channels))
        names = [c.name for c in self.channels]
        drive = next((d for d in self.driven if spans[names.index(d.name)] > _FLAT), None)
        if drive is None:
            return []
        parts: dict[str, list[Channel]] = {}
        for k in range(len(self.kept)):
            channel = self.channels[k]
            if spans[k] > _FLAT and channel.name != drive.name:
                parts.setdefault(channel.name.partition(".")[0], []).append(channel)
        parts |= self._axle_figure(drive, table)
        chunks = [
            (f"{part}_{number + 1}" if len(items) > _PANELS else part, items[at : at + _PANELS])
            for part, items in parts.items()
            for number, at in enumerate(range(0, len(items), _PANELS))
        ]
        return [_figure(name, items, drive) for name, items in chunks[:_MOST_FIGURES]]

    def _axle_figure(self, drive: Channel, table: Array) -> dict[str, list[Channel]]:
        """Return the figure of the roll centres and motion ratios that change along a drive."""
        wanted = {c.name for c in self.axles.channels(drive.name)}
        places = [k for k, c in enumerate(self.channels) if c.name in wanted]
        known = [self.channels[k] for k in places if _changes(table[:, k])]
        return {"roll_centre_and_motion_ratio": known} if known else {}


def ratio_channel(drive: Channel, channel: Channel) -> Channel:
    """Return the channel of a velocity ratio; a velocity by the drive's rate is one, too."""
    unit = channel.unit.removesuffix("/s") if channel.unit.endswith("/s") else channel.unit
    shared = "1" if unit == drive.unit else f"{unit}/{drive.unit}"
    words = f"Change of {channel.name} a unit of {drive.name}"
    return Channel(f"ratio.{drive.name}.{channel.name}", shared, words, channel.frame)


def _changes(column: Array) -> bool:
    known = column[np.isfinite(column)]
    return bool(known.size and np.ptp(known) > _FLAT)


_FAMILIES = {"roll_centre": "Roll centre height", "motion_ratio": "Motion ratio"}
_LONGEST_LABEL = 28
"""Letters of an axis's label that fit beside a panel."""


def _label(channel: Channel) -> str:
    """Return how a panel names a channel: its meaning where it is short, else its last word."""
    family, _, rest = channel.name.partition(".")
    if family in _FAMILIES:
        return f"{_FAMILIES[family]},\n{rest.rpartition('.')[2]}"
    if channel.description and len(channel.description) <= _LONGEST_LABEL:
        return channel.description
    return channel.name.rpartition(".")[2].replace("_", " ").capitalize()


def _figure(name: str, channels: Sequence[Channel], drive: Channel) -> dict[str, Any]:
    panels = [
        {
            "label": _label(c),
            "unit": SHOWN.get(c.unit, (c.unit, 1.0))[0],
            "channels": [c.name],
        }
        for c in channels
    ]
    return {
        "name": name,
        "kind": "time",
        "title": f"{name.replace('_', ' ').capitalize()} against {drive.name}",
        "x": drive.name,
        "x_unit": SHOWN.get(drive.unit, (drive.unit, 1.0))[0],
        "panels": panels,
    }


@dataclass(frozen=True)
class _Files:
    """What a sweep is written to, and what it is of."""

    target: Target
    model: str
    output: Path
    notes: list[str]

    def write(self, book: _Columns, swept: Sweep, shown: tuple[int, ...]) -> KinematicsReport:
        """Write the result; return the report."""
        table = book.table(swept)
        status, message = _ending(swept)
        plots = book.plots(table)
        with ResultWriter(
            self.output,
            channels=book.channels,
            header=self._header(plots),
            expected_samples=max(1, len(table)),
        ) as writer:
            writer.append(np.arange(len(table), dtype=float), table)
            writer.close(status, message, summary=list(_summary(book, swept)), notes=self.notes)
        messages = [*self.notes, *(f.words for f in swept.failures)]
        if message:
            messages.append(f"{status}; the partial result is kept in {self.output}")
        return KinematicsReport(
            self.model,
            self.output,
            status,
            book.machine.held,
            book.channels,
            table,
            shown,
            tuple(swept.singular),
            tuple(swept.failures),
            messages,
        )

    def _header(self, plots: list[dict[str, Any]]) -> ResultHeader:
        axis = SampleAxis("1", "Number of the place")
        if self.target.choices is None:
            title = f"Kinematics of {self.model}"
            return ResultHeader(title=title, model=self.model, plots=plots, axis=axis)
        return ResultHeader(
            title=f"Kinematics: {self.target.title}",
            model=self.model,
            scenario_text=self.target.text,
            configuration=dict(self.target.resolved),
            plots=plots,
            axis=axis,
        )


def _ending(swept: Sweep) -> tuple[str, str]:
    """Return status and what went wrong."""
    if swept.is_interrupted:
        return "interrupted", "stopped by the user"
    if swept.failures:
        return "failed", "; ".join(f.words for f in swept.failures)
    return "ok", ""


def _summary(book: _Columns, swept: Sweep) -> Iterator[SummaryEntry]:
    yield SummaryEntry("places", len(swept.samples), "1", "Places reached")
    gaps = [
        np.abs(book.machine.positions.residual(s.coordinates)).max(initial=0.0)
        for s in swept.samples
    ]
    yield SummaryEntry(
        "largest_loop_gap",
        float(max(gaps, default=0.0)),
        "m",
        "Largest position error of a constraint",
    )
    for number, finding in enumerate(swept.singular, 1):
        yield SummaryEntry(f"singular_{number}", finding.words, "", "Singular place")
    for number, finding in enumerate(swept.failures, 1):
        yield SummaryEntry(f"failure_{number}", finding.words, "", "Not to be reached")
    for name in book.machine.held:
        yield SummaryEntry(f"held.{name}", True, "", f"{name} stays at its start")
