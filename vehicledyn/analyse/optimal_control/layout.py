"""Where the parts of a trajectory stand among the variables of a nonlinear program."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.problem import ControlProblem
from vehicledyn.analyse.optimal_control.trajectory import DEGREE, Trajectory

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class Layout:
    """Places and scales of the parts: ``places`` by name (indices in their shape), ``scale`` (n,).

    All variables are divided by their scales. Where the mesh ``follows`` the path the lengths of
    the intervals are variables as well [s].
    """

    def __init__(
        self, problem: ControlProblem, guess: Trajectory, scales: Floats, *, follows: bool = False
    ) -> None:
        self.problem, n_intervals = problem, guess.n_intervals
        self.n = n_intervals
        n_x, n_z = len(problem.equations.states), len(problem.equations.unknowns)
        n_u = len(problem.controls)
        sizes = np.array([c.size for c in problem.controls])
        on_path = int(problem.path is not None)
        length = 1.0 if problem.path is None else float(np.ptp(problem.path.distance))
        of_unknowns = np.maximum(np.abs(guess.unknowns).max(axis=(0, 1), initial=0.0), 1.0)
        parts: dict[str, tuple[tuple[int, ...], Any]] = {
            "duration": ((1,), guess.duration),
            "lengths": ((n_intervals * int(follows),), guess.duration / n_intervals),
            "first": ((n_x,), scales),
            "states": ((n_intervals, DEGREE, n_x), scales),
            "unknowns": ((n_intervals, DEGREE, n_z), of_unknowns),
            "first_distance": ((on_path,), length),
            "distance": ((n_intervals, DEGREE, on_path), length),
            "values": ((n_intervals + 1, n_u), sizes),
            "rates": ((n_intervals + 1, n_u), sizes),
            "accelerations": ((n_intervals, n_u), sizes),
            "inner": ((n_intervals, DEGREE, n_u), sizes),
        }
        self.places: dict[str, Indices] = {}
        begin, found = 0, []
        for name, (shape, scale) in parts.items():
            size = int(np.prod(shape))
            self.places[name] = np.arange(begin, begin + size).reshape(shape)
            found.append(np.broadcast_to(np.asarray(scale, dtype=float), shape).ravel())
            begin += size
        self.scale: Floats = np.concatenate(found)

    @property
    def size(self) -> int:
        """Number of variables."""
        return int(self.scale.size)

    def pack(self, **values: Any) -> Floats:
        """Return the variables of values by part."""
        found = [
            np.broadcast_to(np.asarray(values[name], dtype=float), places.shape).ravel()
            for name, places in self.places.items()
        ]
        return np.asarray(np.concatenate(found) / self.scale)

    def of(self, trajectory: Trajectory) -> Floats:
        """Return the variables of a trajectory."""
        t, on_path = trajectory, self.problem.path is not None
        return self.pack(
            duration=t.duration,
            lengths=t.duration * np.diff(t.mesh) if self.places["lengths"].size else [],
            first=t.first,
            states=t.states,
            unknowns=t.unknowns,
            first_distance=[t.first_distance] if on_path else [],
            distance=t.distance[..., None] if on_path else np.zeros((self.n, DEGREE, 0)),
            values=t.values,
            rates=t.rates,
            accelerations=t.accelerations,
            inner=t.inner,
        )

    def trajectory(self, variables: Any, mesh: Floats) -> Trajectory:
        """Return the trajectory of variables; ``mesh`` is that of a mesh that follows no path."""
        values = np.asarray(variables, dtype=float).ravel() * self.scale
        parts: dict[str, Any] = {name: values[places] for name, places in self.places.items()}
        on_path = self.problem.path is not None
        parts["duration"], lengths = float(parts["duration"][0]), parts.pop("lengths")
        if lengths.size:
            mesh = np.concatenate([[0.0], np.cumsum(lengths) / lengths.sum()])
            mesh[-1] = 1.0
        parts["first_distance"] = float(parts["first_distance"][0]) if on_path else 0.0
        nothing = np.zeros((self.n, DEGREE))
        parts["distance"] = parts["distance"][..., 0] if on_path else nothing
        return Trajectory(mesh=mesh, **parts)
