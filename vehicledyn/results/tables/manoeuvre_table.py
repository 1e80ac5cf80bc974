"""An optimal manoeuvre with its controls, as a result file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.results.store.consistency import Sizes
from vehicledyn.results.store.linear_file import (
    Quantity,
    new_file,
    old_file,
    read_quantities,
    read_texts,
    write_axis,
    write_numbers,
    write_quantities,
    write_texts,
)

FORMAT = "vehicledyn-manoeuvre"


@dataclass(frozen=True)
class ManoeuvreTable:
    """An optimal manoeuvre, in SI.

    ``time`` (n,); ``states``, ``controls`` and ``channels`` with values over time (n, count),
    ``simulated`` the states of a run under the same controls, ``state_errors`` their largest
    difference over the range; ``path`` (n, 4): distance, offset, and the offsets of the right and
    left side of the corridor, no columns without a path; ``history`` (n_iterations, 2): objective
    and violation; ``mesh_errors`` those of the meshes one after the other. ``status`` is "ok" or
    "failed"; a failed one that misses conditions is not simulated: ``simulated`` and the errors are
    not a number.
    """

    title: str
    model: str
    status: str
    message: str
    objective: float
    duration: float
    violation: float
    simulation_error: float
    n_intervals: int
    time: Any
    states: tuple[Quantity, ...]
    state_values: Any
    simulated: Any
    state_errors: Any
    controls: tuple[Quantity, ...]
    control_values: Any
    channels: tuple[Quantity, ...]
    channel_values: Any
    path: Any
    history: Any
    mesh_errors: Any
    notes: tuple[str, ...]

    @property
    def is_checked(self) -> bool:
        """Whether the controls were simulated to the end."""
        return math.isfinite(self.simulation_error)

    @property
    def check(self) -> str:
        """How far the simulation is from the optimal motion, in words."""
        return f"differs by {self.simulation_error:.2g} of the range at most"


_HEAD = ("title", "model", "status", "message", "objective", "duration", "violation")
_PATH = ("distance", "offset", "right_side", "left_side")


def write_manoeuvre(path: Path, table: ManoeuvreTable) -> None:
    """Write an optimal manoeuvre to a file.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = {name: getattr(table, name) for name in (*_HEAD, "simulation_error")}
    head["intervals"] = table.n_intervals
    with new_file(path, FORMAT, head) as file:
        time = write_axis(file, "time", np.asarray(table.time, float), ("s", "Time"))
        states = write_quantities(file, "state", table.states)
        about = ("as state", "States of the optimal motion")
        write_numbers(file, "state_value", table.state_values, (time, states), about)
        about = ("as state", "States of a run under the optimal controls")
        write_numbers(file, "state_simulated", table.simulated, (time, states), about)
        about = ("1", "Largest difference of the two over the range of the state")
        write_numbers(file, "state_error", table.state_errors, (states,), about)
        controls = write_quantities(file, "control", table.controls)
        about = ("as control", "Optimal controls")
        write_numbers(file, "control_value", table.control_values, (time, controls), about)
        if table.channels:
            channels = write_quantities(file, "channel", table.channels)
            about = ("as channel", "Channels of the optimal motion")
            write_numbers(file, "channel_value", table.channel_values, (time, channels), about)
        for k in range(np.shape(table.path)[1]):
            name = _PATH[k]
            about = ("m", f"Path: {name.replace('_', ' ')}")
            write_numbers(file, f"path_{name}", table.path[:, k], (time,), about)
        history = np.asarray(table.history, dtype=float).reshape(-1, 2)
        steps = np.arange(1.0, len(history) + 1)
        iteration = write_axis(file, "iteration", steps, ("1", "Iteration of the search"))
        for name, column in zip(("objective", "violation"), history.T, strict=True):
            about = ("1", f"{name.capitalize()} of the iteration")
            write_numbers(file, f"iteration_{name}", column, (iteration,), about)
        meshes = np.arange(1.0, len(table.mesh_errors) + 1)
        mesh = write_axis(file, "mesh", meshes, ("1", "Number of the mesh"))
        about = ("1", "Largest error of an interval over the range of the state")
        write_numbers(file, "mesh_error", table.mesh_errors, (mesh,), about)
        write_texts(file, "notes", table.notes)


def read_manoeuvre(path: Path) -> ManoeuvreTable:
    """Return an optimal manoeuvre from its file.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        words = {name: str(file.attrs[name]) for name in _HEAD[:4]}
        numbers = {name: float(file.attrs[name]) for name in (*_HEAD[4:], "simulation_error")}
        head: dict[str, Any] = words | numbers
        states, controls = read_quantities(file, "state"), read_quantities(file, "control")
        channels = read_quantities(file, "channel") if "channel" in file else ()
        counts = {"states": len(states), "controls": len(controls), "channels": len(channels)}
        sizes = Sizes(counts)
        time = sizes.read(file, "time", "times")
        track = [sizes.read(file, f"path_{n}", "times") for n in _PATH if f"path_{n}" in file]
        history = [
            sizes.read(file, f"iteration_{name}", "iterations", infinite=True)
            for name in ("objective", "violation")
        ]
        channel_values = np.zeros((len(time), 0))
        if channels:
            channel_values = sizes.read(file, "channel_value", "times", "channels")
        return ManoeuvreTable(
            **head,
            n_intervals=int(file.attrs["intervals"]),
            time=time,
            states=states,
            controls=controls,
            channels=channels,
            state_values=sizes.read(file, "state_value", "times", "states"),
            simulated=sizes.read(file, "state_simulated", "times", "states"),
            state_errors=sizes.read(file, "state_error", "states", infinite=True),
            control_values=sizes.read(file, "control_value", "times", "controls"),
            channel_values=channel_values,
            path=np.column_stack(track) if track else np.zeros((len(time), 0)),
            history=np.column_stack(history),
            mesh_errors=sizes.read(file, "mesh_error", "meshes", infinite=True),
            notes=tuple(read_texts(file, "notes")),
        )


def describe_manoeuvre(table: ManoeuvreTable) -> dict[str, Any]:
    """Return what a file of an optimal manoeuvre holds."""
    return {
        "holds": "an optimal manoeuvre",
        "title": table.title,
        "model": table.model,
        "status": f"{table.status} {table.message}".strip(),
        "duration": f"{table.duration:.6g} s",
        "objective": f"{table.objective:.6g}",
        "simulated": table.check if table.is_checked else "no",
        "intervals": table.n_intervals,
        "controls": [f"{item.name} [{item.unit}]" for item in table.controls],
        "states": len(table.states),
        "channels": [f"{item.name} [{item.unit}]" for item in table.channels],
        "notes": list(table.notes),
    }
