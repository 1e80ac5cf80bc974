"""Motions that no inertia resists: where the mass matrix is singular, and by which coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.equations.deformable_rows import DeformableRows, DeformedNumbers, roots
from vehicledyn.multibody.equations.effective_inertia import (
    LinkNumbers,
    body_rows,
    first_negative,
    smallest_share,
)
from vehicledyn.multibody.loops.closure import Closure, MultiplierClosure
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.symbols import Symbols
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import Tree
from vehicledyn.multibody.recursion.inertia import matrix_of
from vehicledyn.symbolic import ops

Array = NDArray[np.float64]
SINGULAR = 1e-8
"""Share of the inertia of its coordinates that a motion must have at least [1].

It is the root of a share of mass: below, the mass matrix is singular to rounding.
"""

_ASIDE = 0.3
"""Largest step to the configurations that distinguish a singular place from a singular system."""
_ROUNDING = 1e-13
_SHOWN = 1e-3
_PER_LINK = 18

_DENSE = 150
"""Most independent coordinates whose motions are always compared all at once.

That costs the cube of their number, and finds motions together as well as joints by themselves.
"""

_NAMED = 8
"""Most coordinates or bodies of a motion that are named."""


@dataclass(frozen=True)
class Idle:
    """A motion that nothing resists: the share of each independent coordinate's rate in it.

    One that ``is_negative`` has a negative kinetic energy, by negative reflected inertias.
    """

    shares: dict[str, float]
    is_negative: bool = False

    @property
    def remedy(self) -> str:
        """What to do about it where it is so in any configuration."""
        if self.is_negative:
            return "lower the amounts of the negative reflected inertias of its coordinates"
        return "give mass or inertia to what this motion moves, or drive or drop a coordinate of it"

    def words(self, owners: dict[str, str]) -> str:
        """Return the motion in words; ``owners`` are the bodies of the coordinates."""
        names = [f"'{name}'" for name in self.shares]
        bodies = list(dict.fromkeys(f"'{owners[name]}'" for name in self.shares))
        held = f"{'body' if len(bodies) == 1 else 'bodies'} {_listed(bodies)}"
        together = " moving together" if len(names) > 1 else ""
        if self.is_negative:
            moves = "move" if len(names) > 1 else "moves"
            return f"negative reflected inertias outweigh what {_listed(names)} of {held} {moves}"
        return f"nothing resists {_listed(names)} of {held}{together}"


class Resistance:
    """The inertia that the motions of a system have, as numbers.

    With M = Aᵀ A, one block of rows of A a body, and q̇ = T q̇_v of the constraints, the motions
    without inertia are those that A T maps to zero. The rank of A T is found where that of M
    would drown in rounding.
    """

    def __init__(
        self,
        system: System,
        tree: Tree,
        symbols: Symbols,
        closure: Closure | MultiplierClosure,
        free: Sequence[int],
    ) -> None:
        """Take kinematics and constraints; ``free`` are the independent coordinates."""
        self._links, self.joints, self._free = tree.links, symbols.joints, list(free)
        entries = system.table.entries
        self._values = np.array([entry.value for entry in entries])
        inputs = [symbols.time, symbols.coordinate_column, ops.column([e.symbol for e in entries])]
        kinematics = Kinematics(tree, symbols.coordinates, symbols.rates)
        self._frames = ops.numeric(inputs, _frames(kinematics, len(tree.links)))
        self._masses = ops.numeric(inputs, _masses(system))
        self._reflected_names = list(tree.reflected_inertias)
        self._reflected = ops.numeric(inputs, ops.column([*tree.reflected_inertias.values()]))
        self._deformable = DeformableRows(kinematics, inputs)
        self._body_links = [tree.body_link[b.name] for b in system.bodies if b.mass is not None]
        self._pairs = closure.partition.pairs
        rows = [closure.jacobian[row] for row, _ in self._pairs]
        self._places = [(i, j) for i, row in enumerate(rows) for j in row]
        self._slopes = ops.numeric(inputs, ops.column([v for row in rows for v in row.values()]))
        self._index = {j.name: k for k, j in enumerate(symbols.joints)}

    def idle(
        self, time: float, q: Array, parameters: Array | None = None, *, share: float = SINGULAR
    ) -> list[Idle]:
        """Return the motions that nothing resists at a configuration.

        Parameters
        ----------
        time, q
            Time [s] and all coordinates, shape (n_coordinates,).
        parameters
            Values of the parameters; those of the system if None.
        share
            Share of the inertia of its coordinates below which a motion counts [1].
        """
        values = self._values if parameters is None else parameters
        if self._is_large_tree:
            links = self._link_numbers(time, q, values)
            if smallest_share(*links) > share:
                return self._negative_joint(*links)
        with np.errstate(over="ignore", invalid="ignore"):
            moved = self._inertial(time, q, values) @ self._transfer(time, q, values)
        if not moved.shape[1] or not np.isfinite(moved).all():
            return []
        moved = moved / (np.abs(moved).max() or 1.0)  # whose squares do not overflow
        sizes = np.linalg.norm(moved, axis=0)
        moving = sizes > _ROUNDING * sizes.max(initial=0.0)
        scaled = np.where(moving, moved, 0.0) / np.where(moving, sizes, 1.0)
        _, found, motions = np.linalg.svd(np.linalg.qr(scaled, mode="r"))
        rank = int(np.sum(found > share))
        idle = [self._named(vector) for vector in _sparse(motions[rank:])]
        return idle or self._negative_motion(time, q, values)

    @property
    def _is_large_tree(self) -> bool:
        """Whether there are too many joints for a factorisation that knows nothing of the tree."""
        return not self._pairs and len(self._free) > _DENSE

    def _negative_joint(
        self, links: Sequence[LinkNumbers], bodies: Mapping[int, Array]
    ) -> list[Idle]:
        """Return the coordinate of a tree at which the mass matrix is not positive definite."""
        if all(item.reflected >= 0.0 for item in links):
            return []
        found = first_negative(links, bodies)
        return [] if found is None else [Idle({self._links[found].name: 1.0}, is_negative=True)]

    def _negative_motion(self, time: float, q: Array, values: Array) -> list[Idle]:
        """Return the motion with the most negative kinetic energy, if any has such.

        With the energies ½ |G v|² of all that is positive and -½ |N v|² of negative reflected
        inertias, and G = Q R, those of N R⁻¹ must be below one.
        """
        reflected = self._reflected_numbers(time, q, values)
        negative = {name: value for name, value in reflected.items() if value < 0.0}
        if not negative:
            return []
        transfer = self._transfer(time, q, values)
        moved = self._inertial(time, q, values) @ transfer
        root: Array = np.asarray(np.linalg.qr(moved, mode="r"))
        rows = np.zeros((len(negative), len(self.joints)))
        for row, (name, value) in zip(rows, negative.items(), strict=True):
            row[self._index[name]] = np.sqrt(-value)
        compared = np.linalg.solve(root.T, (rows @ transfer).T).T
        _, sizes, motions = np.linalg.svd(compared)
        if sizes[0] < 1.0:
            return []
        motion = np.linalg.solve(root, motions[0])
        return [Idle(self._named(motion).shares, is_negative=True)]

    def _reflected_numbers(self, time: float, q: Array, values: Array) -> dict[str, float]:
        """Return the reflected inertias by coordinate [kg, kg m²]."""
        numbers = self._reflected(time, q, values).ravel()
        return dict(zip(self._reflected_names, map(float, numbers), strict=True))

    def _link_numbers(
        self, time: float, q: Array, values: Array
    ) -> tuple[list[LinkNumbers], dict[int, Array]]:
        """Return links and bodies of a tree in numbers."""
        reflected = self._reflected_numbers(time, q, values)
        frames = self._frames(time, q, values).reshape(-1, _PER_LINK)
        free = {self.joints[k].name for k in self._free}
        links = []
        for item, numbers in zip(self._links, frames, strict=True):
            is_free = item.joint is not None and item.joint.name in free
            rotation, arm, motion = numbers[:9].reshape(3, 3), numbers[9:12], numbers[12:18]
            own = reflected.get(item.name, 0.0)
            links.append(LinkNumbers(item.parent, rotation, arm, motion if is_free else None, own))
        masses = self._masses(time, q, values).reshape(-1, 13)
        bodies = {
            link: body_rows(row[0], row[1:4], row[4:].reshape(3, 3))
            for link, row in zip(self._body_links, masses, strict=True)
        }
        return links, bodies

    def anywhere(self, time: float, q: Array) -> list[Idle]:
        """Return the motions that nothing resists at a configuration nor anywhere about it."""
        found = self.idle(time, q)
        for seed in (1.0, 2.0):
            if not found:
                break
            aside = q + _ASIDE * np.cos(seed * np.arange(1.0, q.size + 1.0) ** 2)
            found = found if self.idle(time, aside) else []
        return found

    def _named(self, vector: Array) -> Idle:
        largest = float(np.abs(vector).max())
        return Idle(
            {
                self.joints[k].name: float(x / largest)
                for k, x in zip(self._free, vector, strict=True)
                if abs(x) > _SHOWN * largest
            }
        )

    def _inertial(self, time: float, q: Array, values: Array) -> Array:
        """Return A: what each rate gives the bodies, times the roots of their inertia."""
        deformed = self._deformable.at(time, q, values)
        origins, rotations, columns = self._moved(time, q, values, deformed)
        blocks = [np.zeros((1, len(self.joints)))]
        masses = self._masses(time, q, values).reshape(-1, 13)
        for link, numbers in zip(self._body_links, masses, strict=True):
            if link in deformed.masses:
                own = [self._index[name] for name in self._deformable.names(link)]
                frame = (rotations[link], origins[link])
                blocks.append(roots(deformed.masses[link], frame, columns[link], own))
                continue
            turning, sliding = columns[link]
            matrix = numbers[4:].reshape(3, 3)
            sizes, axes = np.linalg.eigh(matrix)
            com = origins[link] + rotations[link] @ numbers[1:4]
            velocity = sliding + np.cross(turning.T, com).T
            blocks.append(np.sqrt(max(numbers[0], 0.0)) * velocity)
            local = (rotations[link] @ axes).T @ turning
            blocks.append(np.sqrt(np.maximum(sizes, 0.0))[:, None] * local)
        for name, value in self._reflected_numbers(time, q, values).items():
            if value > 0.0:
                row = np.zeros((1, len(self.joints)))
                row[0, self._index[name]] = np.sqrt(value)
                blocks.append(row)
        return np.vstack(blocks)

    def _moved(
        self, time: float, q: Array, values: Array, deformed: DeformedNumbers
    ) -> tuple[list[Array], list[Array], list[tuple[Array, Array]]]:
        """Return origins, rotations and (ω, v of the point at the world's origin) by q̇."""
        frames = self._frames(time, q, values).reshape(-1, _PER_LINK)
        origins: list[Array] = []
        rotations: list[Array] = []
        columns: list[tuple[Array, Array]] = []
        none = np.zeros((3, len(self.joints)))
        for link, (item, numbers) in enumerate(zip(self._links, frames, strict=True)):
            first = item.parent < 0
            base = np.eye(3) if first else rotations[item.parent]
            rotations.append(base @ numbers[:9].reshape(3, 3))
            start = np.zeros(3) if first else origins[item.parent]
            origins.append(start + base @ numbers[9:12])
            turning, sliding = (none, none) if first else columns[item.parent]
            if item.joint is not None:
                angular, linear = (rotations[-1] @ numbers[k : k + 3] for k in (12, 15))
                turning, sliding = turning.copy(), sliding.copy()
                column = self._index[item.joint.name]
                turning[:, column] = angular
                sliding[:, column] = np.cross(origins[-1], angular) + linear
            if link in deformed.stations:
                angular, linear = np.split(deformed.stations[link], 2)
                own = [self._index[name] for name in self._deformable.names(link)]
                turning, sliding = turning.copy(), sliding.copy()
                turning[:, own] += rotations[-1] @ angular
                sliding[:, own] += rotations[-1] @ linear
                sliding[:, own] += np.cross(origins[-1], (rotations[-1] @ angular).T).T
            columns.append((turning, sliding))
        return origins, rotations, columns

    def _transfer(self, time: float, q: Array, values: Array) -> Array:
        """Return T of q̇ = T q̇_v, shape (n_coordinates, n_independent)."""
        transfer = np.zeros((q.size, len(self._free)))
        transfer[self._free, range(len(self._free))] = 1.0
        if self._pairs and self._free:
            slopes = np.zeros((len(self._pairs), q.size))
            entries = self._slopes(time, q, values)[:, 0]
            for (i, j), value in zip(self._places, entries, strict=True):
                slopes[i, j] = value
            columns = [column for _, column in self._pairs]
            right = -slopes[:, self._free]
            transfer[columns] = np.linalg.lstsq(slopes[:, columns], right, rcond=None)[0]
        return transfer


def refuse_idle(system: System, found: Sequence[Idle]) -> None:
    """Raise InputError for motions that nothing resists in any configuration."""
    if not found:
        return
    owners = owners_of(system)
    listed = "; ".join(idle.words(owners) for idle in found)
    names = tuple(name for idle in found for name in idle.shares)
    raise InputError(
        f"system '{system.name}': the mass matrix is {state_of(found)}: {listed}; "
        f"{found[0].remedy}",
        about=(*(owners[name] for name in names), *names),
    )


def state_of(found: Sequence[Idle]) -> str:
    """Return what the mass matrix is where motions are not resisted."""
    return "not positive definite" if found[0].is_negative else "singular"


def owners_of(system: System) -> dict[str, str]:
    """Return the body of each coordinate by name."""
    return {j.name: b.name for b in system.bodies for j in b.joints if isinstance(j, Joint)}


def _frames(kinematics: Kinematics, count: int) -> ops.Scalar:
    """Return rotation, arm, angular and linear axis of each link in one column."""
    numbers: list[ops.Scalar] = []
    for link in range(count):
        rotation, arm = kinematics.link_rotation(link), kinematics.link_arm(link)
        axes, none = kinematics.link_axes(link), ops.vector(0.0, 0.0, 0.0)
        numbers += [rotation[i, j] for i in range(3) for j in range(3)]
        for vector in (arm, axes.angular, axes.linear):
            numbers += [(none if vector is None else vector)[k] for k in range(3)]
    return ops.column(numbers)


def _masses(system: System) -> ops.Scalar:
    """Return mass, centre of mass and inertia matrix of each body with mass in one column."""
    numbers: list[ops.Scalar] = []
    for body in system.bodies:
        if body.mass is not None:
            matrix = matrix_of(body.inertia)
            numbers += [body.mass, *body.com, *(matrix[i, j] for i in range(3) for j in range(3))]
    return ops.column(numbers)


def _sparse(motions: Array) -> list[Array]:
    """Return combinations of motions in which as few coordinates move as may be."""
    rows = motions.copy()
    for k in range(len(rows)):
        pivot = int(np.argmax(np.abs(rows[k])))
        rows[k] /= rows[k, pivot]
        for other in range(len(rows)):
            if other != k:
                rows[other] -= rows[k] * rows[other, pivot]
    return list(rows)


def _listed(words: Sequence[str]) -> str:
    if len(words) > _NAMED:
        words = [*words[: _NAMED - 1], f"{len(words) - _NAMED + 1} more"]
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
