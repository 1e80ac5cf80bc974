"""The verb "inverse": the forces that a prescribed motion needs, as result file and figures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.mechanism.inverse import channel_rows
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.model_hash import model_facts
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.preparation.prescribed_motion import LawMotion, Motion, read_table
from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.units import shown
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.files.system.read import SystemModel
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Backend, compile_kernel
from vehicledyn.multibody.equations.inverse_dynamics import (
    PRESCRIBED,
    InverseDynamics,
    derive_inverse,
)
from vehicledyn.multibody.model.system import System
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.hdf5.output import check_output
from vehicledyn.results.store.layout import ResultHeader, SummaryEntry
from vehicledyn.results.store.writer import ResultWriter
from vehicledyn.symbolic.equations import Channel

Array = NDArray[np.float64]
_CHUNK = 256
_MOST_SAMPLES = 1_000_000
_LINES = 6
_SHOWN_IN = {"rad": "deg", "rad/s": "deg/s"}


@dataclass
class InverseReport:
    """Results of inverse dynamics: the largest forces and powers, the work of each drive."""

    path: Path
    status: str = "ok"
    samples: int = 0
    summary: list[SummaryEntry] = field(default_factory=list)
    messages: list[str] = field(default_factory=list)

    def as_text(self) -> str:
        """Return the key figures as lines."""
        width = max((len(entry.name) for entry in self.summary), default=0)
        lines = [
            f"  {e.name:{width}}  {shown(e.value, e.unit):<14} {e.description}"
            for e in self.summary
        ]
        return "\n".join([f"{self.path}: {self.status}, {self.samples} samples", *lines])

    def as_dict(self) -> dict[str, Any]:
        """Return the key figures as plain data, in SI."""
        return {
            "result": self.path,
            "status": self.status,
            "samples": self.samples,
            "summary": {e.name: {"value": e.value, "unit": e.unit} for e in self.summary},
            "messages": self.messages,
        }


def find_forces(
    loaded: LoadedScenario,
    *,
    table: Path | None,
    output: Path,
    backend: Backend,
    progress: Progress,
    kept: KeptWork | None = None,
) -> InverseReport:
    """Find the forces that the motion of a scenario needs; write the result file.

    The motion is that of the scenario's section "motion", or of a table; where all coordinates
    are driven by the system itself, none is needed. Times are those of the scenario's output.

    Parameters
    ----------
    loaded
        A scenario of a system file.
    table
        CSV or result file with the motion; None for the scenario's own.
    output
        Result file; it is checked before anything is computed.
    backend, progress
        As for a run.
    kept
        What is kept of it meanwhile.

    Raises
    ------
    InputError
        If the motion is missing, wrong, or not that of all degrees of freedom.
    NumericalError
        If the loops cannot be assembled at the start.
    """
    check_output(output)
    progress("deriving the inverse dynamics", None)
    system = build_subject(loaded).system
    s = loaded.scenario
    samples = round(s.duration / s.output.interval) + 1
    if samples > _MOST_SAMPLES:
        raise InputError(
            f"output.interval: {s.output.interval:g} s gives {samples} samples, and forces of at "
            f"most {_MOST_SAMPLES} are found at once; take a longer one or a shorter duration",
            about=["output.interval"],
        )
    times = np.linspace(0.0, s.duration, samples)
    motion, inverse = _prepared(loaded, system, table)
    tables = motion.at(times) if motion is not None else _no_motion(len(times))
    kernel = compile_kernel(inverse.equations, backend=backend, progress=progress)
    book = _Columns.of(inverse)
    report = InverseReport(output)
    facts = model_facts(inverse.equations, kernel.parameters)
    memory = (kept or KeptWork()).memory("inverse", facts, kernel.backend, times, tables)
    found: list[Array] = []
    unknowns: Array | None = None
    with ResultWriter(
        output,
        channels=book.channels,
        header=_header(loaded, system, book),
        expected_samples=len(times),
    ) as writer:
        message = ""
        try:
            for first in range(0, len(times), _CHUNK):
                part = slice(first, first + _CHUNK)
                given = times[part], [table[part] for table in tables], unknowns
                rows, unknowns, message = memory.recall(
                    "rows", (first, unknowns), partial(_rows, inverse, kernel, *given)
                )
                found += [book.complete(row) for row in rows]
                if len(found) > first:
                    writer.append(times[first : len(found)], np.array(found[first:]))
                progress("finding the forces", len(found) / len(times))
                if message:
                    raise NumericalError(message)
        except NumericalError as error:
            report.status, message = "failed", str(error)
        except KeyboardInterrupt:
            report.status, message = "interrupted", "stopped by the user"
        report.samples = len(found)
        if found:
            report.summary = list(book.summary(times[: len(found)], np.array(found)))
        writer.close(report.status, message, summary=report.summary)
    if message:
        report.messages.append(f"{message}; the partial result is kept in {output}")
    return report


def _rows(
    inverse: InverseDynamics,
    kernel: Kernel,
    times: Array,
    tables: list[Array],
    unknowns: Array | None,
) -> tuple[list[Array], Array | None, str]:
    """Return the channels at some times, the last unknowns, and why there are no more."""
    rows: list[Array] = []
    try:
        for row, known in channel_rows(inverse, kernel, times, tables, unknowns):
            rows.append(row)
            unknowns = known
    except NumericalError as error:
        return rows, unknowns, str(error)
    return rows, unknowns, ""


def _prepared(
    loaded: LoadedScenario, system: System, table: Path | None
) -> tuple[Motion | None, InverseDynamics]:
    """Return the motion and the inverse dynamics it goes with."""
    given, written = loaded.scenario.motion, loaded.written
    if table is None and isinstance(given, str):
        table = loaded.path.parent / given
    motion: Motion | None = None
    if table is not None:
        wanted = derive_inverse(system).coordinates
        motion = read_table(table, system, wanted)
    elif written.motion:
        motion = LawMotion(cast(SystemModel, written), written.motion)
    try:
        inverse = derive_inverse(system, motion.coordinates if motion is not None else None)
    except InputError as error:
        raise InputError(f"{table or loaded.path}: motion: {error}") from None
    if motion is None and inverse.coordinates:
        listed = ", ".join(inverse.coordinates)
        raise InputError(
            f"{loaded.path}: motion: missing: say how {listed} move, by laws or expressions of "
            f"time, or give a table as {argument('motion')}"
        )
    return motion, inverse


def _no_motion(n_times: int) -> tuple[Array, Array, Array]:
    return tuple(np.zeros((n_times, 0)) for _ in range(3))  # type: ignore[return-value]


@dataclass(frozen=True)
class _Columns:
    """Channels of the result: those of the equations and the power of each drive."""

    channels: tuple[Channel, ...]
    kept: tuple[int, ...]
    forces: tuple[tuple[int, int], ...]
    coordinates: tuple[str, ...]

    @classmethod
    def of(cls, inverse: InverseDynamics) -> _Columns:
        """Return the channels; states of the prescribed motion are left out."""
        everything = inverse.equations.channels
        kept = tuple(k for k, c in enumerate(everything) if not c.name.startswith(PRESCRIBED))
        own = [everything[k] for k in kept]
        index = {c.name: k for k, c in enumerate(own)}
        driven = inverse.equations.structure["driven"]
        pairs = {
            n: (index[f"{n}_force"], index[f"{n}_rate"]) for n in driven if f"{n}_force" in index
        }
        powers = [Channel(f"{n}_power", "W", f"Power of the drive of {n}", "joint") for n in pairs]
        return cls((*own, *powers), kept, tuple(pairs.values()), tuple(pairs))

    def complete(self, row: Array) -> Array:
        """Return a row of the channels kept, with the powers."""
        row = row[list(self.kept)]
        return np.concatenate([row, [row[force] * row[rate] for force, rate in self.forces]])

    def summary(self, times: Array, table: Array) -> Iterator[SummaryEntry]:
        """Yield the largest force and power of each drive, and its work."""
        first = len(self.channels) - len(self.forces)
        for k, name in enumerate(self.coordinates):
            force, power = table[:, self.forces[k][0]], table[:, first + k]
            unit = self.channels[self.forces[k][0]].unit
            text = f"drive of {name}"
            yield SummaryEntry(
                f"{name}.force", float(np.abs(force).max()), unit, f"Largest force, {text}"
            )
            yield SummaryEntry(
                f"{name}.power", float(np.abs(power).max()), "W", f"Largest power, {text}"
            )
            work = float(np.trapezoid(power, times)) if len(times) > 1 else 0.0
            yield SummaryEntry(
                f"{name}.work", work, "J", f"Work, {text}, as far as the samples tell"
            )

    def plots(self) -> list[dict[str, Any]]:
        """Return figures of motion, forces and power of the drives."""
        names = list(self.coordinates)
        units = {c.name: c.unit for c in self.channels}
        wanted = {
            "motion": ("Prescribed motion", "Coordinate", names),
            "rates": ("Rates of the prescribed motion", "Rate", [f"{n}_rate" for n in names]),
            "forces": ("Forces of the drives", "Force", [f"{n}_force" for n in names]),
            "power": ("Power of the drives", "Power", [f"{n}_power" for n in names]),
        }
        return [
            {"name": key, "title": title, "kind": "time", "panels": panels}
            for key, (title, label, channels) in wanted.items()
            if (panels := list(_panels(label, channels, units)))
        ]


def _panels(label: str, channels: list[str], units: dict[str, str]) -> Iterator[dict[str, Any]]:
    for unit in dict.fromkeys(units[name] for name in channels):
        lines = [name for name in channels if units[name] == unit][:_LINES]
        yield {"label": label, "unit": _SHOWN_IN.get(unit, unit), "channels": lines}


def _header(loaded: LoadedScenario, system: System, book: _Columns) -> ResultHeader:
    return ResultHeader(
        title=f"Inverse dynamics: {loaded.title}",
        model=system.name,
        scenario_text=loaded.text,
        configuration=dict(loaded.resolved),
        plots=book.plots(),
    )
