"""Compute some cases of a study: what a worker does, in this process or another."""

from __future__ import annotations

import contextlib
import functools
import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from vehicledyn.analyses.simulation.lost_control import lost_control
from vehicledyn.base.errors import InputError, VehicledynError
from vehicledyn.base.numbers.disk_array import disk_array
from vehicledyn.base.plugins import load_plugin, loaded_plugins, plugin_digest
from vehicledyn.base.version import FOLDER, VERSION
from vehicledyn.integrate.batch import Cases, Samples, run_batch
from vehicledyn.integrate.estimated_accuracy import Accuracy
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.store.study_layout import (
    ACCURACY,
    DONE,
    ENDED,
    LOST,
    StudyBlock,
    StudyFigure,
)
from vehicledyn.studies.axes import Design
from vehicledyn.studies.load import LoadedStudy
from vehicledyn.studies.model import Case, CaseModel, make_model
from vehicledyn.studies.recipe import Recipe

Tell: TypeAlias = Callable[[str, float | None], None]


@dataclass(frozen=True)
class Work:
    """All that is needed to compute any case of a study, to be sent to other processes.

    ``key`` is equal for equal work; ``program`` the fingerprint of the program that asks, with its
    ``plugins``.
    """

    key: str
    program: str
    recipe: Recipe
    design: Design
    patterns: tuple[str, ...] | None
    figures: bool
    single: bool
    duration: float
    interval: float
    lanes: int | None
    backend: Backend
    plugins: tuple[str, ...] = ()

    @property
    def n_samples(self) -> int:
        """Samples of a case that goes to its end."""
        return round(self.duration / self.interval) + 1


def work_of(study: LoadedStudy, *, lanes: int | None, backend: Backend) -> Work:
    """Return the work of a study."""
    output, base = study.study.output, study.base.scenario
    patterns = base.output.channels if output.channels is None else output.channels
    digests, plugins = study.digests, loaded_plugins()
    return Work(
        key="-".join([*digests.values(), str(lanes), backend]),
        program=program_of(plugins),
        plugins=plugins,
        recipe=study.recipe,
        design=study.design,
        patterns=patterns,
        figures=output.figures,
        single=output.precision == "single",
        duration=base.duration,
        interval=base.output.interval,
        lanes=lanes,
        backend=backend,
    )


def program_of(plugins: Sequence[str]) -> str:
    """Return a text that changes with the program's own code and with that of plugins."""
    own = program_fingerprint()
    if not plugins:
        return own
    contents = [plugin_digest(path) for path in plugins]
    return hashlib.sha256("".join([own, *contents]).encode()).hexdigest()


@functools.cache
def program_fingerprint() -> str:
    """Return a text that changes with the program's own code."""
    folder, digest = FOLDER, hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        if path.suffix in (".py", ".c", ".h", ".yaml"):
            digest.update(path.relative_to(folder).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


@dataclass
class Worker:
    """Computes cases, keeping the models it made."""

    work: Work
    tell: Tell
    folder: Path | None = None
    """Where samples are kept on the disk, None for in the memory."""
    models: dict[tuple[float, ...], CaseModel | VehicledynError] = field(default_factory=dict)

    def model(self, values: Sequence[float]) -> CaseModel:
        """Return the model for the choices among some values.

        Raises
        ------
        VehicledynError
            If it cannot be made; also every further time it is asked for.
        """
        axes = self.work.design.axes
        choices = tuple(v for a, v in zip(axes, values, strict=True) if a.is_choice)
        if choices not in self.models:
            try:
                self.models[choices] = self._make(values)
            except VehicledynError as error:
                self.models[choices] = error
        found = self.models[choices]
        if isinstance(found, VehicledynError):
            raise type(found)(str(found))
        return found

    def compute(self, first: int, stop: int) -> StudyBlock:
        """Return the cases ``first:stop``."""
        work = self.work
        values = work.design.cases(first, stop)
        block = StudyBlock(first, values)
        groups: dict[int, tuple[CaseModel, list[int], list[Case]]] = {}
        for number, row in enumerate(values.tolist()):
            name = f"case {first + number}"
            try:
                model = self.model(row)
                case = model.case(row, name)
            except VehicledynError as error:
                block.fail(number, 0.0, str(error))
                continue
            _, numbers, cases = groups.setdefault(id(model), (model, [], []))
            numbers.append(number)
            cases.append(case)
        for model, numbers, cases in groups.values():
            self._run(model, numbers, cases, block)
        return block

    def _make(self, values: Sequence[float]) -> CaseModel:
        work = self.work
        return make_model(
            work.recipe,
            values,
            patterns=work.patterns,
            figures=work.figures,
            lanes=work.lanes,
            backend=work.backend,
            progress=self.tell,
        )

    def _run(
        self, model: CaseModel, numbers: list[int], cases: list[Case], block: StudyBlock
    ) -> None:
        work = self.work
        try:
            result = run_batch(
                model.batch,
                model.solver,
                Cases(
                    np.array([case.parameters for case in cases]),
                    np.array([case.start.state for case in cases]),
                    np.array([case.start.unknowns for case in cases]),
                ),
                start=0.0,
                stop=work.duration,
                interval=work.interval,
                channels=model.columns,
                runner=model.run_monitored,
                rates=model.rates,
                judged=lambda number: model.judged(cases[number]),
                room=np.empty if self.folder is None else partial(disk_array, self.folder),
            )
        except VehicledynError as error:
            for number in numbers:
                block.fail(number, 0.0, str(error))
            return
        n_kept = len(model.kept)
        if self.folder is None:
            samples = block.room(len(result.times), n_kept, single=work.single)
        else:  # a single case, of which the file takes what it keeps
            block.samples = samples = result.samples[:, :, :n_kept]
        for row, (number, case, end) in enumerate(zip(numbers, cases, result.ends, strict=True)):
            if self.folder is None:
                samples[number] = _kept(result.samples[row], n_kept, work.single)
            if end.failed:
                block.fail(number, end.time, end.message)
                continue
            block.status[number] = ENDED if end.ended_by else DONE
            block.end_time[number] = end.time
            if end.ended_by:
                block.reasons[number] = f"event '{end.ended_by}' at t = {end.time:.9g} s"
            entries = []
            if model.needed and end.samples:
                reached = slice(0, end.samples)
                entries = model.figures(case, result.times[reached], result.samples[row][reached])
            if not end.ended_by and (lost := lost_control(entries)):
                block.status[number], block.reasons[number] = LOST, lost
            block.figures[number] = [
                StudyFigure(e.name, e.value, e.unit, e.description)
                for e in (entries if work.figures else ())
            ]
            if end.samples:
                reached = slice(0, end.samples)
                block.figures[number] += model.beam_figures(case, result.samples[row][reached])
            _note_accuracy(block, number, end.accuracy)


def _note_accuracy(block: StudyBlock, number: int, accuracy: Accuracy | None) -> None:
    """Add what the watch found to the figures of a case, and its warning to the reasons."""
    if accuracy is None:
        return
    found = [
        StudyFigure(ACCURACY, accuracy.verdict, "", "Verdict of the accuracy watch"),
        StudyFigure("estimated_error", accuracy.error, "1", "Error of the worst key figure"),
    ]
    if accuracy.step is not None:
        found.append(StudyFigure("recommended_step", accuracy.step, "s", "Step to take instead"))
    block.figures[number] += found
    if accuracy.warning:
        before = block.reasons.get(number)
        block.reasons[number] = "; ".join(filter(None, (before, accuracy.warning)))


def _kept(samples: Samples, count: int, single: bool) -> Samples:
    """Return the channels to keep; what is too large for 32 bits becomes infinite."""
    kept = samples[:, :count]
    if not single:
        return kept
    with np.errstate(over="ignore"):
        return kept.astype(np.float32)


_workers: dict[str, Worker] = {}


def compute_remotely(work: Work, first: int, stop: int) -> StudyBlock:
    """Return some cases, in a process that may have computed others of the same study before.

    Raises
    ------
    InputError
        If this process runs another version of the program.
    """
    return _worker_of(work).compute(first, stop)


def set_up(work: Work) -> None:
    """Make the model of the first case, so that it is there when cases come."""
    with contextlib.suppress(VehicledynError):
        worker = _worker_of(work)
        worker.model(work.design.cases(0, 1)[0].tolist())


def _worker_of(work: Work) -> Worker:
    import vehicledyn.catalogue  # noqa: F401

    worker = _workers.get(work.key)
    if worker is None:
        for path in work.plugins:
            load_plugin(path)
        if program_of(work.plugins) != work.program:
            raise InputError(
                f"a worker runs another vehicledyn ({VERSION}, in "
                f"{FOLDER}); install the same everywhere"
            )
        _workers.clear()
        worker = _workers[work.key] = Worker(work, _silent)
    return worker


def _silent(what: str, part: float | None) -> None:
    """Show nothing."""


def facts_of(work: Work, tell: Tell) -> tuple[Worker, Any]:
    """Return a worker that has made the model of the first case, and that model.

    Raises
    ------
    VehicledynError
        If no model can be made: then no case could run.
    """
    worker = Worker(work, tell)
    return worker, worker.model(work.design.cases(0, 1)[0].tolist())
