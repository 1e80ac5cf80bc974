"""Run the project's scenarios in memory and keep what they gave."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

import vehicledyn.catalogue  # noqa: F401  # registers models, tyres, roads
from vehicledyn.analyses.preparation.prepare import prepare
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.files.scenario import load_model, load_scenario
from vehicledyn.integrate.simulate import simulate

SCENARIOS = Path(__file__).parents[3] / "scenarios"


@dataclass(frozen=True)
class Recorded:
    """Samples of a run: ``time``, shape (n,) [s], and channels by name, shape (n,), in SI."""

    prepared: Prepared
    time: np.ndarray
    channels: dict[str, np.ndarray]

    def __getitem__(self, name):
        return self.channels[name]


@lru_cache(maxsize=32)
def drive(name, *overrides, backend="auto"):
    """Return the samples of a scenario with overrides "key=value"."""
    return record(load_scenario(SCENARIOS / f"{name}.yaml", overrides), backend=backend)


def drive_text(text, *, backend="auto"):
    """Return the samples of a scenario given as text."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scenario.yaml"
        path.write_text(text, encoding="utf-8")
        return record(load_scenario(path), backend=backend)


def record(loaded, *, backend="auto"):
    """Run a loaded scenario as the command line does, but keep the samples in memory."""
    return recorded(loaded.scenario, *prepare_run(loaded, backend=backend, progress=quiet))


def recorded(s, prepared, start):
    """Run a scenario that is prepared from a point, and keep the samples in memory."""
    times, outputs = [], []

    def keep(t, x, z, y):
        times.append(t.copy())
        outputs.append(y.copy())

    simulate(
        prepared.kernel,
        s.solver,
        start=0.0,
        stop=s.duration,
        state=start.state,
        unknowns=start.unknowns,
        interval=s.output.interval,
        sink=keep,
    )
    values = np.vstack(outputs)
    names = [channel.name for channel in prepared.equations.channels]
    columns = {name: values[:, k] for k, name in enumerate(names)}
    return Recorded(prepared, np.concatenate(times), columns)


@lru_cache(maxsize=1)
def standard_model():
    """Return the prepared Iltis with the parts of its benchmark."""
    return prepare(load_model("iltis"), backend="auto", progress=quiet)


def is_compiled():
    """Return whether runs are compiled here."""
    return standard_model().kernel.backend == "compiled"


def quiet(what, part):
    """Show no progress."""
