"""Going on with a run from its result, partial or whole: whether that can be, and from where."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.argument_names import argument, setting
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.integrate.course import Beginning
from vehicledyn.integrate.estimated_accuracy import Accuracy, worst_of
from vehicledyn.results.hdf5.output import is_being_written
from vehicledyn.results.store.decimation import PORTION
from vehicledyn.results.store.layout import EventRecord
from vehicledyn.results.store.reader import ENDS, Result, open_result

Matrix = NDArray[np.float64]

_FREE = ("title", "duration", "solver", "output", "overrides", "units")
"""Parts of a scenario that may differ from those of the run that is continued."""
_ROWS = 4096
SINGULAR_ANGLES = "singular_angles"
"""Last word of events that are found again from the samples."""


@dataclass(frozen=True)
class Restart:
    """A result to go on from: its first ``samples`` samples, and what follows from them.

    ``verdict`` is what it says of the accuracy of those samples where another method or step made
    them, which the watch of what follows cannot judge; None where it says nothing or need not.
    """

    result: Result
    samples: int
    beginning: Beginning
    state: Matrix
    unknowns: Matrix
    events: tuple[EventRecord, ...]
    remark: str
    same_method: bool
    verdict: Accuracy | None

    def beginning_for(self, prepared: Prepared, kept: Sequence[int]) -> Beginning:
        """Return where the run begins, with the samples before if the same method made them."""
        if not self.same_method:
            return self.beginning
        return replace(self.beginning, past=lambda: self.blocks(prepared, kept))

    def accuracy(self, found: Accuracy | None) -> Accuracy | None:
        """Return the accuracy of the whole from that found of what follows."""
        return worst_of([self.verdict, found])

    def blocks(self, prepared: Prepared, kept: Sequence[int]) -> Iterator[tuple[Matrix, ...]]:
        """Yield times, states, unknowns and outputs of the samples, shape (n,) and (n, ...).

        Outputs that the file does not hold are computed from its states.
        """
        n_states, n_channels = len(prepared.equations.states), len(prepared.equations.channels)
        for start in range(0, self.samples, _ROWS):
            times, table, both = self.result.rows(start, min(start + _ROWS, self.samples))
            states, unknowns = both[:, :n_states].copy(), both[:, n_states:].copy()
            outputs = np.empty((len(times), n_channels))
            if len(kept) < n_channels:
                for row, point in enumerate(zip(times, states, unknowns, strict=True)):
                    outputs[row] = prepared.kernel.outputs(float(point[0]), *point[1:])
            outputs[:, kept] = table
            yield times, states, unknowns, outputs


def open_restart(
    path: Path, loaded: LoadedScenario, prepared: Prepared, names: Sequence[str], digest: str
) -> Restart:
    """Open a result to go on from; the caller closes it.

    Parameters
    ----------
    path
        The result.
    loaded, prepared
        What is to be run.
    names
        Channels that it writes.
    digest
        Digest of its equations and parameters.

    Raises
    ------
    InputError
        If the result is being written, or damaged, belongs to other equations, parameters or
        samples, has ended of itself, or reaches the end of the scenario already.
    """
    if is_being_written(path.resolve()):
        raise InputError(f"{path}: is being written by a run; go on from it when that has ended")
    result = open_result(path, ENDS)
    try:
        _refuse_others(result, loaded, prepared, names, digest)
        return _restart(result, loaded, prepared)
    except BaseException:
        result.close()
        raise


def _restart(result: Result, loaded: LoadedScenario, prepared: Prepared) -> Restart:
    same_solver = result.configuration.get("solver") == loaded.resolved.get("solver")
    times = result.column("time")
    latest = float(result.time[-1])
    if _reaches_end(result, loaded):
        # Killed after its last sample: that one is computed again, and the end with it.
        latest = float(times[len(times) - 2 :][0])
    history = result.history(latest) if same_solver else None
    time = latest if history is None else history.time
    samples = int(times.first_from(np.nextafter([time], np.inf))[0])  # up to this time
    _, _, both = result.rows(samples - 1, samples)
    state, unknowns = np.split(both[0], [len(prepared.equations.states)])
    remark = f"went on from t = {time:.9g} s of {result.path}"
    if history is None:
        remark += "; equal to a run in one piece to the accuracy of the method"
    verdict = None if same_solver else _verdict_of(result)
    if not same_solver:
        said = "not known" if verdict is None else verdict.verdict
        remark += f"; accuracy is judged from there on, before it is {said} by that result"
    return Restart(
        result,
        samples,
        Beginning(
            time,
            None if history is None else history.numbers,
            kept=None if history is None else result.kept_numbers[: history.kept[0]],
        ),
        state.copy(),
        unknowns.copy(),
        tuple(
            event
            for event in result.events_so_far
            if event.time <= time and event.name.rpartition(".")[2] != SINGULAR_ANGLES
        ),
        remark,
        same_solver,
        verdict,
    )


def _verdict_of(result: Result) -> Accuracy | None:
    """Return what a result says of its accuracy, None if nothing."""
    known = result.solver
    if "accuracy" not in known:
        return None
    step = known.get("recommended_step")
    return Accuracy(
        str(known["accuracy"]),
        float(known["estimated_error"]),
        f"'{known['least_accurate']}'",
        None if step is None else float(step),
    )


def _refuse_others(
    result: Result, loaded: LoadedScenario, prepared: Prepared, names: Sequence[str], digest: str
) -> None:
    path, e = result.path, prepared.equations
    what = "cannot be continued"
    differing = _differing(result.configuration, loaded.resolved)
    if differing:
        raise InputError(
            f"{path}: {what}: its scenario has another {', '.join(differing)}; "
            f"undo that, or run without {argument('restart')}"
        )
    if result.model_hash != digest or result.state_names != tuple(
        item.name for item in (*e.states, *e.unknowns)
    ):
        raise InputError(
            f"{path}: {what}: its equations or parameters are others than those of "
            f"{loaded.path}; undo that, or run without {argument('restart')}"
        )
    if result.channels != tuple(names):
        raise InputError(f"{path}: {what}: it holds other channels; undo that in 'output'")
    if not result.samples:
        raise InputError(f"{path}: {what}: it has no sample; run without {argument('restart')}")
    interval = loaded.scenario.output.interval
    if not _is_sampled_every(result, interval):
        ended = result.solver.get("ended_by")
        why = f"event '{ended}' ended it" if ended else f"it is not sampled every {interval:g} s"
        raise InputError(f"{path}: {what}: {why}")
    if result.solver.get("ended_by"):
        raise InputError(f"{path}: {what}: event '{result.solver['ended_by']}' ended it")
    may_be_completed = not result.has_ended and result.samples > 1
    if _goes_beyond_end(result, loaded) or (_reaches_end(result, loaded) and not may_be_completed):
        raise InputError(
            f"{path}: reaches t = {result.time[-1]:.9g} s already; to go on, give a longer "
            f"duration by {setting('duration')}"
        )


def _is_sampled_every(result: Result, interval: float) -> bool:
    times = result.column("time")
    for start in range(0, len(times), PORTION):
        part = times[start : start + PORTION]
        grid = interval * np.arange(start, start + len(part))
        if np.abs(part - grid).max() > 1e-6 * interval:
            return False
    return True


def _reaches_end(result: Result, loaded: LoadedScenario) -> bool:
    s = loaded.scenario
    return bool(result.time[-1] > s.duration - 0.5 * s.output.interval)


def _goes_beyond_end(result: Result, loaded: LoadedScenario) -> bool:
    s = loaded.scenario
    return bool(result.time[-1] > s.duration + 0.5 * s.output.interval)


def _differing(known: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    names = [name for name in {**known, **now} if name not in _FREE]
    return [name for name in names if _plain(known.get(name)) != _plain(now.get(name))]


def _plain(value: Any) -> Any:
    """Return a value as it is when it was written to a file and read again."""
    import json

    return json.loads(json.dumps(value, default=str))
