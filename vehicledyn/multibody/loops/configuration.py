"""An assembled configuration: its partition, and what is redundant, singular or contradictory."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.multibody.loops import assembly, partition
from vehicledyn.multibody.loops.assembly import NotAssembledError
from vehicledyn.multibody.loops.constraint_equations import Gaps
from vehicledyn.multibody.loops.partition import Choice, Redundancy
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.system import System

Array = NDArray[np.float64]
_STEP_ASIDE = 1e-3
"""Step that distinguishes a singular configuration from redundant constraints [m, rad]."""
_GUESSES = 4
_SAME = 1e-6
"""Coordinates nearer to each other than this belong to one solution [m, rad]."""
_STEPS = 40
_LONGEST = 2e-3
"""Longest change of a coordinate in a step that draws loops together [m, rad]."""
_NEAR = 1e-6
"""Change of a step after which loops are nearly closed [m, rad]."""
_WEAK = 1e-5
"""Pivot below which a start counts as nearly singular [1]."""
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Guess:
    """What constraints guess of coordinates of their own: their indices, and the values there."""

    places: Sequence[int]
    values: Callable[[Array], Array]

    def __call__(self, q: Array) -> Array:
        """Return all coordinates with the guessed ones in their places."""
        full = q.copy()
        if self.places:
            full[list(self.places)] = self.values(q)
        return full


@dataclass(frozen=True)
class LoopAssembly:
    """Where a system is assembled: joints, rows, time [s] and the coordinates that never move."""

    joints: Sequence[Joint]
    gaps: Gaps
    time: float
    still: set[str]

    def columns(self, *roles: str) -> list[int]:
        """Return the indices of the coordinates with one of these roles."""
        return [k for k, j in enumerate(self.joints) if j.role in roles]

    def assembled(self, start: Array) -> Array:
        """Return all coordinates with every loop closed, near the given ones."""
        free = self.columns("auto", "dependent")

        def at(values: Array) -> Array:
            full = start.copy()
            full[free] = values
            return full

        found = assembly.assemble(
            lambda values: self.gaps.residual(self.time, at(values)),
            lambda values: self._slopes(at(values))[:, free],
            start[free],
            self.gaps.cuts,
        )
        return at(found)

    def assembled_by(self, start: Array, guess: Guess) -> Array:
        """Return all coordinates with every loop closed, some of which constraints guess.

        Where a constraint has several solutions, what is guessed while others are open may be
        another one than where they are closed: it is guessed anew there, until it stays.

        Raises
        ------
        NotAssembledError
            If loops stay open.
        """
        try:
            q = self.assembled(guess(start))
        except NotAssembledError:
            if not guess.places:
                raise
            q = self.assembled(guess(self._drawn_together(start, guess)))
        for _ in range(_GUESSES if guess.places else 0):
            try:
                found = self.assembled(guess(q))
            except NotAssembledError:
                break
            if np.allclose(found, q, rtol=0.0, atol=_SAME):
                break
            q = found
        return q

    def _drawn_together(self, start: Array, guess: Guess) -> Array:
        """Return coordinates with loops nearly closed, guessed anew at each step.

        With all rows at once a wheel that must climb its flange is caught where two places of
        tangency become one. The lowest gap alone has no such end: Newton's steps close the rows
        that bear a force, others keep what the guess leaves of them.
        """
        bear = np.array([row.bears for row in self.gaps.rows[: self.gaps.holonomic]])
        free = self.columns("auto", "dependent")
        own = np.isin(free, guess.places)
        q = guess(start)
        for _ in range(_STEPS):
            h = np.where(bear, self.gaps.residual(self.time, q), 0.0)
            slopes = self._slopes(q)[:, free]
            if not (np.isfinite(h).all() and np.isfinite(slopes).all()):
                break
            step = -np.linalg.lstsq(slopes, h, rcond=partition.RANK_TOLERANCE)[0]
            step[own] = 0.0
            length = float(np.abs(step).max(initial=0.0))
            if length < _NEAR:
                break
            q[free] += min(1.0, _LONGEST / length) * step
            q = guess(q)
        return q

    def chosen(self, q: Array) -> Choice:
        """Return the partition at a configuration."""
        return partition.choose(
            self.gaps.jacobian(self.time, q),
            self.gaps.structure,
            must=self.columns("dependent"),
            may=self.columns("auto"),
            names=[j.name for j in self.joints],
            holonomic=self.gaps.holonomic,
        )

    def nearby(self, q: Array) -> Array | None:
        """Return a configuration a small step away that the constraints allow, if there is one.

        The step is allowed to first order, and then the loops are closed again.
        """
        moving = self.columns("auto", "dependent")
        _, sizes, directions = np.linalg.svd(self._slopes(q)[:, moving])
        limit = partition.RANK_TOLERANCE * max(1.0, sizes.max(initial=0.0))
        allowed = directions[int(np.sum(sizes > limit)) :]
        if not len(allowed):
            return None
        step = q.copy()
        # Any direction will do that no symmetry prefers.
        step[moving] += _STEP_ASIDE * allowed.T @ np.cos(np.arange(len(allowed)) + 1.0)
        try:
            return self.assembled(step)
        except NumericalError:
            return None

    def _slopes(self, q: Array) -> Array:
        return self.gaps.jacobian(self.time, q)[: self.gaps.holonomic]


def refuse_singular(place: LoopAssembly, q: Array, chosen: Choice) -> None:
    """Raise InputError if rows that look redundant are not so a little further on.

    Redundant constraints stay so; at a singular configuration (book, figure 2.5) the rank
    grows with the step.
    """
    near = place.nearby(q)
    if near is None:
        return
    other = place.chosen(near)
    lost = len(chosen.rates.redundancies) - len(other.rates.redundancies)
    if lost <= 0:
        return
    names = [j.name for j in place.joints]
    here = set(chosen.rates.columns)
    free = [f"'{names[c]}'" for c in other.rates.columns if c not in here]
    acting = set(other.rates.redundant)
    cuts = _listed([place.gaps.rows[r].cut for r in chosen.rates.redundant if r not in acting])
    raise InputError(
        f"the assembled configuration is singular: {lost} of the constraints of {cuts} "
        f"do not act there and leave {', '.join(free)} undetermined; start the coordinates of "
        "these loops elsewhere",
        about=[place.gaps.rows[r].cut for r in chosen.rates.redundant if r not in acting],
    )


def refuse_contradictions(place: LoopAssembly, q: Array, chosen: Choice) -> None:
    """Raise InputError if a row without freedom of its own is moved by a drive, or by time.

    Such a row holds at the start and would open as soon as the drive, the time law or a
    coordinate that is declared independent moves.
    """
    drift = place.gaps.drift(place.time, q)
    problems: list[str] = []
    about: list[str] = []
    for item in chosen.rates.redundancies:
        weights = {item.row: 1.0, **item.weights}
        rows = [place.gaps.rows[r] for r in weights]
        movers = [place.joints[c] for c in item.rest if place.joints[c].name not in place.still]
        pushed = sum(weight * drift[r] for r, weight in weights.items())
        cuts = _listed([row.cut for row in rows])
        problems.extend(
            f"'{j.name}' is {'driven' if j.role == 'driven' else 'declared independent'}, but "
            f"the constraints {cuts} leave it no freedom"
            for j in movers
        )
        before = len(problems)
        if not movers and abs(pushed) > partition.RANK_TOLERANCE:
            problems.append(f"the constraints {cuts} contradict each other as time goes on")
        if movers or len(problems) > before:
            about += [*(row.cut for row in rows), *(j.name for j in movers)]
    if problems:
        raise InputError("contradictory constraints: " + "; ".join(problems), about=about)


def warn_weak(place: LoopAssembly, chosen: Choice) -> None:
    """Warn of a start so near to a singular configuration that it will be inaccurate."""
    found = chosen.rates
    if found.smallest_pivot < _WEAK:
        _log.warning(
            "the assembled configuration is nearly singular: the constraints hardly determine "
            "'%s' (pivot %.1e); start the coordinates of its loop elsewhere",
            place.joints[found.weakest].name,
            found.smallest_pivot,
        )


def explain(system: System, place: LoopAssembly, item: Redundancy) -> dict[str, object]:
    """Return which row says nothing new, from which it follows, and the joints in question.

    A row that follows from no other vanishes by itself, because no joint of its loop can open
    it.
    """
    rows = place.gaps.rows
    involved = [item.row, *item.weights]
    columns = set().union(*(place.gaps.structure[r] for r in involved))
    names = {place.joints[c].name for c in columns}
    for row in involved:
        names |= loop_joints(system, rows[row].cut)
    return {
        "constraint": rows[item.row].label,
        "follows_from": [rows[r].label for r in item.weights],
        "joints": [j.name for j in place.joints if j.name in names],
    }


def loop_joints(system: System, cut: str) -> set[str]:
    """Return the names of the joints of the loop that a cut opens; none for a constraint."""
    bodies = {body.name: body for body in system.bodies}

    def chain(name: str) -> list[str]:
        path = []
        while name != GROUND:
            path.append(name)
            name = bodies[name].parent
        return path

    for item in system.cuts:
        if item.name == cut:
            loop = set(chain(item.body_a)) ^ set(chain(item.body_b))
            return {j.name for b in loop for j in bodies[b].joints if isinstance(j, Joint)}
    return set()


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in dict.fromkeys(names))
