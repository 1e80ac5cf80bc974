"""Nets of rods: points with mass in a grid, massless rods between neighbours."""

import numpy as np

from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System
from vehicledyn.multibody.model.cuts import RodCut

LENGTH, MASS = 0.5, 1.0


def places(rows, columns, bend):
    """Return the points of a grid in a plane, each moved a little off it."""
    aside = np.random.default_rng(3)
    return {
        (i, j): np.array([LENGTH * i, LENGTH * j, 0.0]) + bend * aside.normal(size=3)
        for i in range(rows)
        for j in range(columns)
    }


def net(rows, columns, *, pinned=(), bend=0.05, rates=None, method="auto"):
    """Return a net, pinned at some of its points, with the rates that a function of place gives."""
    at = places(rows, columns, bend)
    bodies = tuple(_point(key, place, rates, key in pinned) for key, place in at.items())
    pairs = [((i, j), (i + 1, j)) for i in range(rows - 1) for j in range(columns)]
    pairs += [((i, j), (i, j + 1)) for i in range(rows) for j in range(columns - 1)]
    cuts = tuple(
        RodCut(
            f"rod_{a[0]}_{a[1]}_{b[0]}_{b[1]}",
            name(a),
            (0.0, 0.0, 0.0),
            name(b),
            (0.0, 0.0, 0.0),
            float(np.linalg.norm(at[a] - at[b])),
        )
        for a, b in pairs
    )
    return System("net", ParameterTable(), bodies, cuts=cuts, constraint_method=method)


def name(key):
    return f"p{key[0]}_{key[1]}"


def _point(key, place, rates, is_pinned):
    speed = np.zeros(3) if rates is None else rates(place)
    joints = tuple(
        Joint(
            f"T{k + 1}",
            f"{name(key)}.{'xyz'[k]}",
            start=float(place[k]),
            start_rate=float(speed[k]),
            role="driven" if is_pinned else "auto",
        )
        for k in range(3)
    )
    return Body(name(key), GROUND, joints=joints, mass=MASS)


def net_text(rows, columns, *, pinned, bend=0.05):
    """Return the system file of the same net; points that are pinned are places on the ground."""
    at = places(rows, columns, bend)
    lines = ["title: A net of rods", "bodies:"]
    for key, place in at.items():
        if key not in pinned:
            starts = ", ".join(
                f"{{kind: T{k + 1}, name: {axis}, start: {float(x)!r} m}}"
                for k, (axis, x) in enumerate(zip("xyz", place, strict=True))
            )
            lines += [f"  {name(key)}:", f"    joints: [{starts}]", f"    mass: {MASS} kg"]
    lines.append("cuts:")
    pairs = [((i, j), (i + 1, j)) for i in range(rows - 1) for j in range(columns)]
    pairs += [((i, j), (i, j + 1)) for i in range(rows) for j in range(columns - 1)]
    for a, b in pairs:
        ends = []
        for key in (a, b):
            fixed = ", ".join(f"{float(x)!r} m" for x in at[key])
            is_fixed = key in pinned
            body = f"ground, point: [{fixed}]" if is_fixed else name(key)
            ends.append(f"{{body: {body}}}")
        length = float(np.linalg.norm(at[a] - at[b]))
        lines += [
            f"  rod_{a[0]}{a[1]}_{b[0]}{b[1]}:",
            "    kind: rod",
            f"    a: {ends[0]}",
            f"    b: {ends[1]}",
            f"    length: {length!r} m",
        ]
    return "\n".join(lines) + "\n"
