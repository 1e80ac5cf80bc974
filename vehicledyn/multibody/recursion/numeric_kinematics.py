"""The tree of a system as numbers: poses of all bodies from the coordinates, many at once.

A pose is the position of the body's origin and the unit quaternion (w, x, y, z) of its axes, both
in world axes. Where the last joint of a body turns, its angle is kept apart as a turn about an
axis of the pose: that stays exact between two pictures, however fast a wheel spins.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.numbers.quaternions import about, from_rows, multiplied, rotated
from vehicledyn.multibody.bodies.drawn_beam import deflected_exactly
from vehicledyn.multibody.joints.joint_type import JointType, joint_type
from vehicledyn.multibody.joints.numeric_joint import displacements, quaternions
from vehicledyn.multibody.model.deformation import Station
from vehicledyn.multibody.model.symbols import declare, locked
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import unfold

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Poses:
    """Poses of bodies at n moments.

    ``position`` (n, bodies, 3) [m], ``quaternion`` (n, bodies, 4), and the ``turn`` (n, bodies)
    about the axis of each body [rad], zero for bodies without one.
    """

    position: Array
    quaternion: Array
    turn: Array


@dataclass(frozen=True)
class Skeleton:
    """The links of a tree with numbers, parents first, and the bodies that they end in.

    ``links`` are mappings with parent, offset, before, after (rows or None), kind and settings of
    the joint, its coordinate (or value where it is locked); ``bodies`` have name, link, axis (0 for
    none) and ``axes_spin``: whether the axes turn with the last joint.
    """

    links: tuple[Mapping[str, Any], ...]
    bodies: tuple[Mapping[str, Any], ...]

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates that the poses follow from."""
        names = [
            n
            for link in self.links
            for n in (link["coordinate"], *link.get("positions", ()), *_amplitudes(link))
        ]
        return tuple(dict.fromkeys(name for name in names if name))

    def poses(self, values: Mapping[str, Array]) -> Poses:
        """Return the poses of all bodies.

        Parameters
        ----------
        values
            Values of each coordinate, shape (n,).
        """
        count = len(next(iter(values.values()))) if values else 1
        origin = np.zeros((count, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
        after: list[tuple[Array, Array]] = []
        before: list[tuple[Array, Array]] = []
        for link in self.links:
            position, turned = after[link["parent"]] if link["parent"] >= 0 else origin
            if any(link["offset"]):
                position = position + rotated(turned, np.array(link["offset"], dtype=float))
            turned = _turned(turned, link["before"])
            value = _value(link, values, count)
            joint = _type(link)
            slide = None if joint is None else displacements(joint, value)
            if slide is not None:
                position = position + rotated(turned, slide)
            if "point" in link:
                position, turned = _deflected(link["point"], position, turned, values)
            before.append((position, turned))
            if link.get("positions"):
                value = np.stack([values[name] for name in link["positions"]], axis=1)
            turn = None if joint is None or link["ignored"] else quaternions(joint, value)
            if turn is not None:
                turned = multiplied(turned, turn)
            after.append((position, _turned(turned, link["after"])))
        chosen, turns = [], []
        for body in self.bodies:
            link = body["link"]
            chosen.append(before[link] if body["axis"] else after[link])
            turns.append(
                _value(self.links[link], values, count) if body["axis"] else np.zeros(count)
            )
        return Poses(
            np.stack([position for position, _ in chosen], axis=1),
            np.stack([quaternion for _, quaternion in chosen], axis=1),
            np.stack(turns, axis=1),
        )


def _amplitudes(link: Mapping[str, Any]) -> list[str]:
    """Return the coordinates of the deformation that moves a link."""
    names: list[str] = link.get("point", {}).get("names", [])
    return names


def _deflected(
    point: Mapping[str, Any], position: Array, turned: Array, values: Mapping[str, Array]
) -> tuple[Array, Array]:
    """Return position and attitude of a point of a body that deforms."""
    q = np.stack([values[name] for name in point["names"]], axis=1)
    if "nodes" in point:
        moved, attitude = deflected_exactly(point, q)
        return position + rotated(turned, moved), multiplied(turned, attitude)
    if "turns" in point:
        at, linear, turns = (
            np.array(point[word], dtype=float) for word in ("position", "linear", "turns")
        )
        gibbs = np.column_stack([np.ones(len(q)), 0.5 * (q @ turns.T)])
        gibbs /= np.linalg.norm(gibbs, axis=1, keepdims=True)
        moved = at + q @ linear.T
        if "curved" in point:
            moved += 0.5 * np.einsum("ni,aij,nj->na", q, np.array(point["curved"], dtype=float), q)
        return position + rotated(turned, moved), multiplied(turned, gibbs)
    place, linear, quadratic, slopes = (
        np.array(point[word], dtype=float) for word in ("position", "linear", "quadratic", "slopes")
    )
    moved = place + q @ linear.T
    moved[:, 0] += np.einsum("ni,ij,nj->n", q, quadratic, q)
    if "steep" in point:
        leans = np.einsum("dpi,ni->dpn", np.array(point["steep"], dtype=float), q)
        e = (leans * leans).sum(axis=0)
        moved[:, 0] += np.array(point["drawn_back"], dtype=float) @ (e * e * (2.0 + e) / 16.0)
    twist, about_y, about_z = (q @ slopes.T).T
    along = np.sqrt(np.maximum(1.0 - about_y**2 - about_z**2, 0.0))
    bend = np.stack([1.0 + along, np.zeros_like(along), about_y, about_z], axis=1)
    bend /= np.linalg.norm(bend, axis=1, keepdims=True)
    spin = about(np.array([1.0, 0.0, 0.0]), twist)
    return position + rotated(turned, moved), multiplied(multiplied(turned, bend), spin)


def _turned(quaternions: Array, rows: Any) -> Array:
    """Return quaternions turned on by a rotation matrix, None for no rotation."""
    return quaternions if rows is None else multiplied(quaternions, from_rows(rows))


def raw_skeleton(system: System) -> dict[str, Any]:
    """Return links and bodies of a system as plain data whose numbers may still be symbols."""
    tree, symbols = unfold(system.bodies), declare(system)
    fixed = locked(system, symbols)
    links = []
    for link in tree.links:
        joint = link.joint
        is_fixed = joint is not None and joint.name in fixed
        paired = joint is not None and not joint.siblings
        links.append(
            {
                "parent": link.parent,
                "offset": [link.offset[k] for k in range(3)],
                "before": _rows(link.before),
                "after": _rows(link.after),
                "kind": joint.kind if joint else None,
                "coordinate": joint.name if joint and not is_fixed and paired else None,
                "value": joint.start if joint and is_fixed else 0.0,
                **({"settings": dict(joint.settings)} if joint and joint.settings else {}),
                **({"positions": list(joint.positions)} if joint and joint.siblings else {}),
                **({} if link.station is None else {"point": _point(link.station, fixed)}),
                "ignored": link.is_ignorable_spin,
            }
        )
    bodies = []
    for body in system.bodies:
        if body.is_abstract:
            continue
        index = tree.body_link[body.name]
        last = tree.links[index]
        pin = last.type.angle_about if last.type is not None and last.after is None else None
        bodies.append(
            {
                "name": body.name,
                "link": index,
                "axis": pin or 0,
                "axes_spin": not last.is_ignorable_spin,
            }
        )
    return {"links": links, "bodies": bodies}


def _point(station: Station, fixed: set[str]) -> dict[str, Any]:
    """Return a point of a deformable body as plain data, without coordinates that are held."""
    drawn, names = station.flexibility.drawn(station.place), station.flexibility.coordinates
    kept = [k for k, name in enumerate(names) if name not in fixed]
    if "nodes" in drawn:
        nodes = [[[row[k] for k in kept] for row in node] for node in drawn["nodes"]]
        end = [[row[k] for k in kept] for row in drawn["end"]]
        own = [names[k] for k in kept]
        unloaded = {"turns": drawn["turns"]} if "turns" in drawn else {}
        return {"names": own, "nodes": nodes, "weights": drawn["weights"], "end": end, **unloaded}
    words = [word for word in ("linear", "slopes", "turns") if word in drawn]
    rows: dict[str, Any] = {word: [[row[k] for k in kept] for row in drawn[word]] for word in words}
    if "turns" in drawn:
        own = [names[k] for k in kept]
        if "curved" in drawn:
            rows["curved"] = [
                [[row[j] for j in kept] for row in (axis[i] for i in kept)]
                for axis in drawn["curved"]
            ]
        return {"names": own, "position": drawn["position"], **rows}
    rows["quadratic"] = [[drawn["quadratic"][i][j] for j in kept] for i in kept]
    if "steep" in drawn:
        rows["steep"] = [[[row[k] for k in kept] for row in plane] for plane in drawn["steep"]]
        rows["drawn_back"] = drawn["drawn_back"]
    own = [names[k] for k in kept]
    return {"names": own, "position": drawn["position"], **rows}


def skeleton_from(plain: Mapping[str, Any]) -> Skeleton:
    """Return a skeleton from plain data with numbers."""
    return Skeleton(tuple(plain["links"]), tuple(plain["bodies"]))


def _type(link: Mapping[str, Any]) -> JointType | None:
    return None if link["kind"] is None else joint_type(link["kind"], link.get("settings", {}))


def _value(link: Mapping[str, Any], values: Mapping[str, Array], count: int) -> Array:
    if link["coordinate"]:
        return np.asarray(values[link["coordinate"]], dtype=float)
    return np.full(count, float(link["value"]))


def _rows(matrix: Any) -> list[list[Any]] | None:
    if matrix is None:
        return None
    return [[matrix[i, j] for j in range(3)] for i in range(3)]
