"""Critical values of a hunting study, and what each of them is."""

from __future__ import annotations

import math
from collections.abc import Sequence

from vehicledyn.analyse.periodic.critical import Divergence, Hopf
from vehicledyn.analyse.periodic.cycle_points import Branch

_EDGE = 1e-9
"""Part of the range within which a value is that of its end."""

_LOCATED = 1e-6
"""Part of the range to which folds and bifurcations are located."""

_APART, _NARROW = 5e-3, 0.2
"""Distance of the smallest cycle from its Hopf bifurcation, part of the range, that is worth a
remark, and part of the value that a range counts as at least."""

_KINDS = {
    "fold": "fold",
    "torus": "torus bifurcation",
    "period_doubling": "period doubling",
    "branch_point": "branch point",
}


def of_equilibria(hopfs: Sequence[Hopf], divergences: Sequence[Divergence]) -> dict[str, float]:
    """Return the lowest values at which equilibria lose or regain stability, by name."""
    figures = {}
    for key, begins in (("linear_critical", True), ("oscillation_ceases", False)):
        found = [h for h in hopfs if h.begins is begins]
        if found:
            lowest = min(found, key=lambda h: h.balance.value)
            figures[key] = lowest.balance.value
            figures[f"{key}_frequency"] = lowest.frequency / (2.0 * math.pi)
    for key, begins in (("divergence_begins", True), ("divergence_ceases", False)):
        values = [d.value for d in divergences if d.begins is begins]
        if values:
            figures[key] = min(values)
    return figures


def lowest_stable(
    branches: Sequence[Branch], span: tuple[float, float]
) -> tuple[float, str] | None:
    """Return the lowest value in a range with a stable cycle and what it is, None without one.

    A branch of stable cycles ends at a fold or at another change of stability, both between its
    points; else the range or what was followed ends there. Cycles of linear motions, which stand
    beside each other at any amplitude, are no limit cycles.
    """
    stable = [
        (point.orbit.parameter, number, k)
        for number, branch in enumerate(branches, 1)
        if branch.ending != "linear"
        for k, point in enumerate(branch.points)
        if point.stable and span[0] <= point.orbit.parameter <= span[1]
    ]
    if not stable:
        return None
    value, number, k = min(stable)
    points = branches[number - 1].points
    name = f"branch {number}"
    if points[k].kind:
        return value, f"{_KINDS[points[k].kind]} of {name}"
    most = value + _LOCATED * (span[1] - span[0])
    beside = [p for p in points[max(0, k - 1) : k + 2] if p.kind and p.orbit.parameter <= most]
    if beside:
        nearest = max(beside, key=lambda p: p.orbit.parameter)
        return nearest.orbit.parameter, f"{_KINDS[nearest.kind]} of {name}"
    if value - span[0] <= _EDGE * (span[1] - span[0]):
        return value, f"{name} reaches the lower end of the range with stable cycles"
    place = {0: "first", len(points) - 1: "last"}.get(k, "lowest")
    return value, f"{place} cycle of {name}"


def far_from(
    hopf: Hopf, branch: Branch, number: int, *, amplitude: float, span: tuple[float, float]
) -> str:
    """Return a remark where the smallest cycle lies far from its Hopf bifurcation, else nothing.

    Smooth equations have it at a distance of the order of the amplitude squared. Where a law bends
    at rest the linear critical value holds for still smaller oscillations only.
    """
    if not branch.points:
        return ""
    begin, first = hopf.balance.value, branch.points[0].orbit.parameter
    if abs(first - begin) <= _APART * max(span[1] - span[0], _NARROW * abs(begin)):
        return ""
    return (
        f"branch {number} begins at {first:.6g} with an amplitude of {amplitude:g}, far from the "
        f"Hopf bifurcation at {begin:.6g}: the equations are not linear even in so small a motion, "
        "and the linear critical value holds for still smaller ones only"
    )
