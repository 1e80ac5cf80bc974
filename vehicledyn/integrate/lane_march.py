"""Takes cases that run side by side from their start to their end, in chunks."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.integrate.accuracy.lanes import LaneMonitor
from vehicledyn.integrate.lane_run import LaneRun

_CHUNK_SECONDS, _FIRST_CHUNK, _GROWTH, _MOST_NUMBERS = 0.08, 16, 8, 1_000_000


def march(run: LaneRun, samples: NDArray[Any], watch: LaneMonitor | None = None) -> Iterator[float]:
    """Run cases to their end in chunks of a tenth of a second; yield the part done.

    Parameters
    ----------
    run
        Cases that have not begun.
    samples
        Room for their samples, shape (n_cases, n_samples, n_channels), at most as many cases
        as lanes; what is not reached becomes not a number.
    watch
        Looks at the state at some samples, to judge the accuracy.
    """
    lanes, per_interval, width = run.engine.lanes, run.per_interval, samples.shape[2]
    whole = (samples.shape[1] - 1) * per_interval
    most = max(1, _MOST_NUMBERS // max(1, lanes * width)) * per_interval
    samples[:] = np.nan
    room = np.full((lanes, 1, width), np.nan)
    going, size = run.begin(room), _FIRST_CHUNK
    samples[:, :1] = room[: len(samples)]
    if watch is not None:
        watch.look(run)
    while going and run.step < whole:
        size = min(size, whole - run.step, most)
        if watch is not None:
            size = min(size, watch.steps_to_go(run))
        first = run.step // per_interval + 1
        last = (run.step + size) // per_interval
        room = np.full((lanes, last + 1 - first, width), np.nan)
        started = time.perf_counter()
        going = run.advance(size, room)
        seconds = max(time.perf_counter() - started, 1e-6)
        samples[:, first : last + 1] = room[: len(samples)]
        if watch is not None:
            watch.look(run)
        size = max(1, min(_GROWTH * size, int(size * _CHUNK_SECONDS / seconds)))
        yield run.step / whole
