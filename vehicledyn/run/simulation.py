"""One run from scenario to result file: the whole pipeline on one page."""

from __future__ import annotations

import fnmatch
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, NumericalError, nearest_name, unknown_name
from vehicledyn.base.units import shown
from vehicledyn.manoeuvres.recording import Recording
from vehicledyn.results.layout import EventRecord, ResultHeader, SummaryEntry
from vehicledyn.results.output import check_folder, check_output
from vehicledyn.results.writer import ResultWriter
from vehicledyn.run.judgement import judged_by
from vehicledyn.run.moved_starts import moved_starts
from vehicledyn.run.pictures import Recorder, surroundings_of
from vehicledyn.run.places import wrong_output
from vehicledyn.run.prepare import Derived, Point, Prepared, Progress
from vehicledyn.run.rerun import prepare_run
from vehicledyn.run.resisted import (
    hardly_resisted,
    redundant_constraints,
)
from vehicledyn.run.singular_turns import SingularTurns
from vehicledyn.run.sources import sources_of
from vehicledyn.run.standing_wheels import standing_wheels
from vehicledyn.run.track_places import track_place
from vehicledyn.run.watched import simulate_watched
from vehicledyn.scenario import LoadedScenario
from vehicledyn.solve.kernel import Backend
from vehicledyn.solve.task import Statistics
from vehicledyn.symbolic.equations import Event

Matrix = NDArray[np.float64]
EXIT_OK, EXIT_NEGATIVE, EXIT_FAILED, EXIT_INTERRUPTED = 0, 1, 3, 130

_DID = {"derailed": "left its rail", "lifted": "lifted off its rail"}


@dataclass(frozen=True)
class ShownEntry:
    """A line of the summary: value in SI, unit, and the text a person reads."""

    value: float | int | bool | str
    unit: str
    text: str


@dataclass(frozen=True)
class RunOutcome:
    """What came of a run: the result file, how it ended, key figures, messages."""

    path: Path
    status: str
    exit_code: int
    summary: dict[str, ShownEntry]
    messages: list[str]


def run_scenario(
    loaded: LoadedScenario,
    *,
    output: Path,
    backend: Backend,
    plots: Path | None,
    progress: Progress,
) -> RunOutcome:
    """Simulate a scenario and write its result file and figures.

    Parameters
    ----------
    loaded
        The validated scenario.
    output
        Result file; it is checked before anything is computed.
    backend
        "auto", "compiled" or "interpreted".
    plots
        Folder for the figures, None for no figures.
    progress
        Told what is going on and the part done.

    Returns
    -------
    RunOutcome
        A failed or interrupted run keeps what it computed and says so in its status; so does one
        that ended by a derailment.

    Raises
    ------
    InputError
        If the scenario lacks a part that what it runs needs, or the output cannot be written.
    NumericalError
        If the loops cannot be assembled or there is no equilibrium to start from.
    """
    check_output(output)
    if plots is not None:
        check_folder(plots)
    prepared, start = prepare_run(
        loaded, backend=backend, progress=progress, check=partial(_written_channels, loaded)
    )
    kept, described = _written_channels(loaded, prepared)
    recorder = None
    if loaded.scenario.output.animation:
        names = [channel.name for channel in prepared.equations.channels]
        recorder = Recorder.of(prepared.look, names, loaded.scenario.output.interval)
    notes = redundant_constraints(prepared)
    if loaded.scenario.start in (None, "nominal"):
        notes.extend(moved_starts(prepared, start))
    notes.extend(standing_wheels(prepared, start))
    turns = SingularTurns.of(prepared.subject.system, prepared.equations)
    run = _Run(
        loaded, prepared, kept, _needed_channels(prepared), described, recorder, notes, turns
    )
    run.simulate(start, output, progress)
    messages = [_kernel_message(prepared), *notes, *run.messages]
    if plots is not None and run.samples and described:
        progress("drawing the figures", None)
        message, code = _draw(output, plots)
        messages.append(message)
        run.exit_code = run.exit_code or code
    return RunOutcome(
        output, run.status, run.exit_code, {e.name: _shown(e) for e in run.summary}, messages
    )


def _draw(output: Path, folder: Path) -> tuple[str, int]:
    """Draw the figures; return a message and exit code. A failure leaves the result whole."""
    from vehicledyn.results.plots import draw_plots

    try:
        return f"{len(draw_plots(output, folder))} figures in {folder}", EXIT_OK
    except KeyboardInterrupt:
        return f"stopped while drawing; the result {output} is whole", EXIT_INTERRUPTED
    except InputError as error:
        return f"the result {output} is whole, but not its figures: {error}", error.exit_code


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
    status: str = "ok"
    exit_code: int = EXIT_OK
    samples: int = 0
    messages: list[str] = field(default_factory=list)
    summary: list[SummaryEntry] = field(default_factory=list)
    events: list[EventRecord] = field(default_factory=list)
    _times: list[Matrix] = field(default_factory=list)
    _values: list[Matrix] = field(default_factory=list)
    _last: tuple[float, Matrix, Matrix] | None = None

    def simulate(self, start: Point, output: Path, progress: Progress) -> None:
        """Integrate and write the result; an error or Ctrl-C closes the file as partial."""
        s = self.loaded.scenario
        statistics: Statistics | None = None
        message = ""
        unwritten: InputError | None = None
        with self._writer(output) as writer:
            try:
                statistics = simulate_watched(
                    self.prepared.subject.system,
                    self.prepared.kernel,
                    s.solver,  # type: ignore[arg-type]
                    start=0.0,
                    stop=s.duration,
                    state=start.state,
                    unknowns=start.unknowns,
                    interval=s.output.interval,
                    sink=lambda t, x, z, y: self._take(writer, t, x, z, y),
                    progress=progress,
                    happened=lambda name, t: self.events.append(EventRecord(t, name)),
                    watch=lambda: self.prepared.watch,
                    judged=judged_by(self.prepared.subject, self.prepared.equations),
                )
                self._warn(statistics)
            except NumericalError as error:
                self.status, self.exit_code = "failed", EXIT_FAILED
                message = "; ".join(filter(None, (str(error), self._cause())))
            except KeyboardInterrupt:
                self.status, self.exit_code = "interrupted", EXIT_INTERRUPTED
                message = f"stopped by the user at t = {self._end():g} s"
            except InputError as error:
                self.status, message, unwritten = "failed", str(error), error
            ending = self._ending(statistics)
            self._summarise()
            self._leave(statistics)
            self._tell_of_turns()
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

    def _writer(self, output: Path) -> ResultWriter:
        e, s = self.prepared.equations, self.loaded.scenario
        header = ResultHeader(
            title=s.title,
            model=s.model,
            model_hash=_model_hash(self.prepared),
            equations_hash=_model_hash(self.prepared, parameters=False),
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
        )

    def _take(self, writer: ResultWriter, t: Matrix, x: Matrix, z: Matrix, y: Matrix) -> None:
        # Collected first: an interrupt waits for the file, which then holds them too.
        self._times.append(t.copy())
        self._values.append(y[:, self.needed].copy())
        self.samples += len(t)
        self._last = (float(t[-1]), x[-1].copy(), z[-1].copy())
        self.turns.take(t, x, z)
        if self.recorder is not None:
            writer.append_pictures(self.recorder.take(t, y))
        writer.append(t, y[:, self.kept], np.hstack([x, z]))

    def _tell_of_turns(self) -> None:
        """Note bodies whose angles came near to where they are singular."""
        self.notes.extend(self.turns.remarks())
        for item in self.turns.came_near():
            self.events.append(EventRecord(item.time, f"{item.body}.singular_angles"))

    def _summarise(self) -> None:
        if not self.samples:
            return
        values = np.vstack(self._values)
        needed = [self.prepared.equations.channels[k] for k in self.needed]
        columns = {channel.name: values[:, k] for k, channel in enumerate(needed)}
        units = {channel.name: channel.unit for channel in needed}
        recording = Recording(np.concatenate(self._times), columns, units)
        self.summary = self.prepared.subject.summarise(recording)

    def _warn(self, statistics: Statistics) -> None:
        """Say in the output and in the file where the step was too long."""
        accuracy = statistics.accuracy
        if accuracy is not None and accuracy.warning:
            self.notes.append(f"warning: {accuracy.warning}")

    def _cause(self) -> str:
        """Return what the last sample tells of the cause of a failure, if anything."""
        return "" if self._last is None else hardly_resisted(self.prepared, *self._last)

    def _end(self) -> float:
        return float(self._times[-1][-1]) if self._times else 0.0

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
        """Take status, exit code and summary from a wheel whose leaving its rail ended the run."""
        if statistics is None or statistics.ended_by is None:
            return
        event = self._event(statistics.ended_by)
        if event.outcome == "ok":
            return
        self.status, self.exit_code = event.outcome, EXIT_NEGATIVE
        wheel, place = event.name.rpartition(".")[0], self._place(event.name)
        name, did = event.outcome, _DID[event.outcome]
        self.summary.append(SummaryEntry(f"{name}_wheel", wheel, "", f"Wheel that {did}"))
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


def _written_channels(
    loaded: LoadedScenario, derived: Derived | Prepared
) -> tuple[list[int], list[dict[str, Any]]]:
    """Return channels and figures to write; refuse unknown ones, and what the solver cannot do."""
    kept = _kept_channels(loaded, derived)
    described = _plots(loaded, derived, kept)
    # Only methods that cannot treat every model have a check.
    check = getattr(loaded.scenario.solver, "check", None)
    if check is not None:
        check(derived.equations)
    return kept, described


def _kept_channels(loaded: LoadedScenario, prepared: Derived | Prepared) -> list[int]:
    """Return the channels to write; an unknown pattern is an error before the run."""
    names = [c.name for c in prepared.equations.channels]
    patterns = loaded.scenario.output.channels
    if patterns is None:
        return list(range(len(names)))
    problems = []
    for pattern in patterns:
        if not fnmatch.filter(names, pattern):
            guess = nearest_name(pattern, names)
            hint = f"; did you mean '{guess}'?" if guess else ""
            problems.append((pattern, f"'{pattern}' matches no channel{hint}"))
    if problems:
        raise wrong_output(loaded, "channels", problems)
    return [k for k, n in enumerate(names) if any(fnmatch.fnmatchcase(n, p) for p in patterns)]


def _needed_channels(prepared: Prepared) -> list[int]:
    """Return the channels the summary is made from, kept or not."""
    names = [c.name for c in prepared.equations.channels]
    return [names.index(n) for n in prepared.subject.channels(prepared.equations)]


def _plots(
    loaded: LoadedScenario, prepared: Derived | Prepared, kept: Sequence[int]
) -> list[dict[str, Any]]:
    """Return the figures asked for, those whose channels are kept."""
    described = prepared.subject.plots(prepared.equations)
    names = {prepared.equations.channels[k].name for k in kept}
    wanted = loaded.scenario.output.plots
    known = [str(plot["name"]) for plot in described]
    for name in wanted or ():
        if name not in known:
            problem = (name, unknown_name("plot", name, known))
            raise wrong_output(loaded, "plots", [problem])
    chosen = [p for p in described if wanted is None or p["name"] in wanted]
    return [plot for plot in chosen if _plot_channels(plot) <= names]


def _plot_channels(plot: dict[str, Any]) -> set[str]:
    if plot["kind"] == "path":
        return {plot["x"], plot["y"], plot.get("heading") or plot["x"]}
    return {channel for panel in plot["panels"] for channel in panel["channels"]}


def _model_hash(prepared: Prepared, *, parameters: bool = True) -> str:
    """Return a digest of the structure, the tables and, if asked, the parameters of the model."""
    e = prepared.equations
    facts = {
        "structure": e.structure,
        "parameters": {p.name: p.value if parameters else p.unit for p in e.parameters},
        "channels": [c.name for c in e.channels],
        **({"tables": [(t.name, t.digest) for t in e.tables]} if e.tables else {}),
    }
    text = json.dumps(facts, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def _kernel_message(prepared: Prepared) -> str:
    report = prepared.kernel.report
    total = report.operations.get("rates", 0)
    origin = "cached" if report.cached else f"built in {_built(prepared):.1f} s"
    text = f"kernel: {prepared.kernel.description}, {total} operations a right-hand side, {origin}"
    return text


def _built(prepared: Prepared) -> float:
    report = prepared.kernel.report
    return report.generation_seconds + report.compilation_seconds


def _shown(entry: SummaryEntry) -> ShownEntry:
    text = shown(entry.value, entry.unit)
    return ShownEntry(entry.value, entry.unit, f"{text:<14} {entry.description}")
