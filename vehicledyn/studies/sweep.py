"""Compute all cases of a study, keep them in one file, go on where a sweep stopped."""

from __future__ import annotations

import contextlib
import json
import shutil
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.base.argument_names import argument, given
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.processors import cores
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.hdf5.output import check_output, write_failed
from vehicledyn.results.store.study_layout import (
    ACCURACY,
    FAILED,
    INTERRUPTED,
    OK,
    PENDING,
    STOPPED,
    StudyAxis,
    StudyBlock,
    StudyChannel,
    StudyHeader,
)
from vehicledyn.results.store.study_reader import StudyFile, open_study
from vehicledyn.results.store.study_writer import StudyWriter, pending
from vehicledyn.studies import pool
from vehicledyn.studies.block import Work, facts_of, work_of
from vehicledyn.studies.case_beams import beam_warnings
from vehicledyn.studies.cluster import ClusterAddress, open_cluster
from vehicledyn.studies.load import LoadedStudy
from vehicledyn.studies.model import CaseModel
from vehicledyn.studies.processes import own_processes

MOST_SHOWN = 20
"""Failed cases that are printed."""

_CHUNK_BYTES = 1_000_000
_BLOCK_BYTES = 48_000_000
_LARGEST_CHUNK, _LARGEST_BLOCK, _GROUP = 512, 2048, 8
_CHUNKS = 64
"""Chunks of a file at least, where there are cases enough for lanes in each."""

_MOST_BYTES = 256_000_000
"""Samples of a block in memory at most, where it has more than one case."""

LARGEST_CASE = 1_000_000_000
"""Samples of a case in memory at most: a worker holds them until its figures are found [B]."""

_MOST_SAMPLES = 20_000_000
"""Samples of a case at most: some channels of them are held in memory at once, below 1 GB."""

MOST_A_CORE = 8
"""Processes a core at most: thousands of them, asked for in a file, would fill the memory."""

_SHARE = 8
"""Blocks that a worker gets at least, so that none waits long for the last."""


@dataclass(frozen=True)
class SweepOutcome:
    """Outcome of a sweep: the file, how many cases ended how, the first failures."""

    path: Path
    status: str
    counts: dict[str, int]
    failures: list[tuple[int, float, str]]
    seconds: float
    messages: list[str] = field(default_factory=list)

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks and warnings."""
        return tuple(self.messages)

    def as_dict(self) -> dict[str, Any]:
        """Return plain data."""
        return {
            "result": self.path,
            "status": self.status,
            "cases": self.counts,
            "failures": [
                {"case": case, "time": time, "reason": reason}
                for case, time, reason in self.failures
            ],
            "seconds": self.seconds,
            "messages": self.messages,
        }

    def as_text(self) -> str:
        """Return lines for a person."""
        listed = [f"{number} {name}" for name, number in self.counts.items() if number]
        lines = [f"{self.path}: {self.status}", f"  cases  {', '.join(listed)}"]
        for case, _, reason in self.failures:
            lines.append(f"  case {case}: {reason}")
        hidden = self.counts["failed"] - len(self.failures)
        return "\n".join([*lines, *([f"  and {hidden} more failed"] if hidden > 0 else [])])


def run_study(
    study: LoadedStudy,
    *,
    output: Path,
    workers: int | None,
    lanes: int | None,
    resume: bool,
    backend: Backend,
    progress: Progress,
    cluster: ClusterAddress | None = None,
    overwrite: bool = False,
) -> SweepOutcome:
    """Compute the cases of a study that are not in its file yet.

    Parameters
    ----------
    study
        The validated study.
    output
        Result file.
    workers
        Processes; None for what the study says, else one a core.
    lanes
        Cases side by side in each process; None for what the study says or the processor can.
    resume
        Go on with the file if it exists.
    backend
        "auto", "compiled" or "interpreted".
    progress
        Called with what is going on and the part done.
    cluster
        The Dask scheduler whose workers compute instead of processes on this machine.
    overwrite
        Begin anew and replace the file if it exists; not with ``resume``.

    Returns
    -------
    SweepOutcome
        A stopped or interrupted study keeps what it computed and says so.

    Raises
    ------
    InputError
        If the output cannot be used or no case could run.
    NumericalError
        If the equations cannot be set up.
    MissingPartError
        If a cluster is asked for and Dask is not installed.
    """
    started = time.monotonic()
    _refuse_output(output, may_exist=resume or overwrite)
    if workers is not None and workers < 1:
        raise InputError(f"{given('workers', workers)}: give 1 or more, or None for one a core")
    work = work_of(study, lanes=study.study.lanes if lanes is None else lanes, backend=backend)
    with contextlib.ExitStack() as stack:
        helpers = _helpers(stack, work, workers or study.study.workers, cluster, progress)
        worker, model = facts_of(work, progress)
        if _is_on_disk(output, work, len(model.columns), on_cluster=cluster is not None):
            worker.folder, helpers = output.resolve().parent, None
            progress("computing one case at a time, on the disk", None)
        computing = helpers or pool.SingleProcess(worker)
        header = _header(study, work, model)
        spool = 0 if worker.folder is None else _case_bytes(work, len(model.columns))
        _refuse_size(output, header, spool)
        writer = stack.enter_context(
            StudyWriter(output, header, resume=resume, overwrite=overwrite)
        )
        most = _MOST_BYTES // _case_bytes(work, len(model.columns))
        run = _Run(work, header, writer, progress, max(1, computing.workers()), max(1, most))
        run.compute(computing)
    with open_study(output) as file:
        counts, failures = file.counts(), list(file.reasons(MOST_SHOWN))
        warned = _warned(file)
    seconds = time.monotonic() - started
    summary = f"{run.computed} cases computed by {computing.description} in {seconds:.1f} s"
    messages = [*run.messages, *warned, *computing.remarks(), summary]
    return SweepOutcome(output, run.status, counts, failures, seconds, messages)


@dataclass
class _Run:
    """The work on one file while it lasts."""

    work: Work
    header: StudyHeader
    writer: StudyWriter
    progress: Progress
    workers: int
    most: int
    status: str = OK
    messages: list[str] = field(default_factory=list)
    computed: int = 0
    _done: int = 0
    _failed: int = 0

    def compute(self, workers: pool.Pool) -> None:
        """Compute what is pending; close the file whatever happens."""
        status = self.writer.status
        total = len(status)
        self._done = total - int((status == PENDING).sum())
        self._failed = int((status == FAILED).sum())
        message = ""
        try:
            self._show()
            workers.compute(pending(status, self.header.chunk, self._span()), self._take)
        except KeyboardInterrupt:
            self.status, message = INTERRUPTED, "stopped by the user"
        except NumericalError as error:
            self.status, message = STOPPED, str(error)
        except InputError as error:
            self.writer.close(STOPPED, str(error))
            raise
        except OSError as error:
            failed = write_failed(self.writer.path, error)
            self.writer.close(STOPPED, str(failed))
            raise failed from error
        if message:
            done = total - int((self.writer.status == PENDING).sum())
            self.messages.append(
                f"{message}; {done} of {total} cases are kept in {self.writer.path.name}, "
                f"continue with {argument('resume')}"
            )
        self.writer.close(self.status, message)

    def _take(self, block: StudyBlock) -> None:
        self.writer.write(block)
        self.computed += len(block)
        self._done += len(block)
        self._failed += int((block.status == FAILED).sum())
        self._show()

    def _span(self) -> int:
        """Return the most cases of a block: enough for lanes, few enough for memory and sharing."""
        numbers = self.work.n_samples * max(1, len(self.header.channels) + 20)
        by_memory = _BLOCK_BYTES // (8 * numbers)
        by_share = self.header.n_cases // (_SHARE * max(1, self.workers))
        size = min(by_memory, by_share, _LARGEST_BLOCK)
        return min(max(_GROUP, size // _GROUP * _GROUP), self.most)

    def _show(self) -> None:
        total = self.header.n_cases
        failed = f", {self._failed} failed" if self._failed else ""
        self.progress(f"computing: {self._done} of {total} cases{failed}", self._done / total)


def _warned(file: StudyFile) -> list[str]:
    """Return warnings about cases whose step is too long, or whose beams bend or yield wrongly."""
    warnings = []
    if ACCURACY in file.figures:
        texts = file.figure_texts(ACCURACY)
        found = [k for k, text in enumerate(texts) if text == "inaccurate"]
        if found:
            warnings.append(
                f"warning: the step is too long in {_cases(file, found)}; the figures "
                "'estimated_error' and 'recommended_step' say how much and what to take"
            )
    return warnings + beam_warnings(file, lambda found: _cases(file, found))


def _cases(file: StudyFile, found: list[int]) -> str:
    shown = ", ".join(map(str, found[:MOST_SHOWN])) + (", ..." if len(found) > MOST_SHOWN else "")
    return f"{len(found)} of {file.n_cases} cases ({shown})"


def _helpers(
    stack: contextlib.ExitStack,
    work: Work,
    workers: int | None,
    cluster: ClusterAddress | None,
    progress: Progress,
) -> pool.Pool | None:
    """Return who computes in place of this process, if anybody; they start at once."""
    if cluster is not None:
        progress("connecting to the cluster", None)
        workers_there = stack.enter_context(open_cluster(work, cluster))
        workers_there.warm_up()
        return workers_there
    count = min(workers or cores(), work.design.count, MOST_A_CORE * cores())
    if count == 1 or _must_stay(work, workers):
        return None
    progress("starting the processes", None)
    return stack.enter_context(own_processes(work, count))


def _must_stay(work: Work, workers: int | None) -> bool:
    """Return whether the model, built in Python, cannot go to other processes.

    Raises
    ------
    InputError
        If several were asked for.
    """
    built = work.recipe.built
    obstacle = "" if built is None else built.obstacle()
    if built is None or not obstacle:
        return False
    if workers is not None:
        raise InputError(
            f"{given('workers', workers)}: system '{built.model.name}' cannot leave this process: "
            f"{obstacle}; define them in a plugin, or ask for one worker"
        )
    return True


def _refuse_output(output: Path, *, may_exist: bool) -> None:
    check_output(output)
    if output.exists() and not may_exist:
        raise InputError(
            f"{output}: exists; go on with it by {argument('resume')}, or choose another output"
        )


def _header(study: LoadedStudy, work: Work, model: CaseModel) -> StudyHeader:
    axes = [
        StudyAxis(a.key, a.unit, tuple(json.dumps(choice) for choice in a.choices))
        for a in work.design.axes
    ]
    channels = [StudyChannel(c.name, c.unit, c.description) for c in model.channels]
    interval, n_samples = work.interval, work.n_samples
    case_bytes = n_samples * max(1, len(channels)) * (4 if work.single else 8)
    by_share = max(_GROUP, work.design.count // _CHUNKS)
    chunk = min(work.design.count, _LARGEST_CHUNK, by_share, max(1, _CHUNK_BYTES // case_bytes))
    return StudyHeader(
        title=study.study.title,
        n_cases=work.design.count,
        times=interval * np.arange(n_samples, dtype=float),
        channels=channels,
        axes=axes,
        chunk=chunk if chunk < _GROUP else chunk // _GROUP * _GROUP,
        single=work.single,
        study_text=study.text,
        scenario_text=study.base.text,
        digests={**study.digests, "program": work.program},
        configuration=study.base.resolved,
    )


def _case_bytes(work: Work, columns: int) -> int:
    """Return what the samples of a case need in memory, of all channels that are computed [B]."""
    return 8 * work.n_samples * max(1, columns)


def _is_on_disk(output: Path, work: Work, columns: int, *, on_cluster: bool) -> bool:
    """Return whether a case is too long for the memory, so that it is kept on the disk.

    Raises
    ------
    InputError
        If other machines were to compute it, or it has too many samples.
    """
    needed = _case_bytes(work, columns)
    if needed <= LARGEST_CASE:
        return False
    if on_cluster or work.n_samples > _MOST_SAMPLES:
        raise InputError(
            f"{output}: {work.n_samples} samples of {columns} channels need {_size(needed)} of "
            f"memory a case; at most {_size(LARGEST_CASE)} on a cluster and {_MOST_SAMPLES} "
            "samples here: give a longer 'output.interval', keep fewer channels and no figures, or "
            "run the cases by themselves"
        )
    return True


def _refuse_size(output: Path, header: StudyHeader, spool: int) -> None:
    """Raise InputError if the disk cannot hold the whole file, and so many bytes beside it."""
    folder = output.resolve().parent
    free = shutil.disk_usage(folder).free
    held = output.stat().st_size if output.exists() else 0
    needed = header.total_bytes + spool
    if needed > free + held:
        raise InputError(
            f"{output}: {header.n_cases} cases need about {_size(needed)}, {folder} "
            f"has {_size(free)} free; keep fewer channels, a longer interval or 'precision: single'"
        )


def _size(size: float) -> str:
    for unit in ("B", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.4g} TB"
