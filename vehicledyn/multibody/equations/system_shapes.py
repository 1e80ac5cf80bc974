"""What a system looks like, found from its bodies, joints, cuts and parts, as plain data.

Parts, cuts and constraints that know a look offer it by their method ``shapes``. What is left
follows from the system itself: a body is drawn by bars from its origin to the points where other
things hold on to it, else by a box of its mass and inertia; a joint by a pin along its axis.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.shapes import Shape, as_plain
from vehicledyn.multibody.elements.drawn_shapes import DrawnShapes
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.recursion.numeric_kinematics import raw_skeleton
from vehicledyn.symbolic import ops

Array = NDArray[np.float64]
Plain = dict[str, Any]

_SLENDER = 0.04
"""Radius of a bar as part of the usual extent of a body."""
_USUAL = 1.0
"""Extent of bodies that are points [m]."""
_FRAME = 4
"""Points from which on a body is drawn as the box around them, if its inertia is of their size."""
_ENCLOSING = 0.7
_FREE = 4
"""Joints to the ground from which on a body counts as free."""


def appearance(system: System, values: Sequence[float], extra: Sequence[Shape] = ()) -> Plain:
    """Return the look of a system: ``links``, ``bodies`` and ``shapes``, plain data for JSON.

    Parameters
    ----------
    system
        A checked system.
    values
        Values of the parameters, in the order of its table.
    extra
        Further shapes, such as the hull of a vehicle.
    """
    given = [*_offered(system), *extra]
    looks = [part for part in system.parts if isinstance(part, DrawnShapes)]
    raw = {
        **raw_skeleton(system),
        "own": [_own(body) for body in system.bodies],
        "shapes": [as_plain(shape) for shape in given],
        "drawn": [as_plain(shape) for part in looks for shape in part.given],
    }
    plain = _evaluated(raw, system, values)
    shapes = _distinct_planes(plain.pop("shapes"))
    own, drawn = plain.pop("own"), plain.pop("drawn")
    points = _points(own, shapes)
    thickness = _thickness(points)
    shaped = {body for part in looks for body in part.bodies}
    shaped |= {body.name for body in system.bodies if body.flexibility or body.place is not None}
    plain_bodies = [body for body in own if body["name"] not in shaped]
    bodies = _bodies(plain_bodies, shapes, points, thickness)
    found = [*shapes, *drawn, *bodies, *_joints(plain_bodies, thickness)]
    return {**plain, "shapes": [_sized(shape, own, thickness) for shape in found]}


def _offered(system: System) -> list[Shape]:
    """Return the shapes that cuts, constraints and parts offer, none that the user gives."""
    found: list[Shape] = []
    for item in (*system.cuts, *system.constraints, *system.parts):
        offer = getattr(item, "shapes", None)
        if offer is not None and not isinstance(item, DrawnShapes):
            found.extend(offer())
    return found


def _own(body: Body) -> Plain:
    joints = [j for j in body.joints if isinstance(j, Joint) and j.type.has_speed]
    return {
        "name": body.name,
        "parent": body.parent,
        "at": list(body.at),
        "joints": [joint.type.unit for joint in joints],
        "pin": next((a for j in joints[-1:] if (a := j.type.angle_about) is not None), 0),
        "mass": body.mass,
        "com": list(body.com),
        "inertia": [*body.inertia, *(0.0,) * (6 - len(body.inertia))],
    }


def _evaluated(raw: Plain, system: System, values: Sequence[float]) -> Plain:
    """Return plain data with every symbolic number replaced by its value."""
    symbols: list[Any] = []

    def collect(item: Any) -> None:
        if isinstance(item, dict):
            for value in item.values():
                collect(value)
        elif isinstance(item, list):
            for value in item:
                collect(value)
        elif not isinstance(item, str | bool | int | float | None):
            symbols.append(item)

    collect(raw)
    parameters = ops.column([entry.symbol for entry in system.table.entries])
    evaluate = ops.numeric([parameters], ops.column(symbols))
    numbers = iter(evaluate(np.asarray(values, dtype=float)).ravel().tolist())

    def replaced(item: Any) -> Any:
        if isinstance(item, dict):
            return {key: replaced(value) for key, value in item.items()}
        if isinstance(item, list):
            return [replaced(value) for value in item]
        if isinstance(item, str | bool | int | float | None):
            return item
        return next(numbers)

    plain: Plain = replaced(raw)
    return plain


def _anchors(shape: Plain) -> list[Plain]:
    """Return the points of bodies that a shape holds on to."""
    return [shape[key] for key in ("a", "b", "at") if isinstance(shape.get(key), dict)]


def _points(own: list[Plain], shapes: list[Plain]) -> dict[str, list[Array]]:
    """Return the points at which others hold on to each body."""
    points: dict[str, list[Array]] = {body["name"]: [] for body in own}
    points[GROUND] = []
    for body in own:
        points[body["parent"]].append(np.array(body["at"], dtype=float))
    for shape in shapes:
        for anchor in _anchors(shape) if shape["kind"] in ("tube", "coil", "ball") else ():
            points[anchor["body"]].append(np.array(anchor["point"], dtype=float))
    return points


def _thickness(points: Mapping[str, list[Array]]) -> float:
    """Return the radius of bars that suits the usual extent of the bodies [m]."""
    reach = [
        max(float(np.linalg.norm(p)) for p in found)
        for body, found in points.items()
        if body != GROUND and found
    ]
    usual = [r for r in reach if r > 0.0]
    return _SLENDER * float(np.median(usual)) if usual else _SLENDER * _USUAL


def _bodies(
    own: list[Plain], shapes: list[Plain], points: Mapping[str, list[Array]], thickness: float
) -> list[Plain]:
    """Return bars and boxes of the bodies that no part draws."""
    drawn = {s["at"]["body"] for s in shapes if s["kind"] in ("wheel", "box")}
    drawn |= {s["body"] for s in shapes if s["kind"] == "hull"}
    found = []
    for body in own:
        name = body["name"]
        if name in drawn or _is_reference(body):
            continue
        arms = [p for p in _unique(points[name]) if np.linalg.norm(p) > 0.5 * thickness]
        box = _box(body, thickness)
        is_first = body["parent"] == GROUND
        reach = max((float(np.linalg.norm(arm)) for arm in arms), default=0.0)
        if box and len(arms) >= _FRAME and max(box["size"]) >= _ENCLOSING * reach:
            found.append({**box, "style": "glass"})
        elif is_first and len(arms) >= _FRAME:
            found.append(_frame(name, points[name], thickness))
        elif box and (not arms or (is_first and len(body["joints"]) >= _FREE)):
            found.append(box if not arms else {**box, "style": "glass"})
        elif arms:
            found += [_tube(name, [0.0, 0.0, 0.0], arm.tolist(), "arm") for arm in arms]
        elif body["mass"]:
            ball = {"at": {"body": name, "point": body["com"]}, "radius": 2.5 * thickness}
            found.append({"kind": "ball", "name": name, **ball, "style": "body"})
    return found


def _is_reference(body: Plain) -> bool:
    """Return whether a body is but a frame that moves along, such as that of a track."""
    slides = "m" in body["joints"]
    return bool(slides and not body["mass"] and body["parent"] == GROUND)


def _unique(points: list[Array]) -> list[Array]:
    kept: list[Array] = []
    for point in points:
        if all(np.linalg.norm(point - other) > 1e-9 for other in kept):
            kept.append(point)
    return kept


def _frame(name: str, points: list[Array], thickness: float) -> Plain:
    """Return the box around the points of a body and its origin."""
    corners = np.array([np.zeros(3), *points])
    low, high = corners.min(axis=0) - thickness, corners.max(axis=0) + thickness
    return {
        "kind": "box",
        "name": name,
        "at": {"body": name, "point": (0.5 * (low + high)).tolist()},
        "size": (high - low).tolist(),
        "rotation": None,
        "style": "glass",
    }


def _box(body: Plain, thickness: float) -> Plain | None:
    """Return the homogeneous box of a body's mass and inertia, if it has both.

    A box of edges a, b, c has the inertias m (b² + c²)/12 and so on, so a² is 6/m times the sum
    of the two about the other axes less that about a.
    """
    ixx, iyy, izz, ixy, ixz, iyz = body["inertia"]
    mass = body["mass"]
    tensor = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]], dtype=float)
    if not mass or not np.all(np.isfinite(tensor)) or not np.any(tensor):
        return None
    is_diagonal = not np.any(tensor - np.diag(np.diag(tensor)))
    moments, axes = (np.diag(tensor), np.eye(3)) if is_diagonal else np.linalg.eigh(tensor)
    squares = 6.0 / mass * (moments.sum() - 2.0 * moments)
    size = np.maximum(np.sqrt(np.maximum(squares, 0.0)), 2.0 * thickness)
    if np.linalg.det(axes) < 0.0:
        axes = axes * [1.0, 1.0, -1.0]
    return {
        "kind": "box",
        "name": body["name"],
        "at": {"body": body["name"], "point": body["com"]},
        "size": size.tolist(),
        "rotation": axes.tolist(),
        "style": "body",
    }


def _joints(own: list[Plain], thickness: float) -> list[Plain]:
    """Return pins, balls and guides of the joints between bodies."""
    found = []
    for body in own:
        name, units = body["name"], body["joints"]
        turning = [unit for unit in units if unit == "rad"]
        if body["parent"] == GROUND and (len(units) >= _FREE or _is_reference(body)):
            continue
        if len(units) > len(turning):
            ends = body["at"], [0.0, 0.0, 0.0]
            found.append(_tube(name, *ends, "guide", parent=body["parent"]))
        if len(turning) == 1 and body["pin"]:
            half = [0.0, 0.0, 0.0]
            half[body["pin"] - 1] = 2.0 * thickness
            found.append(_tube(name, [-h for h in half], half, "pin"))
        elif turning:
            place = {"body": name, "point": [0.0, 0.0, 0.0]}
            found.append({"kind": "ball", "name": name, "at": place, "radius": None})
    return found


def _tube(
    name: str, a: list[float], b: list[float], style: str, *, parent: str | None = None
) -> Plain:
    return {
        "kind": "tube",
        "name": name,
        "a": {"body": parent or name, "point": a},
        "b": {"body": name, "point": b},
        "radius": None,
        "style": style,
    }


def _distinct_planes(shapes: list[Plain]) -> list[Plain]:
    """Return shapes with each plane of the ground once."""
    kept: list[Plain] = []
    for shape in shapes:
        is_plane = shape["kind"] == "plane"
        if not is_plane or all(other["kind"] != "plane" for other in kept):
            kept.append(shape)
    return kept


_RADII = {"arm": 1.0, "rod": 0.8, "pin": 1.5, "guide": 0.5, "joint": 1.6, "rubber": 2.0}


def _sized(shape: Plain, own: list[Plain], thickness: float) -> Plain:
    """Return a shape with the sizes that were left open."""
    if shape["kind"] == "hull":
        return _hull(shape, own, thickness)
    if shape["kind"] == "wheel" and shape["width"] is None:
        return {**shape, "width": 0.28 * shape["radius"]}
    if "radius" in shape and shape["radius"] is None:
        factor = 2.2 if shape["kind"] == "coil" else _RADII.get(shape.get("style", "joint"), 1.0)
        return {**shape, "radius": factor * thickness}
    return shape


def _hull(shape: Plain, own: list[Plain], thickness: float) -> Plain:
    body = next(item for item in own if item["name"] == shape["body"])
    box = _box(body, thickness)
    half = 0.5 * box["size"][2] if box else 10.0 * thickness
    bottom, top = shape["bottom"], shape["top"]
    return {
        **shape,
        "bottom": body["com"][2] - half if bottom is None else bottom,
        "top": body["com"][2] + half if top is None else top,
    }
