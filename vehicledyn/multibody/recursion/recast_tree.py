"""A tree whose deformable bodies have the coordinates that take the fewest operations."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.model.deformation import Flexibility, Station
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.tree import Link, Tree
from vehicledyn.multibody.recursion.body_inertia import BodyInertia
from vehicledyn.multibody.recursion.flexible_inertia import FlexibleInertia
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.weighted_sums import weighted_sum

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _Change:
    """A body in coordinates T q, whose names are those of q."""

    before: Flexibility
    body: Flexibility
    turn: Array

    @cached_property
    def back(self) -> Array:
        """What undoes T, without rounding where T only passes values on."""
        found = np.linalg.inv(self.turn)
        return np.where(np.abs(found) > 1e-14 * np.abs(found).max(), found, 0.0)


class RecastTree:
    """What changes of a problem where deformable bodies have other coordinates.

    Parameters
    ----------
    tree
        The tree as it is described.
    free
        Coordinates whose accelerations are asked for. Only bodies all of whose coordinates are
        among them change.
    """

    def __init__(self, tree: Tree, free: Collection[str]) -> None:
        """Ask each body whether it has such coordinates."""
        self._changes: list[_Change] = []
        for link in tree.links:
            body = link.flexibility
            found = body.recast if body is not None and set(body.coordinates) <= set(free) else None
            if body is not None and found is not None:
                self._changes.append(_Change(body, *found))
        self._of = {id(change.before): change for change in self._changes}
        self._tree = Tree(tuple(map(self._link, tree.links)), tree.body_link)

    @property
    def is_needed(self) -> bool:
        """Whether anything changes."""
        return bool(self._changes)

    def _link(self, item: Link) -> Link:
        change = self._of.get(id(item.flexibility))
        if change is not None and item.body is not None:
            return replace(item, body=replace(item.body, flexibility=change.body))
        change = None if item.station is None else self._of.get(id(item.station.flexibility))
        if change is None or item.station is None:
            return item
        return replace(item, station=Station(change.body, item.station.place))

    def kinematics(self, given: Kinematics) -> Kinematics:
        """Return the same motion; how points move does not depend on the coordinates."""
        moved: dict[str, tuple[Scalar, Scalar]] = {}
        for change in self._changes:
            motions = [given.joint_motion(name) for name in change.body.coordinates]
            places, rates, _ = zip(*motions, strict=True)
            values = (_product(change.turn, places), _product(change.turn, rates))
            moved |= dict(zip(change.body.coordinates, zip(*values, strict=True), strict=True))
        found = given.on(self._tree, moved)
        for link, item in enumerate(given.tree.links):
            if item.station is not None and id(item.station.flexibility) in self._of:
                found.learn_motion(link, given)
        return found

    def inertias(self, given: Sequence[BodyInertia]) -> list[BodyInertia]:
        """Return the inertias of the links."""
        links = zip(self._tree.links, given, strict=True)
        return [
            own if k.flexibility is None else FlexibleInertia(k.flexibility) for k, own in links
        ]

    def forces(self, given: Mapping[str, Scalar]) -> dict[str, Scalar]:
        """Return forces on the coordinates, or derivatives by them."""
        found = dict(given)
        for change in self._changes:
            names = change.body.coordinates
            known = [ops.scalar(given.get(name, 0.0)) for name in names]
            if any(not value.is_zero() for value in known):
                found |= dict(zip(names, _product(change.back.T, known), strict=True))
        return found

    def accelerations(self, found: Mapping[str, Scalar]) -> dict[str, Scalar]:
        """Return the accelerations of the coordinates as they are described."""
        described = dict(found)
        for change in self._changes:
            names = change.body.coordinates
            values = _product(change.back, [found[name] for name in names])
            described |= dict(zip(names, values, strict=True))
        return described


def _product(matrix: Array, values: Sequence[Scalar]) -> list[Scalar]:
    return [weighted_sum(row, values) for row in matrix]
