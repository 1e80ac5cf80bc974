"""The verb "inverse": the forces that a prescribed motion needs, as result file and figures."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.mechanism.drive_columns import DriveColumns
from vehicledyn.analyses.mechanism.inverse import channel_rows
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.model_hash import model_facts
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.preparation.prescribed_motion import LawMotion, MotionRequest, read_table
from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.units import shown
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.files.system.read import SystemModel
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Backend, compile_kernel
from vehicledyn.multibody.equations.inverse_dynamics import InverseDynamics, derive_inverse
from vehicledyn.multibody.model.system import System
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.hdf5.output import check_output
from vehicledyn.results.store.layout import ResultHeader, SummaryEntry
from vehicledyn.results.store.writer import ResultWriter

Array = NDArray[np.float64]
_CHUNK = 256
_MOST_SAMPLES = 1_000_000


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
    times = sample_times(loaded)
    motion, inverse = prepared_motion(loaded, system, table)
    tables = motion.at(times) if motion is not None else no_motion(len(times))
    kernel = compile_kernel(inverse.equations, backend=backend, progress=progress)
    book = DriveColumns.of(inverse)
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


def sample_times(loaded: LoadedScenario) -> Array:
    """Return the times at which forces are found, those of the scenario's output [s].

    Raises
    ------
    InputError
        If there are too many.
    """
    s = loaded.scenario
    samples = round(s.duration / s.output.interval) + 1
    if samples > _MOST_SAMPLES:
        raise InputError(
            f"output.interval: {s.output.interval:g} s gives {samples} samples, and forces of at "
            f"most {_MOST_SAMPLES} are found at once; take a longer one or a shorter duration",
            about=["output.interval"],
        )
    return np.linspace(0.0, s.duration, samples)


def prepared_motion(
    loaded: LoadedScenario, system: System, table: Path | None
) -> tuple[MotionRequest | None, InverseDynamics]:
    """Return the motion of a scenario or table and the inverse dynamics it goes with.

    There is no motion where the system itself drives all coordinates.

    Raises
    ------
    InputError
        If the motion is missing, wrong, or not that of all degrees of freedom.
    """
    given, written = loaded.scenario.motion, loaded.written
    if table is None and isinstance(given, str):
        table = loaded.path.parent / given
    motion: MotionRequest | None = None
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


def no_motion(n_times: int) -> tuple[Array, Array, Array]:
    """Return positions, rates and accelerations of no coordinate at some times."""
    return tuple(np.zeros((n_times, 0)) for _ in range(3))  # type: ignore[return-value]


def _header(loaded: LoadedScenario, system: System, book: DriveColumns) -> ResultHeader:
    return ResultHeader(
        title=f"Inverse dynamics: {loaded.title}",
        model=system.name,
        scenario_text=loaded.text,
        configuration=dict(loaded.resolved),
        plots=book.plots(),
    )
