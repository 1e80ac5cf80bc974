"""Friction between bodies that holds without creep: an elastic deflection is a state.

With the sliding velocity v, the deflection s along the surface and the limit μ N,

    F = -clip(k s + c v, μ N),    ṡ = v - (s - clip(s, μ N / k)) / τ,

where clip shortens a vector to a length. Below the limit the contact is a spring that never loses
its deflection, so it holds a load for any time; sliding, the force is μ N against the motion. The
same law as of :mod:`vehicledyn.multibody.elements.driveline.friction_coupling`, in two directions;
without a rate of s below the limit it does not drift under a load that varies (Dupont, Hayward,
Armstrong, Altpeter, 2002, Single state elastoplastic friction models, IEEE TAC 47(5), 787-792).
"""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.multibody.elements.contacts.touch import Touch, sliding
from vehicledyn.multibody.model.parts import Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Variable
from vehicledyn.symbolic.labels import unlabelled
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

RELEASE_TIME = 2e-3
"""Time in which a sliding contact loses the deflection beyond its limit [s]."""

_STATES = ("deflection_1", "deflection_2", "deflection_3")
_LEAST = 1e-300
"""Least square of a length that a vector is divided by."""


def sticking_states(name: str) -> tuple[Variable, ...]:
    """Return the deflection in the axes of the first body [m]."""
    return tuple(
        Variable(state, "m", f"Deflection of {name} while it sticks, along axis {k} of body a")
        for k, state in enumerate(_STATES, start=1)
    )


@dataclass(frozen=True)
class Sticking:
    """Friction at a place where two bodies touch; ``limit`` is μ N, not negative [N]."""

    situation: Situation
    bodies: tuple[str, str]
    touch: Touch
    limit: Scalar
    stiffness: Scalar
    damping: Scalar

    @property
    def force(self) -> Vec:
        """Force of friction on the second body, world axes [N]."""
        trial = self.stiffness * self._across(self._deflection) + self.damping * self._sliding
        return -shortened(trial, self.limit)

    @property
    def rates(self) -> dict[str, Scalar]:
        """Rates of the deflection, axes of the first body [m/s]."""
        held = self._across(self._deflection)
        excess = self._deflection - shortened(held, self.limit / self.stiffness)
        rate = self._axes.T @ (self._sliding - excess / RELEASE_TIME)
        return {state: rate[k] for k, state in enumerate(_STATES)}

    @property
    def _axes(self) -> Mat:
        """Axes of the first body in world axes."""
        return unlabelled(self.situation.kinematics.rotation(self.bodies[0]))

    @property
    def _deflection(self) -> Vec:
        return self._axes @ ops.vector(*(self.situation.states[state] for state in _STATES))

    @property
    def _sliding(self) -> Vec:
        return sliding(self.situation.kinematics, self.bodies, self.touch)

    def _across(self, vector: Vec) -> Vec:
        """Return a vector without its part along the normal, which the surface has left."""
        return vector - ops.dot(self.touch.normal, vector) * self.touch.normal


def shortened(vector: Vec, most: Scalar) -> Vec:
    """Return a vector, no longer than a length that is not negative."""
    length = ops.sqrt(ops.maximum(ops.dot(vector, vector), _LEAST))
    return ops.minimum(most / length, 1.0) * vector
