"""One run from scenario to result file: the whole pipeline on one page."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.mass_checks import constraint_notes, nearly_singular_mass
from vehicledyn.analyses.preparation.model_hash import model_hash
from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.analyses.preparation.sources import sources_of
from vehicledyn.analyses.preparation.validity.bent_beams import BentBeams
from vehicledyn.analyses.preparation.validity.rounded_kinks import rounded_kinks
from vehicledyn.analyses.simulation.animation_recorder import Recorder, surroundings_of
from vehicledyn.analyses.simulation.chosen_step import leaves_step, with_step
from vehicledyn.analyses.simulation.judgement import judged_by
from vehicledyn.analyses.simulation.jumps_in_steps import jumps_in_steps
from vehicledyn.analyses.simulation.kinked_drives import kinked_drives
from vehicledyn.analyses.simulation.lost_control import STATUS, lost_control
from vehicledyn.analyses.simulation.moved_starts import moved_starts
from vehicledyn.analyses.simulation.open_contacts import unsteady_contacts
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.analyses.simulation.partitions.run_notes import most_noted
from vehicledyn.analyses.simulation.partitions.singular_turns import SingularTurns
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.analyses.simulation.restart import SINGULAR_ANGLES, Restart, open_restart
from vehicledyn.analyses.simulation.run_outcome import RunOutcome, kernel_message, shown_entry
from vehicledyn.analyses.simulation.run_recording import RunRecording
from vehicledyn.analyses.simulation.run_remarks import run_remarks
from vehicledyn.analyses.simulation.standing_wheels import CreepingWheels, standing_wheels
from vehicledyn.analyses.simulation.track_positions import track_place
from vehicledyn.analyses.simulation.undamped_constraints import undamped_constraints
from vehicledyn.analyses.simulation.wanted_outputs import (
    check_run,
    needed_channels,
    written_channels,
)
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.units import shown
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.integrate.course import RunHistory, most_numbers
from vehicledyn.integrate.task import Statistics
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.hdf5.output import check_output
from vehicledyn.results.store.history import History
from vehicledyn.results.store.layout import EventRecord, ResultHeader, SummaryEntry
from vehicledyn.results.store.writer import ResultWriter
from vehicledyn.symbolic.equations import Event

Matrix = NDArray[np.float64]

_DID = {
    "derailed": "left its rail",
    "lifted": "lifted off its rail",
    "overturned": "rolled over",
    "sunk": "went through the road",
}
_OF_WHEELS = ("derailed", "lifted")


def run_scenario(
    loaded: LoadedScenario,
    *,
    output: Path,
    backend: Backend,
    progress: Progress,
    restart: Path | None = None,
) -> RunOutcome:
    """Simulate a scenario and write its result file.

    Parameters
    ----------
    loaded
        The validated scenario.
    output
        Result file; it is checked before anything is computed.
    backend
        "auto", "compiled" or "interpreted".
    progress
        Called with what is going on and the part done.
    restart
        Result, partial or whole, of the same equations and parameters to go on from.

    Returns
    -------
    RunOutcome
        A failed or interrupted run keeps what it computed and says so in its status; so does one
        that ended by a derailment.

    Raises
    ------
    InputError
        If the scenario lacks a part that what it runs needs, the output cannot be written, or
        what is to be gone on from does not fit.
    NumericalError
        If the loops cannot be assembled or there is no equilibrium to start from.
    """
    check_output(output)
    prepared, start = prepare_run(
        loaded, backend=backend, progress=progress, check=partial(check_run, loaded)
    )
    kept, described = written_channels(loaded, prepared)
    recorder = None
    if loaded.scenario.output.animation:
        names = [channel.name for channel in prepared.equations.channels]
        recorder = Recorder.of(prepared.look, names, loaded.scenario.output.interval)
    solver = with_step(
        loaded.scenario.solver, prepared.kernel, start, loaded.scenario.output.interval
    )
    notes = constraint_notes(prepared)
    if leaves_step(loaded.scenario.solver):
        notes.append(f"step: {shown(solver.step, 's')}, chosen from the motion at the start")
    if loaded.scenario.start in (None, "nominal"):
        notes.extend(moved_starts(prepared, start))
    else:
        notes.extend(filter(None, [start.remark, *rounded_kinks(prepared, start)]))
    notes.extend([*standing_wheels(prepared, start), *unsteady_contacts(prepared, start)])
    notes.extend(kinked_drives(prepared.subject, loaded.scenario.duration))
    notes.extend(run_remarks(loaded, prepared))
    notes.extend(undamped_constraints(solver, prepared.equations))
    notes.extend(jumps_in_steps(prepared, solver, loaded.scenario.duration))
    turns = SingularTurns.of(prepared.subject.system, prepared.equations)
    needed = needed_channels(prepared)
    run = _Run(loaded, prepared, kept, needed, described, recorder, notes, turns, solver)
    with _opened(restart, loaded, prepared, kept) as known:
        run.simulate(start, output, progress, known)
    messages = [kernel_message(prepared), *notes, *run.messages]
    width = max([14, *(len(shown(e.value, e.unit)) for e in run.summary)])
    summary = {e.name: shown_entry(e, width) for e in run.summary}
    return RunOutcome(output, run.status, summary, messages)


@contextmanager
def _opened(
    path: Path | None, loaded: LoadedScenario, prepared: Prepared, kept: list[int]
) -> Iterator[Restart | None]:
    if path is None:
        yield None
        return
    names = [prepared.equations.channels[k].name for k in kept]
    known = open_restart(path, loaded, prepared, names, model_hash(prepared))
    with known.result:
        yield known


@dataclass
class _Run:
    """A simulation while it runs: writes samples and collects what the summary needs."""

    loaded: LoadedScenario
    prepared: Prepared
    kept: list[int]
    needed: list[int]
    plots: list[dict[str, Any]]
    recorder: Recorder | None
    notes: list[str]
    turns: SingularTurns
    solver: Any
    status: str = "ok"
    samples: int = 0
    messages: list[str] = field(default_factory=list)
    summary: list[SummaryEntry] = field(default_factory=list)
    events: list[EventRecord] = field(default_factory=list)
    _last: tuple[float, Matrix, Matrix] | None = None
    _repeated: list[EventRecord] = field(default_factory=list)

    def __post_init__(self) -> None:
        channels = self.prepared.equations.channels
        names, units = [c.name for c in channels], [c.unit for c in channels]
        self._recording = RunRecording(names, units, self.kept, self.needed)
        self._monitors = BentBeams.of(self.prepared), CreepingWheels.of(self.prepared)

    def simulate(
        self, start: AssembledPoint, output: Path, progress: Progress, known: Restart | None = None
    ) -> None:
        """Integrate and write the result; an error or Ctrl-C closes the file as partial."""
        s = self.loaded.scenario
        statistics: Statistics | None = None
        message = ""
        unwritten: InputError | None = None
        with self._writer(output, hidden=known is not None) as writer, closing(self._recording):
            try:
                if known is not None:
                    self._take_known(writer, known)
                statistics = simulate_monitored(
                    self.prepared.subject.system,
                    self.prepared.kernel,
                    self.solver,
                    start=0.0,
                    stop=s.duration,
                    state=start.state if known is None else known.state,
                    unknowns=start.unknowns if known is None else known.unknowns,
                    interval=s.output.interval,
                    sink=lambda t, x, z, y: self._take(writer, t, x, z, y),
                    progress=progress,
                    happened=lambda name, t: self._happened(writer, EventRecord(t, name)),
                    watch=lambda: self.prepared.watch,
                    judged=judged_by(self.prepared.subject, self.prepared.equations),
                    course=RunHistory(
                        lambda t, numbers: writer.note(History(t, numbers)),
                        None if known is None else known.beginning_for(self.prepared, self.kept),
                        writer.keep,
                    ),
                )
                if known is not None:
                    statistics = replace(statistics, accuracy=known.accuracy(statistics.accuracy))
                self._warn(statistics)
            except NumericalError as error:
                self.status = "failed"
                message = "; ".join(filter(None, (str(error), self._cause())))
            except KeyboardInterrupt:
                self.status = "interrupted"
                message = f"stopped by the user at t = {self._end():g} s"
            except InputError as error:
                self.status, message, unwritten = "failed", str(error), error
            ending = self._ending(statistics)
            self._summarise(writer)
            if self.status == "ok" and (lost := lost_control(self.summary)):
                self.status, ending = STATUS, lost
            self._leave(statistics)
            self._add_remarks()
            writer.close(
                self.status,
                message or ending,
                summary=self.summary,
                solver=self._solver(statistics),
                events=self.events,
                surroundings=surroundings_of(self.prepared, self.recorder),
                notes=self.notes,
            )
        if unwritten is not None:
            raise unwritten
        if ending:
            self.messages.append(ending)
        if message:
            self.messages.append(f"{message}; the partial result is kept in {output}")

    def _take_known(self, writer: ResultWriter, known: Restart) -> None:
        """Take over the samples and events of the result that is gone on from."""
        self.notes.append(known.remark)
        begun = known.beginning
        if begun.history is not None:  # a kill before the next sample must not lose it
            if begun.kept is not None:
                writer.keep(begun.kept)
            writer.note(History(begun.time, begun.history))
        for times, states, unknowns, outputs in known.blocks(self.prepared, self.kept):
            self._take(writer, times, states, unknowns, outputs)
        for event in known.events:
            self._happened(writer, event)
        # What was noted may be from just before what happened at the same time.
        self._repeated = [event for event in known.events if event.time == begun.time]
        writer.flush()
        writer.appear()

    def _happened(self, writer: ResultWriter, event: EventRecord) -> None:
        if event in self._repeated:
            return
        self.events.append(event)
        writer.happened(event)
        self._remark(event)

    def _remark(self, event: EventRecord) -> None:
        """Warn once of an event that a model does not end at but has advice for."""
        own = [e for e in self.prepared.equations.events if e.name == event.name]
        is_known = any(other.name == event.name for other in self.events[:-1])
        for found in () if is_known else own:
            if found.terminal or not found.advice:
                continue
            words = f"event '{event.name}' at t = {event.time:.9g} s: {found.advice}"
            self.notes.append(f"warning: {words}")

    def _writer(self, output: Path, *, hidden: bool) -> ResultWriter:
        e, s = self.prepared.equations, self.loaded.scenario
        header = ResultHeader(
            title=self.loaded.title,
            model=s.model,
            model_hash=model_hash(self.prepared),
            equations_hash=model_hash(self.prepared, parameters=False),
            parameters={p.name: (float(p.value), p.unit) for p in e.parameters},
            scenario_text=self.loaded.text,
            configuration={
                **self.loaded.resolved,
                "overrides": list(self.loaded.overrides),
                "units": self.loaded.units,
            },
            plots=self.plots,
            scene=self.prepared.subject.scene(),
            sources=sources_of(self.loaded),
        )
        return ResultWriter(
            output,
            channels=[e.channels[k] for k in self.kept],
            header=header,
            states=[*e.states, *e.unknowns],
            expected_samples=round(s.duration / s.output.interval) + 1,
            stage=None if self.recorder is None else self.recorder.stage,
            expected_pictures=0 if self.recorder is None else self.recorder.expected(s.duration),
            history=most_numbers(len(e.states), len(e.unknowns), len(e.events)) + most_noted(e),
            hidden=hidden,
        )

    def _take(self, writer: ResultWriter, t: Matrix, x: Matrix, z: Matrix, y: Matrix) -> None:
        # Collected first: an interrupt waits for the file, which then holds them too.
        self._recording.add(y)
        self.samples += len(t)
        self._last = (float(t[-1]), x[-1].copy(), z[-1].copy())
        self.turns.take(t, x, z)
        for monitor in self._monitors:
            monitor.take(t, y)
        if self.recorder is not None:
            writer.append_pictures(self.recorder.take(t, y))
        writer.append(t, y[:, self.kept], np.hstack([x, z]))

    def _add_remarks(self) -> None:
        """Note bodies with nearly singular angles, beams bent far and wheels that creep."""
        for monitor in (self.turns, *self._monitors):
            self.notes.extend(monitor.remarks())
        for item in self.turns.came_near():
            self.events.append(EventRecord(item.time, f"{item.body}.{SINGULAR_ANGLES}"))

    def _summarise(self, writer: ResultWriter) -> None:
        writer.flush()
        if writer.samples:
            self.summary = self.prepared.subject.summarise(self._recording.of(writer))

    def _warn(self, statistics: Statistics) -> None:
        """Say in the output and in the file where the step was too long."""
        accuracy = statistics.accuracy
        if accuracy is not None and accuracy.warning:
            self.notes.append(f"warning: {accuracy.warning}")

    def _cause(self) -> str:
        """Return what the last sample says about the cause of a failure, if anything."""
        return "" if self._last is None else nearly_singular_mass(self.prepared, *self._last)

    def _end(self) -> float:
        return 0.0 if self._last is None else self._last[0]

    def _ending(self, statistics: Statistics | None) -> str:
        """Return which event ended the run before its time, if one did."""
        if statistics is None or statistics.ended_by is None:
            return ""
        event = self._event(statistics.ended_by)
        at = f"at t = {self._end():.9g} s"
        place = self._place(event.name)
        if place is not None:
            at += f", {shown(place, 'm')} along the track"
        if event.outcome != "ok":
            return f"{event.outcome} {at}: {event.advice}; event '{event.name}'"
        ended = f"event '{event.name}' ended the run {at}"
        return f"{ended}: {event.advice}" if event.advice else ended

    def _leave(self, statistics: Statistics | None) -> None:
        """Take status and summary from a wheel whose leaving its rail ended the run."""
        if statistics is None or statistics.ended_by is None:
            return
        event = self._event(statistics.ended_by)
        if event.outcome == "ok":
            return
        self.status = event.outcome
        wheel, place = event.name.rpartition(".")[0], self._place(event.name)
        name, did = event.outcome, _DID[event.outcome]
        key, what = ("wheel", "Wheel") if name in _OF_WHEELS else ("body", "Vehicle by its body")
        self.summary.append(SummaryEntry(f"{name}_{key}", wheel, "", f"{what} that {did}"))
        self.summary.append(SummaryEntry(f"{name}_at_time", self._end(), "s", f"When it {did}"))
        if place is not None:
            text = f"Where on the track it {did}"
            self.summary.append(SummaryEntry(f"{name}_at_place", place, "m", text))

    def _event(self, name: str) -> Event:
        return next(event for event in self.prepared.equations.events if event.name == name)

    def _place(self, event: str) -> float | None:
        """Return where on its track the part of an event was last [m]."""
        return None if self._last is None else track_place(self.prepared, event, *self._last)

    def _solver(self, statistics: Statistics | None) -> dict[str, Any]:
        kernel = self.prepared.kernel
        known: dict[str, Any] = {
            "kernel": kernel.description,
            "operations": json.dumps(kernel.report.operations),
            "generation_seconds": kernel.report.generation_seconds,
            "compilation_seconds": kernel.report.compilation_seconds,
            "kernel_from_cache": kernel.report.cached,
        }
        if statistics is not None:
            values = {f.name: getattr(statistics, f.name) for f in fields(statistics)}
            accuracy = values.pop("accuracy")
            values |= {} if accuracy is None else accuracy.as_attributes()
            known.update({k: v for k, v in values.items() if v is not None})
        return known
