"""Watch bodies whose three turns come near the angle at which two of them are one.

Three turns about axes i, j, k describe an orientation badly where the second one brings the
third axis onto the first: at ±90 degrees for three different axes (yaw, pitch, roll), at 0 and
180 degrees where the first axis comes again. Rates of the first and third angle then grow as
one over the cosine (sine) of the second, and rounding and errors of the steps with them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.units import shown
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.system import System
from vehicledyn.symbolic.equations import Equations

Matrix = NDArray[np.float64]

NEAR = 0.02
"""Cosine (sine) of the middle angle below which accuracy is lost: 1.15 degrees [1]."""

_CLOSE = 0.15
"""Cosine (sine) of the middle angle below which the way between two samples is looked at [1]."""

_ZERO = 1e-6
_TURNS, _PAIR = 3, 2


@dataclass
class Watched:
    """The first two of three turns of a body by column, and how near the second one has come.

    ``nearest`` is the smallest cosine (sine) of the second angle so far, ``last`` holds time and
    both angles of the sample before.
    """

    body: str
    angle: str
    columns: tuple[int, int]
    is_proper: bool = False
    nearest: float = np.inf
    time: float = 0.0
    last: tuple[float, float, float] | None = None


@dataclass
class SingularTurns:
    """Watches the angles of samples as they come; :meth:`remarks` says what came near."""

    watched: list[Watched] = field(default_factory=list)

    @staticmethod
    def of(system: System, equations: Equations) -> SingularTurns:
        """Return a watch on the bodies of a system that turn about three axes at one place."""
        names = [s.name for s in (*equations.states, *equations.unknowns)]
        found = []
        for body, (first, middle, third) in _triples(system):
            if middle.name in names:
                lead = names.index(first.name) if first.name in names else -1
                columns = (lead, names.index(middle.name))
                found.append(Watched(body, middle.name, columns, first.kind == third.kind))
        return SingularTurns(found)

    def take(self, times: Matrix, states: Matrix, unknowns: Matrix) -> None:
        """Look at samples, shapes (n,), (n, n_states) and (n, n_unknowns)."""
        if not len(times):
            return
        every = np.hstack([states, unknowns])
        for item in self.watched:
            lead, middle = item.columns
            first = every[:, lead] if lead >= 0 else np.zeros(len(times))
            _look(item, times, first, every[:, middle])

    def remarks(self) -> list[str]:
        """Return a sentence for each body that came near."""
        said = []
        for item in self.came_near():
            at = "a whole number of half turns" if item.is_proper else "90 degrees"
            off = float(np.arcsin(min(item.nearest, 1.0)))
            near = f"comes within {shown(off, 'rad')} of {at}"
            reached = f"passes {at}" if item.nearest < _ZERO else near
            said.append(
                f"body '{item.body}': its angle {item.angle} {reached} at t = {item.time:.6g} s, "
                "where its first and third turn are about one axis: accuracy is lost there; "
                "choose another sequence of turns, whose second one stays away from it"
            )
        return said

    def came_near(self) -> list[Watched]:
        """Return what came near, in the order of the bodies."""
        return [item for item in self.watched if item.nearest < NEAR]


def _look(item: Watched, times: Matrix, first: Matrix, middle: Matrix) -> None:
    """Find the nearest approach in samples, and between those that are near already.

    The third axis of the turns meets a plane across the first one at cos β (cos α, sin α), for
    angles α and β of the first two turns (sin β where the first axis comes again), and is
    singular in the middle of it: between two samples it moves as good as straight there.
    """
    if item.last is not None:
        times = np.concatenate([[item.last[0]], times])
        first = np.concatenate([[item.last[1]], first])
        middle = np.concatenate([[item.last[2]], middle])
    item.last = (float(times[-1]), float(first[-1]), float(middle[-1]))
    away = np.sin(middle) if item.is_proper else np.cos(middle)
    place = away[:, None] * np.column_stack([np.cos(first), np.sin(first)])
    _nearer(item, np.abs(away), times)
    if len(times) < _PAIR:
        return
    move = np.diff(place, axis=0)
    length = np.maximum((move**2).sum(axis=1), 1e-300)
    share = np.clip(-(place[:-1] * move).sum(axis=1) / length, 0.0, 1.0)
    between = np.hypot(*(place[:-1] + share[:, None] * move).T)
    is_near = np.maximum(np.abs(away[:-1]), np.abs(away[1:])) < _CLOSE
    is_passed = (away[:-1] * away[1:] < 0.0) & (np.abs(np.diff(first)) < _CLOSE)
    seen = np.where(is_near | is_passed, between, np.inf)
    _nearer(item, seen, times[:-1] + share * np.diff(times))


def _nearer(item: Watched, distance: Matrix, times: Matrix) -> None:
    k = int(np.argmin(distance))
    if distance[k] < item.nearest:
        item.nearest, item.time = float(distance[k]), float(times[k])


def _triples(system: System) -> Iterator[tuple[str, tuple[Joint, Joint, Joint]]]:
    """Yield the bodies that have three turns one after the other, the middle one oblique."""
    for body in system.bodies:
        joints = list(body.joints)
        for k in range(len(joints) - _TURNS + 1):
            first, middle, third = joints[k : k + _TURNS]
            if not (
                isinstance(first, Joint) and isinstance(middle, Joint) and isinstance(third, Joint)
            ):
                continue
            before, about, after = (joint.type.turns_about for joint in (first, middle, third))
            turn = None not in (before, about, after) and about not in (before, after)
            if turn and middle.role != "driven":
                yield body.name, (first, middle, third)
