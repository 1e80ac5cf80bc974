"""Rates to start with: those that were given, for whichever coordinates, and what follows."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.projection import projected
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import shown
from vehicledyn.kernel.kernel import Kernel

Vector = NDArray[np.float64]
_AGREE = 1e-9


def start_rates(
    kernel: Kernel, given: Mapping[str, float], time: float, state: Vector, unknowns: Vector
) -> Vector:
    """Return a state whose rates agree with those that were given.

    The rates of all coordinates are linear in the independent ones, at a given position. Those
    that were given stay, others are chosen as small as may be. With multipliers, where all rates
    are states, those returned fulfil the constraints.

    Parameters
    ----------
    kernel
        The model.
    given
        Rate of each coordinate for which one was given, by the coordinate's name, in SI.
    time
        Time [s].
    state, unknowns
        The start; its positions fulfil the constraints.

    Raises
    ------
    InputError
        If the given rates contradict the constraints or each other; each is named.
    """
    e = kernel.equations
    names = [e.states[k].name.removesuffix("_rate") for k in e.velocities]
    channels = {c.name: k for k, c in enumerate(e.channels)}
    # With multipliers the rates of all coordinates are states, and the constraints change them.
    all_free = e.structure.get("constraint_method") == "multipliers"
    following = [n for n in given if (all_free or n not in names) and f"{n}_rate" in channels]
    if not following:
        return _on_constraints(kernel, time, state, unknowns) if all_free else state
    rows = [channels[f"{name}_rate"] for name in following]
    wanted = np.array([given[name] for name in following])
    pairs = zip(e.velocities, names, strict=True)
    free = [k for k, name in pairs if all_free or name not in given]
    found = state.copy()

    def rates() -> Vector:
        return np.array(kernel.outputs(time, found, unknowns))[rows]

    if all_free and np.all(np.abs(rates() - wanted) <= _AGREE * (1.0 + np.abs(wanted))):
        return _on_constraints(kernel, time, found, unknowns)
    found[free] = 0.0
    base, slopes = rates(), np.zeros((len(rows), len(free)))
    for column, index in enumerate(free):
        found[index] = 1.0
        slopes[:, column] = rates() - base
        found[index] = 0.0
    if free:
        found[free] = np.linalg.lstsq(slopes, wanted - base, rcond=1e-10)[0]
    missed = np.abs(rates() - wanted)
    if np.any(missed > _AGREE * (1.0 + np.abs(wanted))):
        about = [
            f"{n}_rate"
            for n, m, w in zip(following, missed, wanted, strict=True)
            if m > _AGREE * (1.0 + abs(w))
        ]
        raise InputError(_contradiction(kernel, following, wanted, rates()), about=about)
    return _on_constraints(kernel, time, found, unknowns) if all_free else found


def _on_constraints(kernel: Kernel, time: float, state: Vector, unknowns: Vector) -> Vector:
    return projected(kernel, state, kernel.outputs(time, state, unknowns))


def _contradiction(kernel: Kernel, names: list[str], wanted: Vector, rates: Vector) -> str:
    units = {c.name: c.unit for c in kernel.equations.channels}
    lines = [
        f"  - '{name}' is given {shown(float(w), units[f'{name}_rate'])}, the constraints and the "
        f"other rates make it {shown(float(r), units[f'{name}_rate'])}"
        for name, w, r in zip(names, wanted, rates, strict=True)
        if abs(w - r) > _AGREE * (1.0 + abs(w))
    ]
    return "\n".join(["the start is inconsistent: rates contradict the constraints", *lines])
