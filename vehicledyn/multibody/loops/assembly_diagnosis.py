"""Why loops do not close or do not move: contradictions, lengths that do not reach, rigid loops."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, NumericalError, VehicledynError
from vehicledyn.multibody.loops.assembly import NotAssembledError
from vehicledyn.multibody.loops.configuration import LoopAssembly, loop_joints
from vehicledyn.multibody.loops.partition import RANK_TOLERANCE
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.constraints import UserConstraint
from vehicledyn.multibody.model.system import System

Array = NDArray[np.float64]
_ASIDE = 0.3
"""Largest step to the configurations where ranks are usual ones [m, rad]."""
_LATER = (0.37, 1.93, 7.1)
"""Moments at which a constraint that depends on time shows it [s]."""
_OPEN = 1e-6
_MOST = 4


def why_open(
    system: System, place: LoopAssembly, start: Array, error: NotAssembledError
) -> VehicledynError:
    """Return why the loops stay open.

    Where the gradients of the open residuals are linearly dependent everywhere about the best
    fit, no lengths or start values close them: these constraints contradict each other, or what
    is driven or declared independent.
    """
    q = start.copy()
    free, held = place.columns("auto", "dependent"), place.columns("driven", "independent")
    q[free] = error.point
    sizes = np.abs(error.gap)
    worst = float(sizes.max())
    cuts = {c: _size(place, sizes, c) for c in place.gaps.cuts}
    cuts = {
        c: s
        for c, s in sorted(cuts.items(), key=lambda i: -float(f"{i[1]:.3g}"))
        if s > _OPEN * worst
    }
    rows = [
        r
        for r, c in enumerate(place.gaps.cuts)
        if c in cuts and (sizes[r] > _OPEN * worst or _usual_rank(place, q, [r], [*free, *held]))
    ]
    opened = _listed([f"'{c}' by {_length(system, place, sizes, c)}" for c in [*cuts][:_MOST]])
    rank = _usual_rank(place, q, rows, free)
    if rank == len(rows):
        return NumericalError(
            f"the loops cannot be assembled: {opened} stay open after the best fit; "
            "check the hardpoints and lengths of these parts, and where their coordinates start",
            about=cuts,
        )
    if _usual_rank(place, q, rows, [*free, *held]) > rank:
        slopes = place.gaps.jacobian(place.time, q)[np.ix_(rows, held)]
        acting = [place.joints[k] for k, s in zip(held, slopes.T, strict=True) if np.any(s)]
        text = (
            f"{opened} stay open after the best fit, as {_held(acting)}; free one of these "
            "coordinates, or let it be where the constraints allow it to be"
        )
        return _contradiction(text, [*cuts, *(j.name for j in acting)])
    if rank == 0:
        return _contradiction(
            f"{opened} stay open, and no coordinate can change that; check the points, lengths "
            "and offsets of these parts",
            cuts,
        )
    return _contradiction(
        f"{opened} stay open after the best fit; of {len(rows)} conditions only {rank} can hold "
        "at once; take a constraint away or make them agree",
        cuts,
    )


@dataclass(frozen=True)
class RigidLoop:
    """A loop that cannot move: its constraints and all coordinates that they hold."""

    constraints: tuple[str, ...]
    coordinates: tuple[str, ...]

    def __str__(self) -> str:
        """Return what is wrong and what next."""
        named = _listed([f"'{name}'" for name in self.constraints])
        names = _listed([f"'{name}'" for name in self.coordinates])
        held = f"they hold all that could move, {names}" if names else "nothing in it can move"
        return (
            f"the loop of {named} has no freedom: {held}; take a constraint away, or give the loop "
            "another joint"
        )


def rigid_loops(system: System, place: LoopAssembly, q: Array) -> tuple[RigidLoop, ...]:
    """Return the loops that cannot move although nothing drives or locks them.

    Constraints without a loop may hold what they like.

    Parameters
    ----------
    system
        The system, for its cuts.
    place, q
        The assembled configuration.
    """
    count = place.gaps.holonomic
    cuts = {cut.name for cut in system.cuts}
    if not cuts:
        return ()
    slopes = place.gaps.jacobian(place.time, q)[:count]
    moving = {
        int(r)
        for t in _LATER
        for r in np.flatnonzero(place.gaps.drift(place.time + t, _aside(q, t))[:count])
    }
    found = []
    for rows, columns in _components(place):
        names = tuple(dict.fromkeys(place.gaps.cuts[r] for r in rows))
        if moving.intersection(rows) or not cuts.intersection(names):
            continue
        if not columns and any(loop_joints(system, name) for name in names):
            continue  # A cut that its joints leave closed anyway, as a second hinge in line.
        if len(rows) < len(columns):
            continue
        if _rank(slopes[np.ix_(rows, columns)]) == len(columns):
            found.append(RigidLoop(names, tuple(place.joints[c].name for c in columns)))
    return tuple(found)


def _held(joints: Sequence[Joint]) -> str:
    """Return which coordinates are driven and which declared independent."""
    kinds = {"driven": "driven", "independent": "declared independent"}
    named = []
    for role, words in kinds.items():
        names = [f"'{j.name}'" for j in joints if j.role == role]
        if names:
            named.append(f"{_listed(names)} {'is' if len(names) == 1 else 'are'} {words}")
    return _listed(named)


def _contradiction(text: str, about: Iterable[str]) -> InputError:
    return InputError(f"contradictory constraints: {text}", about=about)


def _size(place: LoopAssembly, sizes: Array, cut: str) -> float:
    return max(float(s) for s, name in zip(sizes, place.gaps.cuts, strict=True) if name == cut)


def _length(system: System, place: LoopAssembly, sizes: Array, cut: str) -> str:
    """Return how far a cut is open, with its unit; that of a user's constraint is not known."""
    size = _size(place, sizes, cut)
    row = next(r for r, name in enumerate(place.gaps.cuts) if name == cut and sizes[r] == size)
    written = any(c.name == cut and isinstance(c, UserConstraint) for c in system.constraints)
    unit = "" if written else f" {place.gaps.rows[row].residual.unit}"
    return f"{size:.3g}{unit}"


def _usual_rank(place: LoopAssembly, q: Array, rows: list[int], columns: list[int]) -> int:
    """Return the rank that some rows have about a configuration, but for special places."""
    found = 0
    for seed in (1.0, 2.0):
        slopes = place.gaps.jacobian(place.time, _aside(q, seed))[np.ix_(rows, columns)]
        found = max(found, _rank(slopes))
    return found


def _rank(slopes: Array) -> int:
    if not slopes.size or not np.isfinite(slopes).all():
        return 0
    largest = np.abs(slopes).max(axis=1, keepdims=True)
    rows = slopes / np.where(largest > RANK_TOLERANCE, largest, np.inf)  # squares do not overflow
    rows /= np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), RANK_TOLERANCE)
    sizes = np.linalg.svd(rows)[1]
    return int(np.sum(sizes > RANK_TOLERANCE))


def _aside(q: Array, seed: float) -> Array:
    return np.asarray(q + _ASIDE * np.cos(seed * np.arange(1.0, q.size + 1.0) ** 2))


def _components(place: LoopAssembly) -> list[tuple[list[int], list[int]]]:
    """Return groups of holonomic rows and the coordinates they depend on, none shared."""
    groups: list[tuple[list[int], set[int], set[str]]] = []
    for row, cut in enumerate(place.gaps.cuts):
        rows, columns, cuts = [row], set(place.gaps.structure[row]), {cut}
        apart = []
        for group in groups:
            if columns & group[1] or cuts & group[2]:
                rows, columns, cuts = group[0] + rows, columns | group[1], cuts | group[2]
            else:
                apart.append(group)
        groups = [*apart, (rows, columns, cuts)]
    return [(rows, sorted(columns)) for rows, columns, _ in groups]


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))
