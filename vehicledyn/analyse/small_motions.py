"""Small motions of a state that holds unit quaternions: three small turns for each of them.

A small turn π in the turned axes changes a quaternion by δQ = ½ Q ∘ (0, π); back, π is twice the
vector part of Q* ∘ δQ. About a motion with the angular velocity ω, π̇ = δω + π × ω.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.base.numbers.quaternions import multiplied
from vehicledyn.kernel.engine import Vector
from vehicledyn.symbolic.equations import Equations, Variable

_TURN = "turn"


def varied_states(equations: Equations) -> tuple[Variable, ...]:
    """Return what small motions are motions of: the states, small turns for quaternions."""
    turned = {a.quaternion[0]: a for a in equations.attitudes}
    dropped = {k for a in equations.attitudes for k in a.quaternion}
    found: list[Variable] = []
    for k, state in enumerate(equations.states):
        if k in turned:
            body = state.name.rpartition(".")[0]
            found += [
                Variable(f"{body}.{_TURN}_{c}", "rad", f"Small turn of {body} about its axis {c}")
                for c in "xyz"
            ]
        elif k not in dropped:
            found.append(state)
    return tuple(found)


@dataclass(frozen=True)
class SmallMotions:
    """Maps between small motions ξ and changes of the states at a point, δx = expand ξ.

    ``expand`` (n_states, n_varied), ``reduce`` (n_varied, n_states) its left inverse, and
    ``drift`` (n_varied, n_varied), what ξ̇ has besides ``reduce`` δẋ.
    """

    expand: Vector
    reduce: Vector
    drift: Vector

    @classmethod
    def at(cls, equations: Equations, state: Vector) -> SmallMotions:
        """Return the maps at a state."""
        width = len(varied_states(equations))
        expand = np.zeros((len(state), width))
        drift = np.zeros((width, width))
        turned = {a.quaternion[0]: a for a in equations.attitudes}
        dropped = {k for a in equations.attitudes for k in a.quaternion}
        column = 0
        for k in range(len(state)):
            if k in turned:
                attitude, block = turned[k], slice(column, column + 3)
                q, omega = state[list(attitude.quaternion)], state[list(attitude.velocity)]
                units = np.hstack([np.zeros((3, 1)), np.eye(3)])
                expand[list(attitude.quaternion), block] = 0.5 * multiplied(q, units).T
                drift[block, block] = 0.5 * np.cross(np.eye(3), omega).T
                column += 3
            elif k not in dropped:
                expand[k, column] = 1.0
                column += 1
        back: Vector = np.asarray(np.linalg.pinv(expand), dtype=float)
        return cls(expand, back, drift)
